// SPDX-License-Identifier: MIT
#include "support/direct_solution.hpp"

#include <Eigen/QR>
#include <Eigen/UmfPackSupport>
#include <stdexcept>

namespace spume::test {

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.completeOrthogonalDecomposition().solve(right);
}

Eigen::VectorXd direct_solution(const Eigen::SparseMatrix<double>& matrix, const Eigen::VectorXd& right) {
  const Eigen::UmfPackLU<Eigen::SparseMatrix<double>> factor(matrix);
  if (factor.info() != Eigen::Success) throw std::runtime_error("UMFPACK: the matrix is singular");
  return factor.solve(right);
}

}  // namespace spume::test
