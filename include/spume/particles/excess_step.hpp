// SPDX-License-Identifier: MIT
// A step of the density of weakly compressible particles, s = rho / rho_0 - 1, and what it makes of their pressures and
// volumes; by runs of particles of one phase. What a scene does not have is null and costs nothing.
#pragma once

#include <cstdint>

#include "spume/particles/phase_law.hpp"
#include "spume/particles/store.hpp"

namespace spume {

struct ExcessStep {
  double dt = 0;
  int dimensions = 0;
  ParticleLaws law;
  const double* excess = nullptr;                  // at the start of the step
  const std::int64_t* left_out = nullptr;          // particles with 0 or more keep their density; null: none
  const float *rate = nullptr, *spread = nullptr;  // D; diffusion over the sound speed and `diffusion`
  double diffusion = 0;
  const double* lack = nullptr;  // what a share of is made up for
  double share = 0;
  const float* carried = nullptr;                // delta u . grad of the excess without its hydrostatic part
  std::array<const float*, 3> shift{};           // delta u, with `carried`
  Vec3 gravity{};                                // of the hydrostatic part
  double background = 0;                         // pressure
  double* next = nullptr;                        // s at the end of the step
  float *pressure = nullptr, *volume = nullptr;  // there; volume over that at rest

  // Particles first .. last - 1, a block at most.
  void advance(std::size_t first, std::size_t last) const;
};

// Of the state: volumes over those at rest, and excesses without the hydrostatic part g . (r - origin) / c^2.
struct ReducedExcess {
  int dimensions = 0;
  ParticleLaws law;
  const double* excess = nullptr;
  Vec3 gravity{}, origin{};
  std::array<const double*, 3> place{};
  float *volume = nullptr, *reduced = nullptr;

  void find(std::size_t first, std::size_t last) const;  // a block at most
};

}  // namespace spume
