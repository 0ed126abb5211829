// SPDX-License-Identifier: MIT
// The pressure matrix of the liquid, applied without being stored. Row i, times the particle volume V so that
// the matrix is symmetric for equal volumes:
//
//   (A q)_i = V [ sum_j 2 g_ij (q_i - q_j) + shift_i q_i ],
//
// the negative Morris Laplacian plus a diagonal (compressibility, penalty below a free surface). Masked rows
// belong to particles with a given value: they give zero, and vectors must be zero there.
#pragma once

#include <cstdint>
#include <span>

#include "spume/operators/pair_sweep.hpp"
#include "spume/operators/projection_matrix.hpp"

namespace spume {

// Where particles differ in size the sum is row_i sum_j 2 g_ij weight_j (q_i - q_j), with g at h_i: what the volumes
// V_j and a coefficient that is a geometric mean need. Float products then take weight_j q_j as their one payload and
// the sum of the weights from a sweep at bind, so that an application costs what it does with equal particles.
struct PressureMatrix {
  const float* diagonal_shift = nullptr;
  const std::uint8_t* masked = nullptr;  // null: no masked rows
  const float* weight = nullptr;         // where the context has sizes, and only there
  const float* row = nullptr;            // with weight
};

// y = A x in float, with sum w y and sum y y accumulated in double in fixed blocks.
class PressureOperator final : public ProjectionMatrix {
 public:
  // Throws std::logic_error unless the matrix has weights and rows exactly where the context has sizes.
  void bind(const SweepContext& context, PackedNeighbours& packed, const PressureMatrix& matrix);
  Dots apply(std::span<const float> x, std::span<float> y, std::span<const float> w) override;

  // r = b - A q with q in double: differences are exact and sums are double, so that the residual of a smooth
  // field does not drown in rounding (a float field of 100 spacings per wave would leave 1e-3). Masked rows
  // give zero, but their q enters their neighbours' rows.
  // `given` false: without the pressures given behind openings, as for a change of q.
  void residual(std::span<const double> q, std::span<const double> b, std::span<double> r, bool given = true) override;

  // r -= scale A x with x in float and all else as in residual(): what a correction x leaves of r. Masked rows keep r.
  void subtract_product(double scale, std::span<const float> x, std::span<double> r) override;

  std::size_t size() const override { return context_.list->particles(); }
  const SweepContext* context() const override { return &context_; }
  double bytes() const { return partial_.bytes() + weight_sum_.bytes(); }

 private:
  // Bytes per particle of the mask, and of `sizes` where particles differ in size.
  double mask_and_sizes(double sizes) const;

  SweepContext context_;
  PackedNeighbours* packed_ = nullptr;
  PressureMatrix matrix_;
  Array<Dots> partial_;
  Array<float> weight_sum_;  // sum_j F(q) weight_j
};

}  // namespace spume
