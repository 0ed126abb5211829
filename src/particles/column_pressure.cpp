// SPDX-License-Identifier: MIT
#include "spume/particles/column_pressure.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/particles/liquid_cells.hpp"

namespace spume {
namespace {

using Cell = LiquidCells::Cell;
using enum LiquidCells::Beyond;

// Whether gravity is along the last axis, downwards, and sides bound it.
bool points_down(const Scene& scene) {
  const auto up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (axis == up ? !(gravity_across_sides(scene)[axis] < 0) : scene.fluid.gravity[axis] != 0) return false;
  return true;
}

// 1 for parts that stand on a body or on a wall of the domain.
std::vector<std::uint8_t> supported_parts(const LiquidCells& cells) {
  std::vector<std::uint8_t> supported(cells.parts());
  for (std::int64_t column = 0; column < cells.columns(); ++column)
    for (std::int64_t row = 0; row < cells.rows(); ++row) {
      Cell cell = cells.cell(column, row);
      if (cells.part(cell) < 0) continue;
      std::uint8_t& stands = supported[static_cast<std::size_t>(cells.part(cell))];
      if (stands != 0) continue;
      const LiquidCells::Beyond below = cells.step(cell, cells.up(), -1);
      if (below == wall || (below == LiquidCells::Beyond::cell && cells.phase(cell) < 0 && cells.is_covered(cell)))
        stands = 1;
    }
  return supported;
}

// The mean density of the rows of each part.
class RowMeans {
 public:
  RowMeans(const LiquidCells& cells, const Scene& scene) : cells_(cells) {
    for (std::size_t part = 0; part < cells.parts(); ++part)
      begin_.push_back(begin_.back() + static_cast<std::size_t>(cells.last_row(part) - cells.first_row(part) + 1));
    sum_.resize(begin_.back());
    std::vector<double> count(begin_.back());
    for (std::int64_t column = 0; column < cells.columns(); ++column)
      for (std::int64_t row = 0; row < cells.rows(); ++row) {
        const Cell cell = cells.cell(column, row);
        if (cells.part(cell) < 0) continue;
        const std::size_t k = place(static_cast<std::size_t>(cells.part(cell)), row);
        sum_[k] += scene.phases[static_cast<std::size_t>(cells.phase(cell))].density;
        ++count[k];
      }
    for (std::size_t k = 0; k < sum_.size(); ++k)
      if (count[k] > 0) sum_[k] /= count[k];
  }
  // Zero above its last row; `row` is not below its first one.
  double of(std::size_t part, std::int64_t row) const {
    return row > cells_.last_row(part) ? 0 : sum_[place(part, row)];
  }

 private:
  std::size_t place(std::size_t part, std::int64_t row) const {
    return begin_[part] + static_cast<std::size_t>(row - cells_.first_row(part));
  }

  const LiquidCells& cells_;
  std::vector<std::size_t> begin_{0};
  std::vector<double> sum_;
};

}  // namespace

Vec3 gravity_across_sides(const Scene& scene) {
  Vec3 g{};
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    if (!scene.domain.periodic(axis)) g[axis] = scene.fluid.gravity[axis];
  return g;
}

bool lie_in_layers(const Scene& scene) {
  if (!points_down(scene)) return false;
  const auto up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  struct Layer {
    double density = 0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  };
  std::vector<Layer> layers(scene.phases.size());
  for (std::size_t n = 0; n < layers.size(); ++n) layers[n].density = scene.phases[n].density;
  const InitialParticles& particles = scene.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Layer& layer = layers[static_cast<std::size_t>(particles.phase[i])];
    layer.lowest = std::min(layer.lowest, particles.position[up][i]);
    layer.highest = std::max(layer.highest, particles.position[up][i]);
  }
  std::sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) { return a.lowest < b.lowest; });
  for (std::size_t n = 1; n < layers.size(); ++n)
    if (layers[n].lowest < layers[n - 1].highest || layers[n].density > layers[n - 1].density) return false;
  return true;
}

