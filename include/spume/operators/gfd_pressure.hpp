// SPDX-License-Identifier: MIT
// The pressure matrix of generalised finite differences (operators/gfd_moments.hpp), applied without being assembled:
// Joubert et al., equation (24). Row i, times the particle volume V,
//
//   (A q)_i = V [ -<lap q / rho>_i + shift_i q_i ],
//   <lap q / rho>_i = f_i sum_j (q_j - q_i) / rho_ij W (1 + d . o_i),  rho_ij = (rho_i + rho_j) / 2,  d = r_j - r_i.
//
// The matrix is not symmetric: o_i and f_i are those of the row. Without a shift and without masked rows it is singular
// in closed and periodic domains. Masked rows belong to particles with a given value: they give zero, and vectors must
// be zero there. With tied rows, which are masked too, their q follows from that of others (operators/tied_rows.hpp),
// whatever the vectors hold there. Its interface is that of PressureOperator.
#pragma once

#include <cstdint>
#include <span>

#include "spume/operators/gfd_moments.hpp"
#include "spume/operators/projection_matrix.hpp"
#include "spume/operators/tied_rows.hpp"

namespace spume {

// What is bound must live as long as the operator is applied.
struct GfdPressureMatrix {
  GfdStencils stencils;  // the correction is not read
  PhaseProperty density;
  const float* diagonal_shift = nullptr;  // null: none
  const std::uint8_t* masked = nullptr;   // null: no masked rows
  const TiedRows* tied = nullptr;         // null: none
};

// Rows where the density varies read weights with 1 / rho_ij that bind() stores, 4 bytes a pair: they then take 0.9
// times as long as the rows of one density, whose weights are found anew. With densities gathered for each application
// they took 2 times as long. bind() again when positions, stencils or densities change.
class GfdPressureOperator final : public ProjectionMatrix {
 public:
  // diagonal: that of A, with the particle's own images in it, 1 in masked rows; found on the way, empty: not wanted.
  void bind(const SweepContext& context, PackedNeighbours& packed, const GfdPressureMatrix& matrix,
            std::span<float> diagonal = {});
  // y = A x in float, with sum w y and sum y y accumulated in double in fixed blocks.
  Dots apply(std::span<const float> x, std::span<float> y, std::span<const float> w) override;

  // r = b - A q with q, differences and sums in double, as PressureOperator::residual. Masked rows give zero, but their
  // q enters their neighbours' rows. No pressure is given behind openings.
  void residual(std::span<const double> q, std::span<const double> b, std::span<double> r, bool given = true) override;

  // r -= scale A x with x in float and all else as in residual(). Masked rows keep r.
  void subtract_product(double scale, std::span<const float> x, std::span<double> r) override;

  std::size_t size() const override { return context_.list->particles(); }
  const SweepContext* context() const override { return &context_; }
  const TiedRows* tied() const override { return matrix_.tied; }
  double bytes() const {
    return partial_.bytes() + first_weight_.bytes() + block_start_.bytes() + weight_.bytes() + extended_.bytes() +
           extended_double_.bytes();
  }

 private:
  void place_weights();
  void find_weights(std::span<float> diagonal);
  template <class T>
  const T* extended(std::span<const T> x, bool given, Array<T>& room) const;

  SweepContext context_;
  PackedNeighbours* packed_ = nullptr;
  GfdPressureMatrix matrix_;
  Array<Dots> partial_;
  // W (1 + d . o) / rho_ij of the rows where the density varies, in the order of their lists and padded to batches; the
  // batch that a row begins with, and that of its block.
  Array<float> weight_;
  Array<std::uint32_t> first_weight_, block_start_;
  Array<float> extended_;  // with tied rows alone
  Array<double> extended_double_;
};

}  // namespace spume
