// SPDX-License-Identifier: MIT
// Where still liquid starts level: z + s, the height of the surface over each column of particles
// (particles/surface.hpp).
//
// Columns beside faces off the lattice have cells, and so layers, of other sizes than their neighbours. The surface
// rule counts over two spacings across, so over the border of two sizes it finds a surface that stands 1 % of a spacing
// higher or lower than the columns were made to end, and waves of 6e-3 sqrt(g H) run from there in liquid eight
// spacings deep. The upper layers of each column are moved up or down by what is missing; those below share it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/flow.hpp"

namespace spume::les_sph {
namespace {

// In spacings. What is level to the first stays as it is; rounds end at the second: in proportion to the above, a
// hundredth of those waves.
constexpr double level_enough = 1e-3, levelled = 1e-4;
// Bounds what the start costs: what is not level by then starts as it is.
constexpr int most_rounds = 40;
// Columns that stand farther off lie beside liquid of another height. Where what is left is balanced (rest.cpp), none
// moves farther in all: round after round, rows of a scene with films left a void of 1.6 spacings below them.
constexpr double most_moved = 0.1;
// Layers that the surface sees, as the fill makes them (scene/region_fit.hpp); of more, those below give way.
constexpr std::size_t upper_layers = 4;
// Cosine of the angle between the normal of a level surface and the vertical.
constexpr double upright = 0.95;

}  // namespace

StartColumns::StartColumns(const Scene& scene) : regions(scene.fills.size()), level(regions) {
  const InitialParticles& initial = scene.particles;
  const int up = scene.domain.dimensions - 1;
  region.assign(initial.region.begin(), initial.region.end());
  const auto height_of = [&](std::int32_t i) { return initial.position[up][static_cast<std::size_t>(i)]; };
  for (std::size_t i = 0; i < initial.size(); ++i)
    if (scene.fills[static_cast<std::size_t>(initial.region[i])].flat) order.push_back(static_cast<std::int32_t>(i));
  const auto stands_in = [&](std::int32_t i) {
    const auto k = static_cast<std::size_t>(i);
    return std::tuple(initial.region[k], initial.position[0][k], up == 2 ? initial.position[1][k] : 0.0);
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    const auto own = stands_in(a), other = stands_in(b);
    return own == other ? height_of(a) > height_of(b) : own < other;
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool starts = k == 0 || stands_in(order[k]) != stands_in(order[k - 1]);
    if (starts) columns.push_back({k, k, initial.region[static_cast<std::size_t>(order[k])]});
    Column& column = columns.back();
    // What is below a solid is none of the surface above it.
    if (column.last == k && (starts || height_of(order[k - 1]) - height_of(order[k]) < 2 * scene.spacing))
      column.last = k + 1;
  }
}

void Flow::level_surface() {
  const int up = dimensions - 1;
  const std::vector<std::int32_t>& order = start_columns->order;
  const std::vector<StartColumns::Column>& columns = start_columns->columns;
  std::vector<std::size_t> index_of(size());
  Array<float> depth_of(size());
  std::vector<double> height(columns.size()), top(columns.size()), moved(columns.size());
  for (int round = 0; round < most_rounds; ++round) {
    make_images(0);
    find_neighbours(0);
    moments.measure(arrangement, particles, resolution.spacing);
    surface->find(arrangement, particles, moments, boundary, intermediate_position);
    parallel_for(size(), [&](std::size_t i) {
      index_of[static_cast<std::size_t>((*particles.identifier)[i])] = i;
      depth_of[i] = 0;
    });
    parallel_for(surface->near_surface.size(), [&](std::size_t k) {
      depth_of[static_cast<std::size_t>(surface->near_surface[k])] = surface->depth[k];
    });
    const auto is_level = [&](std::size_t i) {
      if (surface->at_surface[i] == 0) return true;
      double squares = 0;
      for (int axis = 0; axis < dimensions; ++axis) squares += std::pow((*moments.normal[axis])[i], 2);
      return (*moments.normal[up])[i] > upright * std::sqrt(squares);
    };
    std::vector<double> sum(start_columns->regions), count(start_columns->regions);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::size_t i = index_of[static_cast<std::size_t>(order[columns[c].first])];
      const NeighbourList& list = arrangement.list;
      height[c] = std::numeric_limits<double>::quiet_NaN();
      if (surface->at_surface[i] == 0 || !(depth_of[i] > 0) || !is_level(i)) continue;
      const auto neighbours = list.of(i);
      if (!std::all_of(neighbours.begin(), neighbours.end(),
                       [&](std::int32_t j) { return is_level(arrangement.particle_of(j)); }))
        continue;
      height[c] = (*intermediate_position[up])[i] + depth_of[i];
      sum[static_cast<std::size_t>(columns[c].region)] += height[c];
      count[static_cast<std::size_t>(columns[c].region)] += 1;
    }
    top = height;
    double worst = 0;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto region = static_cast<std::size_t>(columns[c].region);
      height[c] = sum[region] / count[region] - height[c];  // what it is to be moved by
      const bool too_far = rest.share != nullptr && std::abs(moved[c] + height[c]) > most_moved * resolution.spacing;
      if (!(std::abs(height[c]) < most_moved * resolution.spacing) || too_far) height[c] = 0;
      moved[c] += height[c];
      worst = std::max(worst, std::abs(height[c]));
    }
    if (worst < (round == 0 ? level_enough : levelled) * resolution.spacing) break;
    parallel_for(columns.size(), [&](std::size_t c) {
      const auto [first, last, region] = columns[c];
      const std::size_t layers = last - first;
      for (std::size_t k = 0; k < layers; ++k) {
        double share = 1;
        if (layers > upper_layers && k >= upper_layers)
          share = static_cast<double>(layers - k) / static_cast<double>(layers - upper_layers + 1);
        const std::size_t i = index_of[static_cast<std::size_t>(order[first + k])];
        (*intermediate_position[up])[i] += share * height[c];
        (*particles.position[up])[i] = (*intermediate_position[up])[i];
      }
    });
    arrangement.sort(particles, intermediate_position);
  }
  if (rest.share == nullptr) {
    start_columns.reset();
    return;
  }
  // Of most columns: those that stand off tell nothing of the level.
  std::vector<std::vector<double>> tops(start_columns->regions);
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (std::isfinite(top[c])) tops[static_cast<std::size_t>(columns[c].region)].push_back(top[c]);
  for (std::size_t r = 0; r < tops.size(); ++r) {
    const auto middle = tops[r].begin() + static_cast<std::ptrdiff_t>(tops[r].size() / 2);
    std::nth_element(tops[r].begin(), middle, tops[r].end());
    start_columns->level[r] = tops[r].empty() ? std::numeric_limits<double>::quiet_NaN() : *middle;
  }
}

}  // namespace spume::les_sph
