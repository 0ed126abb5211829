// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/free_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/operators/surface_layers.hpp"

namespace spume::les_sph {
namespace {

// m = sum_j g d, from the outward normal -h m.
Vec3 moment_of(const Liquid& liquid, std::size_t i) {
  Vec3 m{};
  for (int axis = 0; axis < liquid.dimensions; ++axis) m[axis] = -(*liquid.normal[axis])[i] / liquid.width_at(i);
  return m;
}

double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

void find_surface(Liquid& liquid) {
  const std::size_t n = liquid.size();
  liquid.at_surface.resize(n);
  liquid.pressure_fixed.resize(n);
  liquid.interior_weight.resize(n);
  const double width = liquid.options.get<SurfaceOptions>().blend_width;
  parallel_for(n, [&](std::size_t i) {
    const double above = (*liquid.divergence_of_position)[i] - liquid.surface_threshold;
    liquid.at_surface[i] = above < 0 ? 1 : 0;
    liquid.pressure_fixed[i] = above < 0 && liquid.uncorrected[i] != 0 ? 1 : 0;
    liquid.interior_weight[i] = above < 0 ? 0.0F
                                : above < width
                                    ? static_cast<float>(0.5 * (1 - std::cos(std::numbers::pi * above / width)))
                                    : 1.0F;
  });
  parallel_select(n, liquid.surface_particles, [&](std::size_t i) { return liquid.at_surface[i] != 0; });
  parallel_select(n, liquid.near_surface, [&](std::size_t i) { return liquid.is_edge(i); });
  liquid.surface_depth.resize(liquid.near_surface.size());
  Array<float>& scratch = *liquid.acceleration[0];  // free until the viscous sweep
  edge_depths(liquid.context, liquid.records, {liquid.scene.spacing, liquid.near_surface, liquid.read(liquid.normal)},
              scratch, liquid.surface_depth);
  if (liquid.plan.shifting)
    filter_vector_subset(liquid.context, liquid.records, liquid.read(liquid.normal), liquid.reflection,
                         liquid.surface_particles, liquid.write(liquid.smoothed_normal));
}

SurfaceRow surface_row(const Liquid& liquid, std::size_t k) {
  const auto i = static_cast<std::size_t>(liquid.near_surface[k]);
  const double outside = 1 - double{liquid.interior_weight[i]};
  const double depth = liquid.surface_depth[k];
  const Vec3 m = moment_of(liquid, i);
  const double size = std::sqrt(dot(m, m));
  // In a thin sheet |m| vanishes although the surface is near on both sides: there the pairs that are missing hold p =
  // 0.
  const double full = liquid.lattice.laplacian_diagonal / (liquid.scene.spacing * liquid.scene.spacing);
  const double missing = std::max(0.0, full - double{(*liquid.laplacian_diagonal)[i]});
  SurfaceRow row;
  row.laplacian_diagonal = outside * std::max(2 * size / depth, missing);
  if (size > 0) row.hydrostatic_pressure = depth * dot(liquid.uniform_acceleration, m) / size;
  return row;
}

void complete_surface_gradient(Liquid& liquid) {
  const int d = liquid.dimensions;
  parallel_for(liquid.near_surface.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.near_surface[k]);
    const Vec3 m = moment_of(liquid, i);
    const double size = std::sqrt(dot(m, m));
    if (!(size > 0)) return;
    const double outside = 1 - double{liquid.interior_weight[i]};
    const double depth = liquid.surface_depth[k];
    const double potential = liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i];
    const double excess =
        (*liquid.reduced_pressure)[i] - potential - depth * dot(liquid.uniform_acceleration, m) / size;
    // L' by Sherman-Morrison: with v = L m and c = 2 s / |m|, L' x = L x - c v (v . x) / (1 + c m . v).
    Vec3 v{}, gradient{};
    int slot = 0;
    for (int a = 0; a < d; ++a) {
      gradient[a] = (*liquid.acceleration[a])[i];
      for (int b = a; b < d; ++b, ++slot) {
        const double entry = (*liquid.correction[slot])[i];
        v[a] += entry * m[b];
        if (b != a) v[b] += entry * m[a];
      }
    }
    const double c = 2 * outside * depth / size;
    const double factor = (2 * outside * excess - c * dot(m, gradient)) / (1 + c * dot(m, v));
    for (int a = 0; a < d; ++a) (*liquid.acceleration[a])[i] = static_cast<float>(gradient[a] + factor * v[a]);
  });
}

}  // namespace spume::les_sph
