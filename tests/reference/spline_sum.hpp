// SPDX-License-Identifier: MIT
// Slow twins of the particle-grid routines: sums over the definition, with every index wrapped.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "spume/core/periodic_grid.hpp"

namespace spume::test {

// Cardinal B-spline of `order` points centred at 0, by the truncated powers
//   B(x) = 1/(m-1)! sum_k (-1)^k C(m, k) max(0, x + m/2 - k)^(m-1).
inline double b_spline(int order, double x) {
  double sum = 0, binomial = 1, factorial = 1;
  for (int k = 2; k < order; ++k) factorial *= k;
  for (int k = 0; k <= order; ++k) {
    const double base = x + 0.5 * order - k;
    if (base > 0) sum += (k % 2 == 0 ? 1 : -1) * binomial * std::pow(base, order - 1);
    binomial *= static_cast<double>(order - k) / (k + 1);
  }
  return std::abs(x) >= 0.5 * order ? 0 : sum / factorial;
}

// Derivative: the difference of two splines of one order less.
inline double b_spline_slope(int order, double x) {
  const auto lower = [&](double y) {
    double sum = 0, binomial = 1, factorial = 1;
    const int m = order - 1;
    for (int k = 2; k < m; ++k) factorial *= k;
    for (int k = 0; k <= m; ++k) {
      const double base = y + 0.5 * m - k;
      if (base > 0) sum += (k % 2 == 0 ? 1 : -1) * binomial * std::pow(base, m - 1);
      binomial *= static_cast<double>(m - k) / (k + 1);
    }
    return std::abs(y) >= 0.5 * m ? 0 : sum / factorial;
  };
  return lower(x + 0.5) - lower(x - 0.5);
}

// sum over all coefficients near the point; derivative along `axis`, or the value for axis -1.
inline double spline_sum(const PeriodicGrid& grid, const std::vector<double>& c, int order,
                         const std::array<double, 3>& x, int axis) {
  int base[3];
  double place[3];
  for (int a = 0; a < 3; ++a) {
    place[a] = (x[a] - grid.lower[a]) / grid.spacing(a);
    base[a] = static_cast<int>(std::floor(place[a]));
  }
  const auto factor = [&](int a, int i) {
    return a == axis ? b_spline_slope(order, place[a] - i) / grid.spacing(a) : b_spline(order, place[a] - i);
  };
  const auto wrap = [&](int i, int a) { return (i % grid.points[a] + grid.points[a]) % grid.points[a]; };
  double sum = 0;
  for (int i = base[0] - order; i <= base[0] + order; ++i)
    for (int j = base[1] - order; j <= base[1] + order; ++j)
      for (int k = base[2] - order; k <= base[2] + order; ++k)
        sum += factor(0, i) * factor(1, j) * factor(2, k) *
               c[grid.row(wrap(i, 0), wrap(j, 1)) + static_cast<std::size_t>(wrap(k, 2))];
  return sum;
}

// Amounts of particles spread by the product of hat functions; per volume of a grid cell.
inline std::vector<double> linear_spread(const PeriodicGrid& grid, const std::vector<std::array<double, 3>>& x,
                                         const std::vector<double>& amount) {
  std::vector<double> field(grid.storage());
  const auto wrap = [&](int i, int a) { return (i % grid.points[a] + grid.points[a]) % grid.points[a]; };
  for (std::size_t p = 0; p < x.size(); ++p) {
    double place[3];
    int base[3];
    for (int a = 0; a < 3; ++a) {
      place[a] = (x[p][a] - grid.lower[a]) / grid.spacing(a);
      base[a] = static_cast<int>(std::floor(place[a]));
    }
    for (int i = base[0]; i <= base[0] + 1; ++i)
      for (int j = base[1]; j <= base[1] + 1; ++j)
        for (int k = base[2]; k <= base[2] + 1; ++k)
          field[grid.row(wrap(i, 0), wrap(j, 1)) + static_cast<std::size_t>(wrap(k, 2))] +=
              amount[p] / grid.cell_volume() * b_spline(2, place[0] - i) * b_spline(2, place[1] - j) *
              b_spline(2, place[2] - k);
  }
  return field;
}

}  // namespace spume::test