std::vector<std::uint8_t> particles_at_rest(const Scene& scene) {
  if (!points_down(scene)) return {};
  const LiquidCells cells(scene);
  const auto up = static_cast<std::size_t>(cells.up());
  const auto can_leave = [&](const Cell& from, std::int64_t top) {
    for (int axis = 0; axis <= cells.up(); ++axis)
      for (const int by : {-1, 1}) {
        Cell to = from;
        const LiquidCells::Beyond beyond = cells.step(to, axis, by);
        if (beyond == wall || to[up] > top) continue;
        if (beyond == open || (cells.phase(to) < 0 && !cells.is_covered(to))) return true;
      }
    return false;
  };
  std::vector<std::uint8_t> rests(cells.parts(), 1);
  for (std::int64_t column = 0; column < cells.columns(); ++column)
    for (std::int64_t row = 0; row < cells.rows(); ++row) {
      const Cell one = cells.cell(column, row);
      if (cells.part(one) < 0) continue;
      const auto part = static_cast<std::size_t>(cells.part(one));
      if (rests[part] != 0 && can_leave(one, cells.last_row(part))) rests[part] = 0;
    }
  const InitialParticles& particles = scene.particles;
  const auto part_of = [&](std::size_t i) {
    return static_cast<std::size_t>(cells.part(cells.cell_of(vector_at(particles.position, cells.up() + 1, i))));
  };
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (squared_norm(particles.velocity, cells.up() + 1, i) != 0) rests[part_of(i)] = 0;
  if (std::find(rests.begin(), rests.end(), 1) == rests.end()) return {};
  std::vector<std::uint8_t> at_rest(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) { at_rest[i] = rests[part_of(i)]; });
  return at_rest;
}

Array<double> column_pressure(const Scene& scene, const ParticleStore& particles, const Array<std::int64_t>& phase) {
  const LiquidCells cells(scene);
  const int up = cells.up();
  const double g = -gravity_across_sides(scene)[up], side = cells.height();
  const std::vector<std::uint8_t> supported = supported_parts(cells);
  const RowMeans means(cells, scene);
  const auto weight_of = [&](const Cell& cell, std::int64_t row, std::size_t part) {
    if (cells.part(cell) >= 0)
      return cells.part(cell) == static_cast<std::int32_t>(part)
                 ? scene.phases[static_cast<std::size_t>(cells.phase(cell))].density * g * side
                 : 0.0;
    const double mean = means.of(part, row);
    return mean > 0 && cells.is_covered(cell) ? mean * g * side : 0.0;
  };
  // What lies above each row of a column, of the part in that row.
  std::vector<double> above(static_cast<std::size_t>(cells.columns() * cells.rows()));
  parallel_for(static_cast<std::size_t>(cells.columns()), [&](std::size_t k) {
    const auto column = static_cast<std::int64_t>(k);
    std::vector<std::int32_t> parts;
    for (std::int64_t row = 0; row < cells.rows(); ++row) {
      const std::int32_t part = cells.part(cells.cell(column, row));
      if (part >= 0 && std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
    }
    for (const std::int32_t part : parts) {
      const auto own = static_cast<std::size_t>(part);
      double sum = 0;
      for (std::int64_t row = cells.last_row(own); row >= cells.first_row(own); --row) {
        const Cell cell = cells.cell(column, row);
        if (cells.part(cell) == part)
          above[k * static_cast<std::size_t>(cells.rows()) + static_cast<std::size_t>(row)] = sum;
        sum += weight_of(cell, row, own);
      }
    }
  });
  Array<double> pressure(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    const Vec3 place = vector_at(particles.position, particles.dimensions, i);
    const Cell cell = cells.cell_of(place);
    pressure[i] = 0;
    if (cells.part(cell) < 0 || supported[static_cast<std::size_t>(cells.part(cell))] == 0) return;
    const std::int64_t row = cell[static_cast<std::size_t>(up)], column = cells.column_of(cell);
    const double density = scene.phases[phase.empty() ? 0 : static_cast<std::size_t>(phase[i])].density;
    pressure[i] = above[static_cast<std::size_t>(column * cells.rows() + row)] +
                  g * density * (cells.bottom(row + 1) - place[up]);
  });
  return pressure;
}

}  // namespace spume
