// SPDX-License-Identifier: MIT
#include "spume/particles/shift.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/operators/surface_layers.hpp"

namespace spume {
namespace {

// Of what a lattice stands. At the limit a wave of steepness 0.33 in 2-D gains energy, at 0.9 of it none; at 0.75 it
// loses a third less, but vortices without viscosity in a full domain blow up at courant 0.4 and the splash of
// dam_break_3d evens out more slowly.
constexpr double share_of_largest_shift = 0.9;

}  // namespace

ShiftInput shift_input(const ShiftingOptions& options, double largest_stable, double displacement) {
  return {.coefficient = options.coefficient,
          .limit = options.limit,
          .remove_drift = options.remove_drift,
          .largest_stable = largest_stable,
          .displacement = displacement};
}

Shift::Shift(ParticleStore& particles, const Resolution& resolution) : resolution_(resolution) {
  particles.add_vector(displacement, "shift", Lifetime::result);
}

// Beneath the surface the kernel is cut, and the concentration gradient pushes whole layers along the normal; so does
// every change of their distance. The volume above them, by which the surface is placed, would follow: a standing wave
// of 64 particles then loses 4 % of its amplitude in three periods. What the neighbours of one layer share of the
// normal shift is therefore taken out before it spreads; particles that stand out of their layer are moved as before.
void Shift::keep_layers(Arrangement& arrangement, ParticleStore& particles, const MomentFields& moments,
                        const FreeSurface& surface, const std::vector<std::array<float, 3>>& reflection) {
  const std::size_t n = particles.size();
  const int d = particles.dimensions;
  beside_surface_.resize(n);
  mark_upper_layers(arrangement.context, resolution_.spacing, surface.near_surface, beside_surface_);
  parallel_select(n, upper_particles_, [&](std::size_t i) { return beside_surface_[i] != 0; });
  FloatVectorScratch unit_normal;
  particles.scratch().lease(unit_normal, d, n);
  parallel_for(n, [&](std::size_t i) {
    std::array<float, 3> normal{};
    float size = 0;
    if (surface.is_near(moments, i)) {
      for (int axis = 0; axis < d; ++axis) normal[axis] = (*moments.normal[axis])[i];
      size = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    }
    for (int axis = 0; axis < d; ++axis) unit_normal[axis][i] = size > 0 ? normal[axis] / size : 0;
  });
  layer_shift_.resize(upper_particles_.size());
  shared_along_normal(arrangement.context, arrangement.packed, resolution_.spacing, read(unit_normal),
                      read(displacement), reflection, upper_particles_, layer_shift_);
  parallel_for(upper_particles_.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(upper_particles_[k]);
    for (int axis = 0; axis < d; ++axis) (*displacement[axis])[i] -= layer_shift_[k][axis];
  });
  particles.scratch().release(unit_normal);
  arrangement.packed.take_traffic();  // it counts the lists of all particles, not of those beside a surface alone
}

void Shift::compute(Arrangement& arrangement, ParticleStore& particles, const ShiftInput& input,
                    const ParticleSizes& sizes, MomentFields& moments, FreeSurface* surface,
                    const std::vector<std::array<float, 3>>& reflection) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  // King (3.12) at steps of courant 0.2, else in proportion to the distance moved, as far as that evens out: a liquid
  // at rest is not shifted, and small steps do not shift more (and dissipate more) than large ones. Particles that have
  // to make room for a bubble move whatever the speed, until they are no denser than the lattice: by 1/alpha - 1 just
  // after a bubble has come. Shifted for ever, those beside a bubble at rest below a surface lift the liquid.
  const double most = std::max(1.0, share_of_largest_shift * input.largest_stable / input.coefficient);
  const double of_distance = std::min(input.displacement, most);
  const auto strength = [&](std::size_t i) {
    if (!sizes.variable) return of_distance;
    const double taken = 1 / sizes.alpha(i) - 1;
    if (!(taken > 0)) return of_distance;
    const double excess = (*moments.divergence_of_position)[i] / resolution_.lattice.divergence_of_position - 1;
    return std::clamp(excess / taken, of_distance, std::max(1.0, of_distance));
  };
  const auto limit = [&](std::array<double, 3>& shift, std::size_t i) {
    const double longest = input.limit * std::max(1.0, input.displacement) * sizes.smoothing_length(resolution_, i);
    // Most are shorter: std::hypot() of all of them takes 12 ns a particle and loop.
    const double length2 = dot(shift, shift);
    if (length2 > longest * longest)
      for (double& component : shift) component *= longest / std::sqrt(length2);
  };
  parallel_for(n, [&](std::size_t i) {
    std::array<double, 3> shift{};
    const double h = sizes.smoothing_length(resolution_, i);
    const double coefficient = input.coefficient * h * h * strength(i);
    for (int axis = 0; axis < d; ++axis) shift[axis] = -coefficient * moments.concentration_gradient[axis][i];
    if (surface != nullptr && surface->at_surface[i] != 0) {
      // King (3.12), sign and tangential projection corrected: only the part along the surface is kept.
      double along = 0, norm2 = 1e-30;  // no normal: 0 / 1e-30
      for (int axis = 0; axis < d; ++axis) {
        const double normal = surface->smoothed_normal[axis][i];
        along += normal * shift[axis];
        norm2 += normal * normal;
      }
      for (int axis = 0; axis < d; ++axis) shift[axis] -= along / norm2 * surface->smoothed_normal[axis][i];
      if (arrangement.list.count(i) == 0) shift = {};
    }
    limit(shift, i);
    for (int axis = 0; axis < d; ++axis) (*displacement[axis])[i] = static_cast<float>(shift[axis]);
  });
  particles.scratch().release(moments.concentration_gradient);
  if (surface != nullptr) surface->release_smoothed_normals(particles);
  if (!input.remove_drift) return;
  if (surface != nullptr) keep_layers(arrangement, particles, moments, *surface, reflection);
  // What neighbours share of the shift transports liquid without any force: near a surface it lifts the liquid step by
  // step (a tenth of a wave's energy per period at 1/50). Only what differs from the neighbours evens out the
  // arrangement.
  FloatVectorScratch shared;
  particles.scratch().lease(shared, d, n);
  filter_vector(arrangement.context, arrangement.packed, read(displacement), reflection, write(shared));
  parallel_for(n, [&](std::size_t i) {
    std::array<double, 3> shift{};
    for (int axis = 0; axis < d; ++axis) shift[axis] = double{(*displacement[axis])[i]} - shared[axis][i];
    limit(shift, i);
    for (int axis = 0; axis < d; ++axis) (*displacement[axis])[i] = static_cast<float>(shift[axis]);
  });
  particles.scratch().release(shared);
}

double Shift::bytes() const {
  return beside_surface_.bytes() + upper_particles_.bytes() + layer_shift_.bytes();
}

}  // namespace spume
