// SPDX-License-Identifier: MIT
#include "spume/operators/small_matrix.hpp"

#include <Eigen/Cholesky>

namespace spume {
namespace {

// One type for every size; its storage is on the stack.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 20, 20>;

}  // namespace

bool factor_cholesky(double* matrix, int size) {
  Eigen::Map<Eigen::MatrixXd> a(matrix, size, size);
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(a).info() == Eigen::Success;
}

void solve_cholesky(const double* factor, int size, double* vector) {
  const Eigen::Map<const Eigen::MatrixXd> lower(factor, size, size);
  Eigen::Map<Eigen::VectorXd> x(vector, size);
  lower.triangularView<Eigen::Lower>().solveInPlace(x);
  lower.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
}

double reciprocal_condition(const double* matrix, int size) {
  return Eigen::LDLT<SmallMatrix>(Eigen::Map<const Eigen::MatrixXd>(matrix, size, size)).rcond();
}

}  // namespace spume
