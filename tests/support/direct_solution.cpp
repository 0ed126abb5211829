// SPDX-License-Identifier: MIT
#include "support/direct_solution.hpp"

#include <umfpack.h>

#include <Eigen/QR>
#include <stdexcept>

namespace spume::test {

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.completeOrthogonalDecomposition().solve(right);
}

// UMFPACK by its own interface: Eigen's would have its products of matrices compiled too.
Eigen::VectorXd direct_solution(const Eigen::SparseMatrix<double>& matrix, const Eigen::VectorXd& right) {
  Eigen::SparseMatrix<double> columns = matrix;
  columns.makeCompressed();
  const int size = static_cast<int>(columns.rows());
  const int* starts = columns.outerIndexPtr();
  const int* rows = columns.innerIndexPtr();
  const double* entries = columns.valuePtr();
  void* symbolic = nullptr;
  void* numeric = nullptr;
  Eigen::VectorXd solution(size);
  int status = umfpack_di_symbolic(size, size, starts, rows, entries, &symbolic, nullptr, nullptr);
  if (status == UMFPACK_OK) status = umfpack_di_numeric(starts, rows, entries, symbolic, &numeric, nullptr, nullptr);
  if (status == UMFPACK_OK)
    status =
        umfpack_di_solve(UMFPACK_A, starts, rows, entries, solution.data(), right.data(), numeric, nullptr, nullptr);
  umfpack_di_free_numeric(&numeric);
  umfpack_di_free_symbolic(&symbolic);
  if (status != UMFPACK_OK) throw std::runtime_error("UMFPACK: the matrix is singular");
  return solution;
}

}  // namespace spume::test
