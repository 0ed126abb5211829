// SPDX-License-Identifier: MIT
// Generalised finite differences (GFD): what their operators need to know of the arrangement of the particles.
//
// The gradient of Lanson and Vila (2008) and the Laplacian of Basic et al. (2018), as in Joubert, Wilke and Pizette,
// equations (8) to (11). With d = r_j - r_i = -r_ij and a weight W_ij = w(|d| / h) that needs no normalisation,
//
//   B   = (sum_j W d (x) d)^-1                                   (10)   truncation tensor, 1 / length^2
//   o   = -B sum_j W d                                           (11)   offset vector, 1 / length
//   f   = 2 dim / sum_j |d|^2 W (1 + d . o)                      of (9) Laplacian factor, 1 / length^2
//
// The gradient is exact for linear fields on any arrangement; the Laplacian for linear fields too, and for quadratic
// ones where the arrangement has the symmetry of a lattice. The paper's weight is the quintic spline with a support of
// 2.5 spacings on lattices, 2.5 + 2 c where particles are displaced by up to c spacings; KernelKind chooses it or the
// Wendland function.
//
// Every operator takes particles of one size, lists of the current positions and images (operators/image_values.hpp)
// that fill the support at walls and periodic sides, and throws std::logic_error for a context with sizes. Symmetric
// matrices are xx, xy, yy or xx, xy, xz, yy, yz, zz. Results have the same bits for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "spume/operators/pair_sweep.hpp"

namespace spume {

// Why a particle has less than the full stencil.
enum class GfdFallback : std::uint8_t {
  none = 0,
  no_offset = 1,  // o = 0: the denominator of f nearly vanishes, as at a corner without images
  isotropic = 2,  // and B = (mean of the diagonal of the sum)^-1 I: neighbours in a plane, on a line or none
};

// Results of the sweep, one entry per particle; null is not computed.
struct GfdMoments {
  std::array<float*, 6> correction{};  // B
  std::array<float*, 3> offset{};      // o
  float* laplacian_factor = nullptr;   // f
  GfdFallback* fallback = nullptr;
  // Of all particles alone: sum_j V W, the particle itself included, and as KernelMoments has it, with the sum.
  float* kernel_sum = nullptr;
  std::array<float*, 3> concentration_gradient{};
  double spacing = 0;  // of the latter
};

// The same as the operators read it. Without any neighbour all of it is zero, and so is every derivative.
struct GfdStencils {
  std::array<const float*, 6> correction{};
  std::array<const float*, 3> offset{};
  const float* laplacian_factor = nullptr;
};

void gfd_moment_sweep(const SweepContext& context, PackedNeighbours& packed, const GfdMoments& out);
// The same for the listed particles alone. Others are not written.
void gfd_moment_subset(const SweepContext& context, PackedNeighbours& packed, std::span<const std::int32_t> subset,
                       const GfdMoments& out);

// A property of the fluids that jumps where they meet: its filtered value at each particle, and whether it varies
// within the support of the particle, as InterfaceBands finds. `varies` null: it does not, anywhere.
struct PhaseProperty {
  const float* value = nullptr;
  const std::uint8_t* varies = nullptr;
};

}  // namespace spume
