// SPDX-License-Identifier: MIT
// Diffusion of scalars that particles carry, and what a shift of the particles does to them: one sweep over the pairs
// for up to eight scalars.
//
// With g_ij of sph_operators.hpp taken at the smoothing length h of the context, whatever that of the particles, and
// volumes over that of the context, v_i = V_i / V,
//
//   dc_i/dt = sum_j 2 g_ij v_i v_j k_ij (c_j - c_i),   k_ij = (a_i + a_j) / 2 (D + (nu_i + nu_j) / (2 Sc)),
//
// with a_i, d / div r_i in the bulk, for what the sums lack of the Laplacian of a quadratic function. What a particle
// gains, V dc_i/dt, another loses: the pairs are antisymmetric but for the rounding of floats. Images of the sides of
// the domain exchange as the particles that they mirror, so that nothing passes a wall. Wall points of bodies, images
// in solid boxes and points behind openings exchange nothing.
//
// A particle that is shifted by s takes the change s . grad c with the corrected gradient (3.8), bounded by half of the
// extreme differences c_j - c_i from its neighbours.
#pragma once

#include <array>
#include <span>

#include "spume/operators/pair_sweep.hpp"

namespace spume {

struct ScalarSweepInput {
  std::span<const double* const> values;  // c per scalar and particle
  // Subtracted before values become floats. The least value keeps what is next to it exact: positive values stay so.
  std::span<const double> reference;
  std::span<const float> diffusivity;      // D per scalar
  const float* normalisation = nullptr;    // a per particle
  const float* eddy_viscosity = nullptr;   // nu per particle; null: none
  std::span<const float> inverse_schmidt;  // 1 / Sc per scalar; read with an eddy viscosity
  std::array<const float*, 3> shift{};     // s; null: no shift
  std::array<const float*, 6> correction{};
};

struct ScalarSweepOutput {
  std::span<float* const> rate;    // dc/dt per scalar and particle
  std::span<float* const> change;  // by the shift; read with one
  float* exchange = nullptr;       // the largest sum_j 2 g v_i v_j k_ij of all scalars, 1/time; null: not wanted
};

// Returns the number of sweeps: up to eight scalars share one.
std::int64_t scalar_transport_sweep(const SweepContext& context, PackedNeighbours& packed, const ScalarSweepInput& in,
                                    const ScalarSweepOutput& out);

// Rates and changes of scalars as part of a viscous sweep (sph_operators.hpp), whose records have room for them: the
// pairs, the kernel and kappa_i = nu a_i of a viscosity that is the same everywhere are there already. Particles are of
// one size, and lists reach no farther than their support.
inline constexpr std::size_t most_riding_scalars = 5;

struct RidingScalars {
  std::span<const double* const> values;  // c per scalar and particle, at most most_riding_scalars; none: nothing rides
  std::span<const double> reference;      // as of a sweep of their own
  std::span<const float> diffusivity;
  double viscosity = 0;                 // nu
  std::array<const float*, 3> shift{};  // s; null: no shift
  std::array<const float*, 6> correction{};
  std::span<float* const> rate;
  std::span<float* const> change;  // read with a shift
};

}  // namespace spume
