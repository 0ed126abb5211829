// SPDX-License-Identifier: MIT
// First derivatives by generalised finite differences (operators/gfd_moments.hpp): Joubert et al., equations (8), (14),
// (18) and (22). With d = r_j - r_i,
//
//   grad f        = B sum_j (f_j - f_i) W d                                                       (8)
//   grad f / rho  = B sum_j (f_j - f_i) / rho_ij W d,  rho_ij = (rho_i + rho_j) / 2               (22), (14)
//
// exact to rounding for linear f, and for linear f and constant rho. Images carry the scalar of their source.
#pragma once

#include <span>

#include "spume/operators/gfd_moments.hpp"
#include "spume/operators/image_values.hpp"

namespace spume {

// (8). Differences are formed from value - reference in float, so that a large constant part costs no digits.
void gfd_gradient_sweep(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
                        const std::array<const float*, 6>& correction, const std::array<float*, 3>& out);

// (22): the pressure gradient over the density. Densities are positive.
void gfd_gradient_over_density_sweep(const SweepContext& context, PackedNeighbours& packed, const double* values,
                                     double reference, const PhaseProperty& density,
                                     const std::array<const float*, 6>& correction, const std::array<float*, 3>& out);

// (14), and (18) of a viscosity that is not a function of one colour: the same for the listed particles alone. Others
// are not written. density: filtered, at all particles.
void gfd_gradient_over_density_subset(const SweepContext& context, PackedNeighbours& packed, const float* values,
                                      const float* density, const std::array<const float*, 6>& correction,
                                      std::span<const std::int32_t> subset, const std::array<float*, 3>& out);

// The trace of (8) of a velocity. B is symmetric: sum_j W (u_j - u_i) . B d.
void gfd_divergence_sweep(const SweepContext& context, PackedNeighbours& packed,
                          const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                          const std::array<const float*, 6>& correction, double* out);

// What a velocity changes by over a displacement s, sum_j W (u_j - u_i) d . B s, cut as VelocityGradientOut has it.
void gfd_change_sweep(const SweepContext& context, PackedNeighbours& packed,
                      const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                      const std::array<const float*, 6>& correction, const std::array<const float*, 3>& displacement,
                      const std::array<float*, 3>& out);

}  // namespace spume
