// SPDX-License-Identifier: MIT
// Local polynomial fits by weighted least squares around one point (P. Lancaster, K. Salkauskas, Math. Comp. 37
// (1981)).
//
// Neighbours j lie at offsets xi_j = (r_j - r) / h from the point r and have weights W_j >= 0. The polynomial c . p(xi)
// of a given order that minimises sum_j W_j (c . p(xi_j) - f_j)^2 has c = M^-1 sum_j W_j p(xi_j) f_j with the moments
// M = sum_j W_j p(xi_j) p(xi_j)^T. Its value and its derivatives at r are sums over the neighbours,
//
//   sum_j c_j f_j,   c_j = W_j (M^-1 D p(0)) . p(xi_j),   D = 1, d/dx_a or d2/(dx_a dx_b),
//
// exact for polynomials of that order. Of order 0 the value is the average with the weights (Shepard).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "spume/operators/monomials.hpp"

namespace spume {

template <int Dimensions>
struct MomentFactors;

// Coefficients c_j for neighbours that are kept. One per thread, used again for the next point.
template <int Dimensions>
class MovingLeastSquares {
 public:
  static constexpr int highest_order = 3;

  MovingLeastSquares();
  ~MovingLeastSquares();

  // A point with `count` neighbours. The caller fills offset(axis)[j] and weight()[j] for j < count before anything
  // else is asked.
  void resize(std::size_t count);
  std::size_t size() const { return count_; }
  double* offset(int axis) { return offset_[axis].data(); }
  double* weight() { return weight_.data(); }

  // The highest order up to `order` (at most 2) that the neighbours bear, -1 where they have no weight: more than twice
  // as many neighbours as monomials, and moments with a reciprocal condition number above 1e-3 for order 1 and 2e-4 for
  // order 2. Neighbours in a plane, on a line or barely seen fall back to a lower order. On lattices with the Wendland
  // kernel and an h of 1.3 or 2 spacings, order 1 has 0.3, 0.06 to 0.09 at plane surfaces and edges, 0.03 half a
  // spacing outside; order 2 has 0.04, 1.6e-3 to 5e-3 at surfaces and edges, 1e-3 half a spacing outside, or 1e-6 where
  // the third layer is at the edge of the support.
  int fit(int order);

  // The order as given, 0 to 3: false where the moments are singular to rounding. What it amplifies the caller judges.
  bool factor(int order);

  // c_j of the last fit. Derivatives beyond its order are zero. Valid until the next call.
  std::span<const double> value();
  std::span<const double> gradient(int axis, double h);
  std::span<const double> second_derivative(int a, int b, double h);
  // sum_j |c_j| of the last coefficients: the most that noise of unit amplitude gives.
  double amplification() const { return amplification_; }

 private:
  using Products = Monomials<Dimensions, 2 * highest_order>;  // all products of two monomials of the basis
  static constexpr std::size_t most_monomials = monomial_count(Dimensions, highest_order);

  template <int Degree>
  void measure();
  template <int Order>
  bool factor_order();
  template <int Order>
  double reciprocal_condition() const;
  template <int Order>
  void solve(std::size_t monomial, double factor);
  std::span<const double> coefficients(std::size_t monomial, double factor);
  void average();

  std::size_t count_ = 0;
  std::array<std::vector<double>, Dimensions> offset_;  // these and the next two padded to whole vectors
  std::vector<double> weight_;
  std::vector<double> coefficient_;
  int measured_ = -1;  // degree up to which moments_ are known
  std::array<double, Products::size> moments_{};
  int order_ = -1;
  std::unique_ptr<MomentFactors<Dimensions>> factors_;  // of each order
  std::array<double, most_monomials> scale_{};          // of the moments to a unit diagonal
  double amplification_ = 0;
};

// The linear fit of four fields at once, for neighbours that come one by one and are not kept. It is taken where more
// than 2 (d + 1) neighbours have moments with a reciprocal condition number above 1e-3; elsewhere, in spray and thin
// sheets, the average with the weights is the safer value.
class LinearFit {
 public:
  static constexpr std::size_t fields = 4;

  explicit LinearFit(int dimensions) : dimensions_(dimensions) {}

  // offset: (r_j - r) / h, zero beyond the dimensions.
  void add(double weight, const std::array<double, 3>& offset, const std::array<double, fields>& values);

  int count() const { return count_; }
  double weight() const { return moments_[0]; }  // sum_j W_j

  // Values of the fields at r. `fitted`: false for the average. Precondition: a neighbour.
  struct Result {
    std::array<double, fields> value;
    bool fitted;
  };
  Result at_centre() const;

 private:
  int dimensions_;
  int count_ = 0;
  alignas(32) std::array<double, 16> moments_{},
      values_{};  // of (1, offset) with itself and with the fields, by columns
};

}  // namespace spume
