// SPDX-License-Identifier: MIT
#include "spume/solvers/null_space.hpp"

#include <cmath>
#include <numeric>

namespace spume {
namespace {

using Vector = std::vector<double>;

double product(const Vector& a, const Vector& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// Takes the components along `basis`, twice against rounding, and joins it unless little is left.
void join(Vector next, std::vector<Vector>& basis, double negligible) {
  const double before = std::sqrt(product(next, next));
  for (int round = 0; round < 2; ++round)
    for (const Vector& one : basis) {
      const double along = product(next, one);
      for (std::size_t k = 0; k < next.size(); ++k) next[k] -= along * one[k];
    }
  const double size = std::sqrt(product(next, next));
  if (!(size > negligible * before)) return;
  for (double& value : next) value /= size;
  basis.push_back(std::move(next));
}

}  // namespace

std::vector<Vector> null_space(std::vector<Vector> rows, std::size_t columns, double negligible) {
  std::vector<Vector> basis;
  for (Vector& row : rows) {
    for (double& value : row)
      if (std::abs(value) < negligible) value = 0;
    join(std::move(row), basis, negligible);
  }
  const std::size_t rank = basis.size();
  for (std::size_t k = 0; k < columns && basis.size() < columns; ++k) {
    Vector unit(columns, 0);
    unit[k] = 1;
    join(std::move(unit), basis, negligible);
  }
  return {basis.begin() + static_cast<std::ptrdiff_t>(rank), basis.end()};
}

}  // namespace spume
