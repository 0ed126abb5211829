// SPDX-License-Identifier: MIT
// The x nearest to x_0 under limits by trying every set of them: of those whose equalities meet the others, the
// nearest.
#pragma once

#include <limits>
#include <optional>

#include "spume/solvers/limited_change.hpp"
#include "support/direct_solution.hpp"

namespace spume::reference {

inline std::optional<Eigen::VectorXd> nearest_within(const Eigen::MatrixXd& mass, const Eigen::VectorXd& x0,
                                                     const Limits& limits) {
  const Eigen::Index n = x0.size();
  std::optional<Eigen::VectorXd> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t set = 0; set < std::size_t{1} << limits.size(); ++set) {
    Eigen::MatrixXd rows(0, n);
    Eigen::VectorXd values(0);
    for (std::size_t k = 0; k < limits.size(); ++k) {
      if ((set >> k & 1) == 0) continue;
      rows.conservativeResize(rows.rows() + 1, n);
      values.conservativeResize(rows.rows());
      rows.row(rows.rows() - 1) = Eigen::Map<const Eigen::RowVectorXd>(&limits.row[k * limits.unknowns], n);
      values(rows.rows() - 1) = limits.limit[k];
    }
    Eigen::VectorXd x = x0;
    if (rows.rows() > 0) {
      const Eigen::MatrixXd shares = test::least_squares(mass, rows.transpose());
      x += shares * test::least_squares(rows.lazyProduct(shares), values - rows * x0).col(0);
    }
    bool meets = true;
    for (std::size_t k = 0; k < limits.size(); ++k) {
      const Eigen::Map<const Eigen::RowVectorXd> row(&limits.row[k * limits.unknowns], n);
      meets = meets && row.dot(x) >= limits.limit[k] - 1e-9 * (1 + std::abs(limits.limit[k]));
    }
    const double away = (x - x0).dot(mass * (x - x0));
    if (!meets || away >= least) continue;
    least = away;
    best = x;
  }
  return best;
}

}  // namespace spume::reference
