// SPDX-License-Identifier: MIT
// Potentials that jump at interfaces, in the pairwise form of the pressure gradient and Laplacian, Joubert et al., (22)
// and (24). With d = r_j - r_i, rho_ij = (rho_i + rho_j) / 2 and phi_ij = (phi_i + phi_j) / 2,
//
//   a_i = B sum_j phi_ij (C_j - C_i) / rho_ij W d,
//   s_i = f sum_j phi_ij (C_j - C_i) / rho_ij W (1 + d . o).
//
// Where phi is uniform these are <grad(phi C) / rho> and <lap(phi C) / rho> term by term: the pressure phi C balances
// the force exactly, whatever the densities and the arrangement. phi = sigma kappa is the tension of the interface,
// phi = -(rho_1 - rho_0) g . x its weight in terms of the reduced pressure p - rho g . x, x a point of the interface.
// Applied per particle ((17), and g) the same forces leave flows of the size of the jump (Francois et al. 2006 for
// grids).
#pragma once

#include "spume/operators/gfd_moments.hpp"
#include "spume/operators/interface_bands.hpp"

namespace spume {

struct InterfaceJump {
  const float* colour = nullptr;     // C
  const float* potential = nullptr;  // phi
  const float* density = nullptr;    // filtered
};

// Added to; null is not computed.
struct InterfaceForce {
  std::array<float*, 3> acceleration{};
  double* source = nullptr;
};
// Of the particles `subset`, which are those that see a jump: InterfaceBands::facing() for the colour of the phases.
void interface_jump_sweep(const SweepContext& context, PackedNeighbours& packed, std::span<const std::int32_t> subset,
                          const InterfaceJump& jump, const GfdStencils& stencils, const InterfaceForce& out);

// sum_j W s_j v_j / sum_j W s_j with the particle itself, of the particles `subset`; s is not negative, and 0 off the
// mixed ones. Continues what is known on an interface across its band. Where all s vanish: 0. Others are not written.
void interface_average_sweep(const SweepContext& context, PackedNeighbours& packed,
                             std::span<const std::int32_t> subset, const float* weight, const float* value, float* out);

}  // namespace spume
