// SPDX-License-Identifier: MIT
#include "spume/solvers/limited_change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/operators/small_matrix.hpp"

namespace spume {
namespace {

// Relative to the terms of a sum: what rounding leaves of one that is zero, and of limits that depend on each other.
constexpr double negligible = 1e-10;

std::span<const double> row_of(const Limits& limits, std::size_t k) {
  return {&limits.row[k * limits.unknowns], limits.unknowns};
}

double product(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::vector<double> times(std::span<const double> matrix, std::span<const double> x) {
  std::vector<double> result(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = product(matrix.subspan(i * x.size(), x.size()), x);
  return result;
}

// By how much x falls short of a limit; beyond rounding.
double shortfall(const Limits& limits, std::size_t k, std::span<const double> x) {
  const std::span<const double> row = row_of(limits, k);
  double sum = 0, size = std::abs(limits.limit[k]);
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += row[i] * x[i];
    size += std::abs(row[i] * x[i]);
  }
  const double short_by = limits.limit[k] - sum;
  return short_by > negligible * size ? short_by : 0;
}

// The matrix of what the limits held do to each other, N^T m^-1 N, factored, and m^-1 N.
struct HeldLimits {
  std::vector<std::vector<double>> column;  // m^-1 row
  std::vector<double> factor;
  bool positive = true;  // all of its pivots
};
HeldLimits factored(std::span<const double> inverse, const Limits& limits, std::span<const std::size_t> held) {
  HeldLimits found;
  for (const std::size_t k : held) found.column.push_back(times(inverse, row_of(limits, k)));
  found.factor.resize(held.size() * held.size());
  for (std::size_t i = 0; i < held.size(); ++i)
    for (std::size_t j = 0; j < held.size(); ++j)
      found.factor[i * held.size() + j] = product(row_of(limits, held[i]), found.column[j]);
  found.positive = factor_cholesky(found.factor.data(), static_cast<int>(held.size()));
  return found;
}

void solve(const HeldLimits& held, std::vector<double>& vector) {
  solve_cholesky(held.factor.data(), static_cast<int>(vector.size()), vector.data());
}

}  // namespace

LimitedChange nearest_within(std::span<const double> inverse, std::span<const double> x0, const Limits& limits) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  LimitedChange found;
  found.x.assign(x0.begin(), x0.end());
  std::vector<double>& x = found.x;
  const auto drop = [&](std::size_t place) {
    found.held.erase(found.held.begin() + static_cast<std::ptrdiff_t>(place));
    found.multiplier.erase(found.multiplier.begin() + static_cast<std::ptrdiff_t>(place));
  };
  // Every round meets one more limit at a higher cost, so that none comes back; the bound is against rounding alone.
  for (std::size_t round = 0; round < 10 * (limits.size() + 1); ++round) {
    std::size_t worst = 0;
    double most = 0;
    for (std::size_t k = 0; k < limits.size(); ++k) {
      if (std::find(found.unmet.begin(), found.unmet.end(), k) != found.unmet.end()) continue;
      if (const double own = shortfall(limits, k, x); own > most) {
        most = own;
        worst = k;
      }
    }
    if (most == 0) break;
    const std::span<const double> row = row_of(limits, worst);
    const std::vector<double> alone = times(inverse, row);
    const double own = product(row, alone);
    for (double multiplier = 0;;) {
      const HeldLimits held = factored(inverse, limits, found.held);
      std::vector<double> less(found.held.size());
      for (std::size_t j = 0; j < less.size(); ++j) less[j] = product(row_of(limits, found.held[j]), alone);
      solve(held, less);
      std::vector<double> way = alone;
      for (std::size_t j = 0; j < less.size(); ++j)
        for (std::size_t i = 0; i < way.size(); ++i) way[i] -= less[j] * held.column[j][i];
      const double gain = product(row, way);
      // One that depends on those held is met by none of their ways.
      const double full = gain > negligible * own ? (limits.limit[worst] - product(row, x)) / gain : infinite;
      double step = full;
      std::size_t first = less.size();
      for (std::size_t j = 0; j < less.size(); ++j)
        if (less[j] > 0 && found.multiplier[j] / less[j] < step) {
          step = found.multiplier[j] / less[j];
          first = j;
        }
      if (step == infinite) {
        found.unmet.push_back(worst);
        break;
      }
      if (full < infinite)
        for (std::size_t i = 0; i < way.size(); ++i) x[i] += step * way[i];
      for (std::size_t j = 0; j < less.size(); ++j) found.multiplier[j] -= step * less[j];
      multiplier += step;
      if (first == less.size()) {
        found.held.push_back(worst);
        found.multiplier.push_back(multiplier);
        break;
      }
      drop(first);
    }
  }
  return found;
}

bool independent(std::span<const double> inverse, const Limits& limits, std::span<const std::size_t> held) {
  const HeldLimits factors = factored(inverse, limits, held);
  if (!factors.positive) return false;
  for (std::size_t j = 0; j < held.size(); ++j) {
    // The square of a pivot is what is left of a row without those before it.
    const double pivot = factors.factor[j * held.size() + j];
    if (!(pivot * pivot > negligible * product(row_of(limits, held[j]), factors.column[j]))) return false;
  }
  return true;
}

HeldChange holding(std::span<const double> inverse, const Limits& limits, std::span<const std::size_t> held) {
  const std::size_t n = limits.unknowns;
  HeldChange found{{inverse.begin(), inverse.end()}, std::vector<double>(n, 0)};
  const HeldLimits factors = factored(inverse, limits, held);
  std::vector<double> pull(held.size());
  for (std::size_t k = 0; k < held.size(); ++k) pull[k] = limits.limit[held[k]];
  solve(factors, pull);
  for (std::size_t k = 0; k < held.size(); ++k)
    for (std::size_t i = 0; i < n; ++i) found.given[i] += pull[k] * factors.column[k][i];
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<double> less(held.size());
    for (std::size_t k = 0; k < held.size(); ++k) less[k] = factors.column[k][j];
    solve(factors, less);
    for (std::size_t k = 0; k < held.size(); ++k)
      for (std::size_t i = 0; i < n; ++i) found.change[i * n + j] -= factors.column[k][i] * less[k];
  }
  return found;
}

bool is_nearest(std::span<const double> inverse, std::span<const double> force, const Limits& limits,
                std::span<const std::size_t> held, std::span<const double> x) {
  for (std::size_t k = 0; k < limits.size(); ++k)
    if (std::find(held.begin(), held.end(), k) == held.end() && shortfall(limits, k, x) > 0) return false;
  // multiplier = (N^T m^-1 N)^-1 N^T (x - m^-1 F)
  const std::vector<double> free = times(inverse, force);
  std::vector<double> multiplier(held.size());
  double size = 0;
  for (std::size_t k = 0; k < held.size(); ++k)
    multiplier[k] = limits.limit[held[k]] - product(row_of(limits, held[k]), free);
  solve(factored(inverse, limits, held), multiplier);
  for (const double value : multiplier) size = std::max(size, std::abs(value));
  return std::all_of(multiplier.begin(), multiplier.end(), [&](double value) { return value >= -negligible * size; });
}

}  // namespace spume
