// SPDX-License-Identifier: MIT
#include "least_reciprocal_condition.hpp"
#include "spume/operators/moving_least_squares.hpp"
#include "spume/operators/small_matrix.hpp"

namespace spume {

void LinearFit::add(double weight, const std::array<double, 3>& offset, const std::array<double, fields>& values) {
  const std::array<double, 4> basis{1, offset[0], offset[1], offset[2]};
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 4; ++row) {
      moments_[column * 4 + row] += weight * basis[row] * basis[column];
      values_[column * 4 + row] += weight * basis[row] * values[column];
    }
  ++count_;
}

LinearFit::Result LinearFit::at_centre() const {
  const int monomials = dimensions_ == 2 ? 3 : 4;
  std::array<double, 16> matrix;
  for (int column = 0; column < monomials; ++column)
    for (int row = 0; row < monomials; ++row) matrix[column * monomials + row] = moments_[column * 4 + row];
  const bool fitted = count_ > 2 * monomials &&
                      reciprocal_condition(matrix.data(), monomials) > detail::least_reciprocal_condition[1] &&
                      factor_cholesky(matrix.data(), monomials);
  Result result{{}, fitted};
  if (!fitted) {
    for (std::size_t field = 0; field < fields; ++field) result.value[field] = values_[field * 4] / weight();
    return result;
  }
  // The value at the centre is the first coefficient: row 0 of M^-1 times the sums.
  std::array<double, 4> row{1, 0, 0, 0};
  solve_cholesky(matrix.data(), monomials, row.data());
  for (std::size_t field = 0; field < fields; ++field)
    for (int m = 0; m < monomials; ++m) result.value[field] += row[m] * values_[field * 4 + m];
  return result;
}

}  // namespace spume
