// SPDX-License-Identifier: MIT
#include <Eigen/Cholesky>

#include "reciprocal_condition.hpp"
#include "spume/operators/moving_least_squares.hpp"

namespace spume {
namespace {

using FourByFour = Eigen::Map<Eigen::Matrix4d, Eigen::Aligned32>;
using ReadFourByFour = Eigen::Map<const Eigen::Matrix4d, Eigen::Aligned32>;
// One type for every size: the factorisation and its estimate of the condition number compile once, and allocate
// nothing. At most 10 monomials, padded to whole vectors: of fewer GCC 12 fears for what Eigen never reads.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 16, 16>;

}  // namespace

double detail::reciprocal_condition(const double* matrix, int size) {
  return Eigen::LDLT<SmallMatrix>(Eigen::Map<const Eigen::MatrixXd>(matrix, size, size)).rcond();
}

void LinearFit::add(double weight, const std::array<double, 3>& offset, const std::array<double, fields>& values) {
  FourByFour moments(moments_.data()), sums(values_.data());
  const Eigen::Vector4d basis(1, offset[0], offset[1], offset[2]);
  const Eigen::Vector4d value(values[0], values[1], values[2], values[3]);
  moments += weight * basis * basis.transpose();
  sums += weight * basis * value.transpose();
  ++count_;
}

LinearFit::Result LinearFit::at_centre() const {
  const ReadFourByFour moments(moments_.data()), sums(values_.data());
  const int monomials = dimensions_ + 1;
  const Eigen::LDLT<SmallMatrix> factor(moments.topLeftCorner(monomials, monomials));
  Eigen::RowVector4d result = sums.row(0) / weight();
  const bool fitted = count_ > 2 * monomials && factor.info() == Eigen::Success &&
                      factor.rcond() > detail::least_reciprocal_condition[1];
  if (fitted) {
    const SmallMatrix solution = factor.solve(sums.topRows(monomials));
    result = solution.row(0);
  }
  return {{result[0], result[1], result[2], result[3]}, fitted};
}

}  // namespace spume
