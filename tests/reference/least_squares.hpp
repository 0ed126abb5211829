// SPDX-License-Identifier: MIT
// Slow twin of moving_least_squares.hpp: the polynomial with the least weighted squares by an orthogonal decomposition
// of the neighbours' rows sqrt(W_j) p(xi_j); the moments do not appear.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "support/direct_solution.hpp"

namespace spume::reference {

struct Neighbour {
  std::array<double, 3> offset{};  // over h
  double weight = 0;
};

// Exponents of the monomials of up to `order` in `dimensions` coordinates, by degree.
inline std::vector<std::array<int, 3>> exponents(int dimensions, int order) {
  std::vector<std::array<int, 3>> list;
  for (int degree = 0; degree <= order; ++degree)
    for (int a = degree; a >= 0; --a)
      for (int b = degree - a; b >= 0; --b)
        if (const int c = degree - a - b; dimensions == 3 || c == 0) list.push_back({a, b, c});
  return list;
}

// Row m: the coefficients c_j for which sum_j c_j f_j is the coefficient of monomial m.
inline Eigen::MatrixXd fit_coefficients(int dimensions, int order, const std::vector<Neighbour>& neighbours) {
  const auto list = exponents(dimensions, order);
  Eigen::MatrixXd rows(neighbours.size(), list.size());
  Eigen::MatrixXd roots = Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
  for (Eigen::Index j = 0; j < rows.rows(); ++j) {
    const Neighbour& neighbour = neighbours[static_cast<std::size_t>(j)];
    roots(j, j) = std::sqrt(neighbour.weight);
    for (Eigen::Index m = 0; m < rows.cols(); ++m) {
      double value = roots(j, j);
      for (std::size_t a = 0; a < 3; ++a) value *= std::pow(neighbour.offset[a], list[static_cast<std::size_t>(m)][a]);
      rows(j, m) = value;
    }
  }
  return test::least_squares(rows, roots);
}

}  // namespace spume::reference
