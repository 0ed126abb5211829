// SPDX-License-Identifier: MIT
#include "spume/particles/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/operators/surface_layers.hpp"

namespace spume {
namespace {

double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

FreeSurface::FreeSurface(const Resolution& resolution, const Options& options)
    : resolution_(resolution), options_(options) {
  if (!(options_.threshold > 0)) options_.threshold = resolution.dimensions == 3 ? 2.3 : 1.5;
}

void FreeSurface::find(Arrangement& arrangement, ParticleStore& particles, const MomentFields& moments,
                       const std::vector<std::array<float, 3>>& reflection) {
  const std::size_t n = particles.size();
  at_surface.resize(n);
  pressure_fixed.resize(n);
  interior_weight.resize(n);
  const double width = options_.blend_width;
  const Array<float>& divergence_of_position = *moments.divergence_of_position;
  parallel_for(n, [&](std::size_t i) {
    const double above = divergence_of_position[i] - options_.threshold;
    at_surface[i] = above < 0 ? 1 : 0;
    pressure_fixed[i] = above < 0 && moments.uncorrected[i] != 0 ? 1 : 0;
    interior_weight[i] = above < 0       ? 0.0F
                         : above < width ? static_cast<float>(0.5 * (1 - std::cos(std::numbers::pi * above / width)))
                                         : 1.0F;
  });
  parallel_select(n, surface_particles, [&](std::size_t i) { return at_surface[i] != 0; });
  parallel_select(n, near_surface, [&](std::size_t i) { return is_near(moments, i); });
  depth.resize(near_surface.size());
  ScratchArray<float> of_particle(particles.scratch(), n);
  surface_depths(arrangement.context, arrangement.packed, {resolution_.spacing, near_surface, read(moments.normal)},
                 of_particle, depth);
  if (options_.keep_smoothed_normals)
    for (int axis = 0; axis < resolution_.dimensions; ++axis) smoothed_normal[axis].resize(n);
  if (options_.smooth_normals) {
    particles.scratch().lease(smoothed_normal, resolution_.dimensions, n);
    filter_vector_subset(arrangement.context, arrangement.packed, read(moments.normal), reflection, surface_particles,
                         write(smoothed_normal));
  }
  arrangement.packed.take_traffic();  // it counts the lists of all particles, not of those at the surface alone
}

void FreeSurface::release_smoothed_normals(ParticleStore& particles) {
  if (!options_.keep_smoothed_normals) particles.scratch().release(smoothed_normal);
}

// m = sum_j g d, from the outward normal -h m.
Vec3 FreeSurface::moment_of(const MomentFields& moments, const ParticleSizes& sizes, std::size_t i) const {
  Vec3 m{};
  for (int axis = 0; axis < resolution_.dimensions; ++axis)
    m[axis] = -(*moments.normal[axis])[i] / sizes.smoothing_length(resolution_, i);
  return m;
}

SurfaceRow FreeSurface::row(const MomentFields& moments, const ParticleSizes& sizes,
                            const LocalAcceleration& acceleration, std::size_t k) const {
  const auto i = static_cast<std::size_t>(near_surface[k]);
  const double outside = 1 - double{interior_weight[i]};
  const double s = depth[k];
  const Vec3 m = moment_of(moments, sizes, i);
  const double size = std::sqrt(dot(m, m));
  // In a thin sheet |m| vanishes although the surface is near on both sides: there the pairs that are missing hold
  // p = 0.
  const double full = resolution_.lattice.laplacian_diagonal / (resolution_.spacing * resolution_.spacing);
  const double missing = std::max(0.0, full - double{moments.laplacian_diagonal[i]});
  SurfaceRow row;
  row.laplacian_diagonal = outside * std::max(2 * size / s, missing);
  if (size > 0) row.hydrostatic_pressure = s * dot(acceleration.at(i), m) / size;
  return row;
}

void FreeSurface::complete_gradient(const MomentFields& moments, const ParticleSizes& sizes,
                                    const LocalAcceleration& acceleration, const Array<double>& reduced_pressure,
                                    const Array<double>* potential, FloatVectorScratch& gradient_of_q) const {
  const int d = resolution_.dimensions;
  parallel_for(near_surface.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(near_surface[k]);
    const Vec3 m = moment_of(moments, sizes, i);
    const double size = std::sqrt(dot(m, m));
    if (!(size > 0)) return;
    const double outside = 1 - double{interior_weight[i]};
    const double s = depth[k];
    const double height = potential == nullptr ? 0.0 : (*potential)[i];
    const double excess = reduced_pressure[i] - height - s * dot(acceleration.at(i), m) / size;
    // L' by Sherman-Morrison: with v = L m and c = 2 s / |m|, L' x = L x - c v (v . x) / (1 + c m . v).
    Vec3 v{}, gradient{};
    int slot = 0;
    for (int a = 0; a < d; ++a) {
      gradient[a] = gradient_of_q[a][i];
      for (int b = a; b < d; ++b, ++slot) {
        const double entry = (*moments.correction[slot])[i];
        v[a] += entry * m[b];
        if (b != a) v[b] += entry * m[a];
      }
    }
    const double c = 2 * outside * s / size;
    const double factor = (2 * outside * excess - c * dot(m, gradient)) / (1 + c * dot(m, v));
    for (int a = 0; a < d; ++a) gradient_of_q[a][i] = static_cast<float>(gradient[a] + factor * v[a]);
  });
}

double FreeSurface::bytes() const {
  double sum = 0;
  for (const auto* flags : {&at_surface, &pressure_fixed}) sum += flags->bytes();
  for (const auto* values : {&interior_weight, &depth}) sum += values->bytes();
  for (const auto* numbers : {&surface_particles, &near_surface}) sum += numbers->bytes();
  if (options_.keep_smoothed_normals)
    for (const auto& component : smoothed_normal) sum += component.bytes();
  return sum;
}

}  // namespace spume
