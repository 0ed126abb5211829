// SPDX-License-Identifier: MIT
// A step that makes energy from nothing is refused: without this an unstable run goes on for thousands of ever shorter
// steps, finite to the end, and reports success.
//
// The energy that a flow may hold is the supply: kinetic, potential and stored in the pressure at the start, and the
// work of the other forces since. A step is refused if the kinetic energy of its velocities is more than twice the
// supply less the present potential energy. A consistent scheme stays below once the supply; what an instability makes
// passes twice soon. Bubbles and moving walls add what they may give at most.
#pragma once

#include "spume/particles/boundary.hpp"

namespace spume {

struct EnergyBalance {
  double particle_mass = 0;
  Vec3 gravity{};
  double largest_acceleration = 0;  // that acts on a particle in the step, gravity included
  double work = 0;                  // of the step: of all forces but gravity across axes with sides
  bool unfollowed_work = false;     // bubbles or moving walls do work that is not followed
};

class EnergyGuard {
 public:
  EnergyGuard(const Domain& domain, const Resolution& resolution) : domain_(domain), resolution_(resolution) {}

  double supply = 0;  // state between steps

  // Kinetic energy, and potential energy across axes with sides.
  double held(const EnergyBalance& balance, const ParticleStore& particles) const;
  void start(const EnergyBalance& balance, const ParticleStore& particles, double stored_energy);
  // The supply at the end of a step; throws StepFailure. `at`: positions that the velocities belong to.
  double after_step(const EnergyBalance& balance, const ParticleStore& particles, const VectorField& at,
                    const VectorScratch& velocity, double wall_speed, double dt) const;

 private:
  // Kinetic, and potential of gravity across axes with sides.
  struct Energies {
    double kinetic = 0, potential = 0;
  };
  Energies energies(const EnergyBalance& balance, const std::array<const double*, 3>& position,
                    const std::array<const double*, 3>& velocity, std::size_t particles) const;
  const Domain& domain_;
  const Resolution& resolution_;
};

}  // namespace spume
