// SPDX-License-Identifier: MIT
// The SPH diffusion of momentum of Hu and Adams (2006), Joubert et al., equation (13):
//
//   <mu lap u> = 1 / V_i sum_j mu_ij (V_i^2 + V_j^2) (u_i - u_j) r_ij . grad_i W / |r_ij|^2,
//
// mu_ij the harmonic mean 2 mu_i mu_j / (mu_i + mu_j). With equal volumes it is the div-grad of sph_operators.hpp. The
// normalisation of W, which (4) gives without h, is 7 / (478 pi h^2) for the quintic spline in two dimensions and
// 1 / (120 pi h^3) in three. No sum is corrected: the support must be full, and particles displaced at random by a
// fixed share of the spacing give an error that grows as the spacing falls.
#pragma once

#include "spume/operators/gfd_stress.hpp"

namespace spume {

// volume: V_i per particle. Of the properties it reads the viscosity and the density, as gfd_stress_sweep does; the
// result is an acceleration, or a force per volume without a density.
void hu_adams_sweep(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
                    const VelocityImageRule& rule, const float* volume, const DiffusionProperties& properties,
                    const std::array<float*, 3>& out);

}  // namespace spume
