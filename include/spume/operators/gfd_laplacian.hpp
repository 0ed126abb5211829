// SPDX-License-Identifier: MIT
// The Laplacian of a scalar by generalised finite differences (operators/gfd_moments.hpp), Joubert et al., equation
// (9). With d = r_j - r_i,
//
//   lap f = f_L sum_j (f_j - f_i) W (1 + d . o),  f_L the Laplacian factor.
//
// Zero to rounding for linear f on any arrangement, exact for quadratic f on lattices. For smooth f its error is of
// second order on lattices; where particles are displaced at random by a fixed share of the spacing it tends to a
// floor, 0.03 of the Laplacian at a tenth of a spacing. Differences of floats leave an error of at most about
// 2^-24 4 |f| / spacing^2: that of Franke's function comes down to it at 300 spacings.
#pragma once

#include "spume/operators/gfd_moments.hpp"

namespace spume {

// `gradient`, (8) from the same pass, may be null. Differences are formed from value - reference in float.
struct GfdLaplacian {
  float* laplacian = nullptr;
  std::array<float*, 3> gradient{};
};
void gfd_laplacian_sweep(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
                         const GfdStencils& stencils, const GfdLaplacian& out);

}  // namespace spume
