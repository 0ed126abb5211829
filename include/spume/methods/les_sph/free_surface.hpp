// SPDX-License-Identifier: MIT
// The free surface: which particles form it, how the shift ends on it, and p = 0 on it.
//
// p = 0 holds on the surface itself, a depth s above an edge particle i along the outward normal n = -m / |m|, with
// m = sum_j g_ij d_ij (see sph_operators.hpp). The liquid is mirrored there with the opposite pressure, which gives,
// weighted with 1 - b (b: interior weight) and for q = p + potential with uniform acceleration a,
//
//   lap:    row i gains  E (p_i - p0_i),  E = 2 |m| / s,   p0_i = -s a . n  the hydrostatic pressure at depth s,
//   grad:   L' (sum_j g (q_j - q_i) d + 2 (p_i - p0_i) m),   L' = (M + (2 s / |m|) m m^T)^-1,  M = sum_j g d d^T.
//
// Both are exact for linear fields, whatever s, and on a lattice the gradient along n is sum_j g (p_i + p_j) d, the
// adjoint of the divergence sum_j g (u_j - u_i) . d: pressure does no work of its own at the surface.
//
// Elsewhere it does the work -int (s - s_V) u . grad p dS per time, where s_V is the depth at which the liquid between
// particle and surface has the volume that the particles hold. So s is found by volume: what a column along n holds
// beyond what it holds under a lattice. Half the distance of the layers, in place of it, is 15 % too little on the
// front of a breaking wave, where the surface shrinks and crowds its particles: such a wave of 100 spacings gained 3 %
// of its energy before it broke, and gains 0.05 % now.
#pragma once

#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {

// Classifies particles by div r, finds normals, edge depths and the weights of the shift. After measure_geometry.
void find_surface(Liquid& liquid);

// E (1 - b) of edge particle k, per volume, and the hydrostatic pressure p0 over the density.
struct SurfaceRow {
  double laplacian_diagonal = 0;
  double hydrostatic_pressure = 0;
};
SurfaceRow surface_row(const Liquid& liquid, std::size_t k);

// Completes the gradient of q of all edge particles: L sum g (q_j - q_i) d in, the expression above out, in
// liquid.acceleration.
void complete_surface_gradient(Liquid& liquid);

}  // namespace spume::les_sph
