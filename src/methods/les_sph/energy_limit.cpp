// SPDX-License-Identifier: MIT
// A step that makes energy from nothing is refused: without this an unstable run goes on for thousands of ever shorter
// steps, finite to the end, and reports success.
#include <algorithm>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {
namespace {

// The work of bubbles and of moving walls is not followed. What it may give is taken large: ten times the speed of a
// wall, or of a fall from the top of the domain to its bottom, for all of the liquid.
double unfollowed_supply(const Liquid& liquid, double strength) {
  if (!liquid.plan.bubbles && !liquid.plan.moving_walls) return 0;
  // Gravity drives bubbles also where a force on the liquid cancels it.
  double size = 0, gravity2 = 0;
  for (const double g : liquid.scene.fluid.gravity) gravity2 += g * g;
  strength = std::max(strength, std::sqrt(gravity2));
  for (int axis = 0; axis < liquid.dimensions; ++axis)
    size = std::max(size, liquid.scene.domain.upper[axis] - liquid.scene.domain.lower[axis]);
  return 50 * (liquid.wall_speed * liquid.wall_speed + strength * size);
}

double particle_mass(const Liquid& liquid) {
  return liquid.scene.fluid.density * liquid.volume;
}

double kinetic_energy(const Liquid& liquid, const VectorField& velocity) {
  return particle_mass(liquid) * parallel_sum(liquid.size(), [&](std::size_t i) {
           double speed2 = 0;
           for (int axis = 0; axis < liquid.dimensions; ++axis) speed2 += (*velocity[axis])[i] * (*velocity[axis])[i];
           return speed2 / 2;
         });
}

// Of gravity across axes with sides; along a periodic axis there is no height.
double potential_energy(const Liquid& liquid, const VectorField& position) {
  const Vec3& gravity = liquid.scene.fluid.gravity;
  return particle_mass(liquid) * parallel_sum(liquid.size(), [&](std::size_t i) {
           double sum = 0;
           for (int axis = 0; axis < liquid.dimensions; ++axis)
             if (!liquid.scene.domain.periodic(axis)) sum -= gravity[axis] * (*position[axis])[i];
           return sum;
         });
}

}  // namespace

double stored_energy(const Liquid& liquid) {
  const double c = liquid.scene.fluid.sound_speed, density = liquid.scene.fluid.density;
  if (!(c > 0)) return 0;
  return liquid.volume / (2 * density * c * c) *
         parallel_sum(liquid.size(), [&](std::size_t i) { return (*liquid.pressure)[i] * (*liquid.pressure)[i]; });
}

void start_energy(Liquid& liquid) {
  liquid.energy_supply =
      kinetic_energy(liquid, liquid.velocity) + potential_energy(liquid, liquid.position) + stored_energy(liquid);
}

double limited_energy_supply(const Liquid& liquid, double dt) {
  // The work of forces that vary in space has no such bound.
  if (liquid.plan.body_force && !liquid.uniform_body_force) return liquid.energy_supply;
  const int d = liquid.dimensions;
  const double mass = particle_mass(liquid), all = mass * static_cast<double>(liquid.size());
  const Vec3& gravity = liquid.scene.fluid.gravity;
  double supply = liquid.energy_supply, strength2 = 0;
  for (int axis = 0; axis < d; ++axis) {
    const double total = liquid.uniform_acceleration[axis] + liquid.periodic_acceleration[axis];
    strength2 += total * total;
    const double beside = total - (liquid.scene.domain.periodic(axis) ? 0.0 : gravity[axis]);
    if (beside != 0)
      supply +=
          dt * mass * beside * parallel_sum(liquid.size(), [&](std::size_t i) { return (*liquid.predicted[axis])[i]; });
  }
  const double kinetic = kinetic_energy(liquid, liquid.predicted);
  const double available = supply - potential_energy(liquid, liquid.intermediate);
  // Particles rearrange within a spacing; float sums leave 1e-6 of a smoothing length in a step.
  const double noise = 1e-6 * liquid.smoothing_length / dt;
  const double strength = std::sqrt(strength2);
  const double floor = all * (strength * liquid.scene.spacing + noise * noise + unfollowed_supply(liquid, strength));
  if (kinetic <= 2 * std::max(available, 0.0) + floor) return supply;
  StepFailure::Details details;
  double fastest2 = -1;
  for (std::size_t i = 0; i < liquid.size(); ++i) {
    double speed2 = 0;
    for (int axis = 0; axis < d; ++axis) speed2 += (*liquid.predicted[axis])[i] * (*liquid.predicted[axis])[i];
    if (!(speed2 > fastest2)) continue;
    fastest2 = speed2;
    details.particle = (*liquid.identifier)[i];
    for (int axis = 0; axis < d; ++axis) details.position[axis] = (*liquid.intermediate[axis])[i];
  }
  details.value = std::sqrt(fastest2);
  details.cause = "the kinetic energy is more than twice what the start and the forces supply";
  details.option = "time.courant";
  throw StepFailure(details);
}

}  // namespace spume::les_sph
