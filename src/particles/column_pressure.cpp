// SPDX-License-Identifier: MIT
#include "spume/particles/column_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

// Cells without particles take the mean of their row.
void fill_bodies(std::vector<double>& density, std::size_t rows) {
  for (std::size_t row = 0; row < rows; ++row) {
    double sum = 0, count = 0;
    for (std::size_t k = row; k < density.size(); k += rows)
      if (density[k] > 0) {
        sum += density[k];
        ++count;
      }
    for (std::size_t k = row; k < density.size(); k += rows)
      if (density[k] == 0 && count > 0) density[k] = sum / count;
  }
}

}  // namespace

Vec3 gravity_across_sides(const Scene& scene) {
  Vec3 g{};
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    if (!scene.domain.periodic(axis)) g[axis] = scene.fluid.gravity[axis];
  return g;
}

bool lie_in_layers(const Scene& scene) {
  const auto up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (axis == up ? !(gravity_across_sides(scene)[axis] < 0) : scene.fluid.gravity[axis] != 0) return false;
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

Array<double> column_pressure(const Scene& scene, const ParticleStore& particles, const Array<std::int64_t>& phase) {
  const Domain& domain = scene.domain;
  const int dimensions = domain.dimensions, up = dimensions - 1;
  const double g = -gravity_across_sides(scene)[up], side = scene.spacing;
  const auto density_of = [&](std::size_t i) { return scene.phases[static_cast<std::size_t>(phase[i])].density; };
  std::array<std::size_t, 3> cells{1, 1, 1};
  for (int axis = 0; axis < dimensions; ++axis)
    cells[axis] = static_cast<std::size_t>(std::ceil((domain.upper[axis] - domain.lower[axis]) / side)) + 1;
  const auto index = [&](int axis, std::size_t i) {
    const double k = ((*particles.position[axis])[i] - domain.lower[axis]) / side;
    return std::min(static_cast<std::size_t>(std::max(k, 0.0)), cells[axis] - 1);
  };
  const std::size_t rows = cells[up];
  const auto column = [&](std::size_t i) {
    std::size_t k = index(0, i);
    if (dimensions == 3) k = k * cells[1] + index(1, i);
    return k * rows;
  };
  const std::size_t n = particles.size();
  std::vector<double> density(rows * cells[0] * (dimensions == 3 ? cells[1] : 1)), above(density.size());
  for (std::size_t i = 0; i < n; ++i) density[column(i) + index(up, i)] = density_of(i);
  if (!scene.bodies.empty()) fill_bodies(density, rows);
  for (std::size_t first = 0; first < density.size(); first += rows)
    for (std::size_t k = rows - 1; k-- > 0;)
      above[first + k] = above[first + k + 1] + g * density[first + k + 1] * side;
  Array<double> pressure(n);
  parallel_for(n, [&](std::size_t i) {
    const std::size_t row = index(up, i);
    const double top = domain.lower[up] + side * static_cast<double>(row + 1);
    pressure[i] = above[column(i) + row] + g * density_of(i) * (top - (*particles.position[up])[i]);
  });
  return pressure;
}

}  // namespace spume
