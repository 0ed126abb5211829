// SPDX-License-Identifier: MIT
// Direct solutions for the slow twins. Compiled once: every source that has Eigen factorise pays seconds for it.
#pragma once

#include <Eigen/SparseCore>

namespace spume::test {

// The X of least norm among those with the least |matrix X - right|, by a complete orthogonal decomposition.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

// By UMFPACK. Throws std::runtime_error for a singular matrix.
Eigen::VectorXd direct_solution(const Eigen::SparseMatrix<double>& matrix, const Eigen::VectorXd& right);

}  // namespace spume::test
