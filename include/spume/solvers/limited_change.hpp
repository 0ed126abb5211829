// SPDX-License-Identifier: MIT
// Quadratic programs of a few unknowns and many limits, as bodies in contact pose them (Gauss's principle of least
// constraint): the x nearest to x_0 in the norm of a symmetric positive definite matrix m with
//
//   row_k . x >= limit_k.
//
// By the dual method of Goldfarb and Idnani, Math. Program. 27 (1983): limits are taken up one by one, and no more than
// there are unknowns, all independent, are ever held. So it does not matter how many of them say the same.
#pragma once

#include <span>
#include <vector>

namespace spume {

struct Limits {
  std::size_t unknowns = 0;
  std::vector<double> row;    // unknowns entries each
  std::vector<double> limit;  // one each
  std::size_t size() const { return limit.size(); }
};

struct LimitedChange {
  std::vector<double> x;
  std::vector<std::size_t> held;   // limits that hold as equalities, in the order in which they were taken up
  std::vector<double> multiplier;  // of each, >= 0: m (x - x_0) = sum multiplier row
  std::vector<std::size_t> unmet;  // limits that contradict those held
};
// `inverse`: of m, square.
LimitedChange nearest_within(std::span<const double> inverse, std::span<const double> x0, const Limits& limits);

// With those of `held` as equalities, x = x_0 changes to x = change F + given for m x_0 = F.
struct HeldChange {
  std::vector<double> change;  // square
  std::vector<double> given;
};
// Whether limits can be held together: no row is a sum of the others.
bool independent(std::span<const double> inverse, const Limits& limits, std::span<const std::size_t> held);
// `held` are independent.
HeldChange holding(std::span<const double> inverse, const Limits& limits, std::span<const std::size_t> held);

// Whether x, found with `held` as equalities for m x_0 = F, is what nearest_within() finds.
bool is_nearest(std::span<const double> inverse, std::span<const double> force, const Limits& limits,
                std::span<const std::size_t> held, std::span<const double> x);

}  // namespace spume
