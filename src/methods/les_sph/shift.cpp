// SPDX-License-Identifier: MIT
// The shift: small displacements that even out the arrangement of the particles.
#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/liquid.hpp"
#include "spume/operators/surface_layers.hpp"

namespace spume::les_sph {
namespace {

// Of what a lattice stands. At the limit a wave of steepness 0.33 in 2-D gains energy, at 0.9 of it none; at 0.75 it
// loses a third less, but vortices without viscosity in a full domain blow up at courant 0.4 and the splash of
// dam_break_3d evens out more slowly.
constexpr double share_of_largest_shift = 0.9;

// Beneath the surface the kernel is cut, and the concentration gradient pushes whole layers along the normal; so does
// every change of their distance. The volume above them, by which the surface is placed, would follow: a standing wave
// of 64 particles then loses 4 % of its amplitude in three periods. What the neighbours of one layer share of the
// normal shift is therefore taken out before it spreads; particles that stand out of their layer are moved as before.
void keep_layers(Liquid& liquid) {
  const std::size_t n = liquid.size();
  liquid.beside_edge.resize(n);
  mark_upper_layers(liquid.context, liquid.scene.spacing, liquid.near_surface, liquid.beside_edge);
  parallel_select(n, liquid.upper_particles, [&](std::size_t i) { return liquid.beside_edge[i] != 0; });
  const FloatVectorField& unit_normal = liquid.acceleration;  // free until the viscous sweep
  parallel_for(n, [&](std::size_t i) {
    std::array<float, 3> normal{};
    float size = 0;
    if (liquid.is_edge(i)) {
      for (int axis = 0; axis < liquid.dimensions; ++axis) normal[axis] = (*liquid.normal[axis])[i];
      size = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    }
    for (int axis = 0; axis < liquid.dimensions; ++axis) (*unit_normal[axis])[i] = size > 0 ? normal[axis] / size : 0;
  });
  liquid.layer_shift.resize(liquid.upper_particles.size());
  shared_along_normal(liquid.context, liquid.records, liquid.scene.spacing, liquid.read(unit_normal),
                      liquid.read(liquid.shift), liquid.reflection, liquid.upper_particles, liquid.layer_shift);
  parallel_for(liquid.upper_particles.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.upper_particles[k]);
    for (int axis = 0; axis < liquid.dimensions; ++axis) (*liquid.shift[axis])[i] -= liquid.layer_shift[k][axis];
  });
  liquid.records.take_traffic();  // it counts the lists of all particles, not of those beside a surface alone
}

}  // namespace

void compute_shift(Liquid& liquid) {
  const int d = liquid.dimensions;
  const ShiftingOptions& options = liquid.options.get<ShiftingOptions>();
  // King (3.12) at steps of courant 0.2, else in proportion to the distance moved, as far as that evens out: a liquid
  // at rest is not shifted, and small steps do not shift more (and dissipate more) than large ones. Particles that have
  // to make room for a bubble move whatever the speed, until they are no denser than the lattice: by 1/alpha - 1 just
  // after a bubble has come. Shifted for ever, those beside a bubble at rest below a surface lift the liquid.
  const double most = std::max(1.0, share_of_largest_shift * liquid.largest_shift / options.coefficient);
  const double of_distance = std::min(liquid.displacement, most);
  const auto strength = [&liquid, of_distance](std::size_t i) {
    const double taken = 1 / liquid.alpha_at(i) - 1;
    if (!(taken > 0)) return of_distance;
    const double excess = (*liquid.divergence_of_position)[i] / liquid.lattice.divergence_of_position - 1;
    return std::clamp(excess / taken, of_distance, std::max(1.0, of_distance));
  };
  const auto limit = [&liquid, &options](std::array<double, 3>& shift, std::size_t i) {
    const double longest = options.limit * std::max(1.0, liquid.displacement) * liquid.width_at(i);
    const double length = std::hypot(shift[0], shift[1], shift[2]);
    if (length > longest)
      for (double& component : shift) component *= longest / length;
  };
  parallel_for(liquid.size(), [&](std::size_t i) {
    std::array<double, 3> shift{};
    const double h = liquid.width_at(i);
    const double coefficient = options.coefficient * h * h * strength(i);
    for (int axis = 0; axis < d; ++axis) shift[axis] = -coefficient * (*liquid.shift[axis])[i];
    if (liquid.plan.free_surface && liquid.at_surface[i] != 0) {
      // King (3.12), sign and tangential projection corrected: only the part along the surface is kept.
      double along = 0, norm2 = 1e-30;
      for (int axis = 0; axis < d; ++axis) {
        const double normal = (*liquid.smoothed_normal[axis])[i];
        along += normal * shift[axis];
        norm2 += normal * normal;
      }
      for (int axis = 0; axis < d; ++axis) shift[axis] -= along / norm2 * (*liquid.smoothed_normal[axis])[i];
      if (liquid.list.count(i) == 0) shift = {};
    }
    limit(shift, i);
    for (int axis = 0; axis < d; ++axis) (*liquid.shift[axis])[i] = static_cast<float>(shift[axis]);
  });
  if (!liquid.plan.drift_removal) return;
  if (liquid.plan.free_surface) keep_layers(liquid);
  // What neighbours share of the shift transports liquid without any force: near a surface it lifts the liquid step by
  // step (a tenth of a wave's energy per period at 1/50). Only what differs from the neighbours evens out the
  // arrangement.
  filter_vector(liquid.context, liquid.records, liquid.read(liquid.shift), liquid.reflection,
                liquid.write(liquid.acceleration));
  parallel_for(liquid.size(), [&](std::size_t i) {
    std::array<double, 3> shift{};
    for (int axis = 0; axis < d; ++axis)
      shift[axis] = double{(*liquid.shift[axis])[i]} - (*liquid.acceleration[axis])[i];
    limit(shift, i);
    for (int axis = 0; axis < d; ++axis) (*liquid.shift[axis])[i] = static_cast<float>(shift[axis]);
  });
}

}  // namespace spume::les_sph
