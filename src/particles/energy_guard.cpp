// SPDX-License-Identifier: MIT
#include "spume/particles/energy_guard.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/unrolled.hpp"

namespace spume {
namespace {

// The work of bubbles and of moving walls is not followed. What it may give is taken large: ten times the speed of a
// wall, or of a fall from the top of the domain to its bottom, for all of the liquid.
double unfollowed_supply(const EnergyBalance& balance, const Domain& domain, double strength, double wall_speed) {
  if (!balance.unfollowed_work) return 0;
  // Gravity drives bubbles also where a force on the liquid cancels it.
  double size = 0, gravity2 = 0;
  for (const double g : balance.gravity) gravity2 += g * g;
  strength = std::max(strength, std::sqrt(gravity2));
  for (int axis = 0; axis < domain.dimensions; ++axis) size = std::max(size, domain.upper[axis] - domain.lower[axis]);
  return 50 * (wall_speed * wall_speed + strength * size);
}

struct EnergiesPerMass {
  double kinetic = 0, potential = 0;
};

template <int dimensions>
EnergiesPerMass energies_of(const std::array<const double*, 3>& position, const std::array<const double*, 3>& velocity,
                            const Vec3& gravity, std::size_t first, std::size_t last) {
  EnergiesPerMass sums;
  for (std::size_t i = first; i < last; ++i) {
    double speed2 = 0, potential = 0;
    unrolled<dimensions>([&](auto axis) {
      speed2 += velocity[axis][i] * velocity[axis][i];
      potential -= gravity[axis] * position[axis][i];
    });
    sums.kinetic += speed2 / 2;
    sums.potential += potential;
  }
  return sums;
}

}  // namespace

EnergyGuard::Energies EnergyGuard::energies(const EnergyBalance& balance, const std::array<const double*, 3>& position,
                                            const std::array<const double*, 3>& velocity, std::size_t particles) const {
  // Along a periodic axis there is no height.
  Vec3 gravity = balance.gravity;
  for (int axis = 0; axis < domain_.dimensions; ++axis)
    if (domain_.periodic(axis)) gravity[axis] = 0;
  const EnergiesPerMass sums = parallel_reduce(
      particles, EnergiesPerMass{},
      [&](std::size_t first, std::size_t last) {
        return domain_.dimensions == 3 ? energies_of<3>(position, velocity, gravity, first, last)
                                       : energies_of<2>(position, velocity, gravity, first, last);
      },
      [](const EnergiesPerMass& a, const EnergiesPerMass& b) {
        return EnergiesPerMass{a.kinetic + b.kinetic, a.potential + b.potential};
      });
  return {balance.particle_mass * sums.kinetic, balance.particle_mass * sums.potential};
}

double EnergyGuard::held(const EnergyBalance& balance, const ParticleStore& particles) const {
  const Energies now = energies(balance, read(particles.position), read(particles.velocity), particles.size());
  return now.kinetic + now.potential;
}

void EnergyGuard::start(const EnergyBalance& balance, const ParticleStore& particles, double stored_energy) {
  supply = held(balance, particles) + stored_energy;
}

double EnergyGuard::after_step(const EnergyBalance& balance, const ParticleStore& particles, const VectorField& at,
                               const VectorScratch& velocity, double wall_speed, double dt) const {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  const double mass = balance.particle_mass, all = mass * static_cast<double>(n);
  const double next_supply = supply + balance.work;
  const auto [kinetic, potential] = energies(balance, read(at), read(velocity), n);
  const double available = next_supply - potential;
  // Particles rearrange within a spacing; float sums leave 1e-6 of a smoothing length in a step.
  const double noise = 1e-6 * resolution_.smoothing_length / dt;
  const double strength = balance.largest_acceleration;
  const double floor = all * (strength * resolution_.spacing + noise * noise +
                              unfollowed_supply(balance, domain_, strength, wall_speed));
  if (kinetic <= 2 * std::max(available, 0.0) + floor) return next_supply;
  StepFailure::Details details;
  double fastest2 = -1;
  for (std::size_t i = 0; i < n; ++i) {
    const double speed2 = squared_norm(velocity, d, i);
    if (!(speed2 > fastest2)) continue;
    fastest2 = speed2;
    details.particle = (*particles.identifier)[i];
    for (int axis = 0; axis < d; ++axis) details.position[axis] = (*at[axis])[i];
  }
  details.value = std::sqrt(fastest2);
  details.cause = "the kinetic energy is more than twice what the start and the forces supply";
  details.option = "time.courant";
  throw StepFailure(details);
}

}  // namespace spume
