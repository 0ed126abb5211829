// SPDX-License-Identifier: MIT
// Energies and largest values of weakly compressible phases, for their series.
#pragma once

#include <cstdint>

#include "spume/particles/phase_law.hpp"
#include "spume/particles/store.hpp"

namespace spume {

struct PhaseEnergies {
  double kinetic = 0;      // rho u^2 / 2, integral
  double potential = 0;    // -rho g . x, integral
  double compression = 0;  // rho e, integral
  double reference = 0;    // P_r, integral
  double largest_speed = 0;
  // With the kinetic one it is what pairs of particles conserve.
  double stored() const { return potential + compression + reference; }

  struct State {
    const ParticleStore& particles;
    ParticleLaws law;
    const double* excess = nullptr;
    Vec3 gravity{};
    const std::int64_t* left_out = nullptr;  // particles with 0 or more do not count; null: all do
    // P_r = reference_gradient . (r - reference_place) - background, which forces leave out of P: what a volume gains
    // by it, like heights, is energy.
    Vec3 reference_gradient{}, reference_place{};
    double background = 0;
  };
};

// One pass over the particles.
PhaseEnergies phase_energies(const PhaseEnergies::State& state);

// Largest |s| of a phase, of those not left out. No phases: all are of it.
double largest_excess(std::size_t phase, const Array<std::int64_t>& phases, const Array<double>& excess,
                      const std::int64_t* left_out);

}  // namespace spume
