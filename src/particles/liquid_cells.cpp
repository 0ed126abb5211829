// SPDX-License-Identifier: MIT
#include "spume/particles/liquid_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "spume/geometry/way_to_wall.hpp"

namespace spume {
namespace {

constexpr double thinnest = 0.02;  // spacings, of a plate that parts liquid

std::size_t root_of(std::vector<std::size_t>& root, std::size_t k) {
  while (root[k] != k) k = root[k] = root[root[k]];
  return k;
}

}  // namespace

LiquidCells::LiquidCells(const Scene& scene) : scene_(scene), lattice_(make_lattice(scene.domain, scene.spacing)) {
  keep_around(scene.particles);
  phase_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), -1);
  const InitialParticles& particles = scene.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Vec3 place{};
    for (int axis = 0; axis < lattice_.dimensions; ++axis) place[axis] = particles.position[axis][i];
    phase_[index(cell_of(place))] = particles.phase.empty() ? 0 : particles.phase[i];
  }
  find_parts();
}

// A jet in a domain of 460^3 cells would have 1.5 GB of them.
void LiquidCells::keep_around(const InitialParticles& particles) {
  for (int axis = 0; axis < lattice_.dimensions; ++axis) {
    const Array<double>& place = particles.position[axis];
    if (!scene_.domain.periodic(axis) && !place.empty()) {
      const auto [least, most] = std::minmax_element(place.begin(), place.end());
      const auto number = [&](double r) { return std::floor((r - lattice_.origin[axis]) / lattice_.spacing[axis]); };
      const double first = std::clamp(number(*least) - 1, 0.0, lattice_.count[axis] - 1);
      lattice_.count[axis] = std::clamp(number(*most) + 2, first + 1, lattice_.count[axis]) - first;
      lattice_.origin[axis] += first * lattice_.spacing[axis];
    }
    count_[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(lattice_.count[axis]);
  }
}

Vec3 LiquidCells::centre(const Cell& cell) const {
  Vec3 place{};
  for (int axis = 0; axis < lattice_.dimensions; ++axis)
    place[axis] = lattice_.origin[axis] +
                  (static_cast<double>(cell[static_cast<std::size_t>(axis)]) + 0.5) * lattice_.spacing[axis];
  return place;
}

// `clear`: how far the first one's centre is from bodies; `axes`: along how many they are neighbours.
bool LiquidCells::meet(const Cell& one, const Cell& other, double clear, int axes) const {
  const double way = std::sqrt(axes) * scene_.spacing;
  if (clear > way) return true;
  Vec3 to_other{};
  for (int axis = 0; axis < lattice_.dimensions; ++axis) {
    // The nearest repetition of the other, across periodic sides.
    const auto a = static_cast<std::size_t>(axis);
    const double step = static_cast<double>(other[a] - one[a]);
    to_other[axis] = lattice_.spacing[axis] * (std::abs(step) > 1 ? (step > 0 ? -1 : 1) : step);
  }
  const auto distance = [&](const Vec3& place) { return scene_.walls.distance(place); };
  return !way_to_wall(centre(one), to_other, thinnest * scene_.spacing, distance,
                      [&](const Vec3& place) { return distance(place) <= 0; });
}

LiquidCells::Cell LiquidCells::cell(std::int64_t column, std::int64_t row) const {
  return up() == 2 ? Cell{column / count_[1], column % count_[1], row} : Cell{column, row, 0};
}

LiquidCells::Cell LiquidCells::cell_of(const Vec3& place) const {
  Cell cell{};
  for (int axis = 0; axis < lattice_.dimensions; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double k = std::floor((place[axis] - lattice_.origin[axis]) / lattice_.spacing[axis]);
    cell[a] = static_cast<std::int64_t>(std::clamp(k, 0.0, lattice_.count[axis] - 1));
  }
  return cell;
}

bool LiquidCells::is_covered(const Cell& cell) const {
  if (scene_.walls.empty()) return false;
  return scene_.walls.distance(centre(cell)) < scene_.spacing / 2;
}

LiquidCells::Beyond LiquidCells::step(Cell& cell, int axis, int by) const {
  const auto a = static_cast<std::size_t>(axis);
  cell[a] += by;
  if (cell[a] >= 0 && cell[a] < count_[a]) return Beyond::cell;
  if (scene_.domain.periodic(axis)) {
    cell[a] = cell[a] < 0 ? count_[a] - 1 : 0;
    return Beyond::cell;
  }
  return scene_.domain.sides[a][by < 0 ? 0 : 1].bounds_liquid() ? Beyond::wall : Beyond::open;
}

// The root of a part is its first cell, in the order in which both loops go through the cells.
void LiquidCells::find_parts() {
  const auto for_liquid = [&](auto&& use) {
    for (std::int64_t column = 0; column < columns(); ++column)
      for (std::int64_t row = 0; row < rows(); ++row)
        if (const Cell one = cell(column, row); phase(one) >= 0) use(one, row);
  };
  std::vector<std::size_t> root(phase_.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const int around = up() == 2 ? 27 : 9;
  const bool bodies = !scene_.walls.empty();
  for_liquid([&](const Cell& one, std::int64_t) {
    const double clear = bodies ? scene_.walls.distance(centre(one)) : 0;
    for (int n = 0; n < around; ++n) {
      Cell other = one;
      bool is_cell = true;
      int axes = 0;
      for (int axis = 0, left = n; axis <= up(); ++axis, left /= 3) {
        if (left % 3 == 1) continue;
        ++axes;
        is_cell = is_cell && step(other, axis, left % 3 - 1) == Beyond::cell;
      }
      if (!is_cell || phase(other) < 0) continue;
      if (bodies && !meet(one, other, clear, axes)) continue;
      const std::size_t a = root_of(root, index(one)), b = root_of(root, index(other));
      root[std::max(a, b)] = std::min(a, b);
    }
  });
  part_.assign(phase_.size(), -1);
  for_liquid([&](const Cell& one, std::int64_t row) {
    const std::size_t first = root_of(root, index(one));
    if (part_[first] < 0) {
      part_[first] = static_cast<std::int32_t>(parts());
      first_row_.push_back(row);
      last_row_.push_back(row);
    }
    part_[index(one)] = part_[first];
    const auto part = static_cast<std::size_t>(part_[first]);
    first_row_[part] = std::min(first_row_[part], row);
    last_row_[part] = std::max(last_row_[part], row);
  });
}

}  // namespace spume
