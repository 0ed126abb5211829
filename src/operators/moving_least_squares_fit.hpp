// SPDX-License-Identifier: MIT
// Definitions of MovingLeastSquares, instantiated in one file per dimension.
#pragma once

#include <algorithm>
#include <cmath>
#include <experimental/simd>
#include <tuple>

#include "least_reciprocal_condition.hpp"
#include "small_cholesky.hpp"
#include "spume/operators/moving_least_squares.hpp"

namespace spume {

namespace {

using Pack = std::experimental::native_simd<double>;
using std::experimental::element_aligned;

// A squared pivot is the part of a monomial that the ones before it do not explain: below this the moments are singular
// to the rounding of their sums.
constexpr double smallest_pivot = 1e-10;

// table[i][j]: the monomial that is the product of monomials i and j.
template <int Dimensions, int Order>
constexpr auto product_index = [] {
  using Products = Monomials<Dimensions, 2 * MovingLeastSquares<Dimensions>::highest_order>;
  constexpr std::size_t size = monomial_count(Dimensions, Order);
  std::array<std::array<std::size_t, size>, size> table{};
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) {
      auto sum = Products::exponents[i];
      for (int axis = 0; axis < Dimensions; ++axis) sum[axis] += Products::exponents[j][axis];
      table[i][j] = Products::find(sum);
    }
  return table;
}();

template <int Dimensions>
std::array<Pack, Dimensions> load(const std::array<std::vector<double>, Dimensions>& offset, std::size_t n) {
  std::array<Pack, Dimensions> x;
  for (int axis = 0; axis < Dimensions; ++axis) x[axis].copy_from(&offset[axis][n], element_aligned);
  return x;
}

}  // namespace

template <int Dimensions>
struct MomentFactors {
  template <int Order>
  using Cholesky = detail::SmallCholesky<static_cast<int>(monomial_count(Dimensions, Order))>;
  template <int Order>
  auto& of() {
    return std::get<Cholesky<Order>>(orders);
  }
  std::tuple<Cholesky<1>, Cholesky<2>, Cholesky<3>> orders;
};

template <int Dimensions>
MovingLeastSquares<Dimensions>::MovingLeastSquares() : factors_(std::make_unique<MomentFactors<Dimensions>>()) {}
template <int Dimensions>
MovingLeastSquares<Dimensions>::~MovingLeastSquares() = default;

template <int Dimensions>
void MovingLeastSquares<Dimensions>::resize(std::size_t count) {
  const std::size_t padded = (count + Pack::size() - 1) / Pack::size() * Pack::size();
  for (auto& component : offset_) {
    if (component.size() < padded) component.resize(padded);
    std::fill(component.begin() + static_cast<std::ptrdiff_t>(count),
              component.begin() + static_cast<std::ptrdiff_t>(padded), 0.0);
  }
  for (auto* values : {&weight_, &coefficient_})
    if (values->size() < padded) values->resize(padded);
  std::fill(weight_.begin() + static_cast<std::ptrdiff_t>(count), weight_.begin() + static_cast<std::ptrdiff_t>(padded),
            0.0);
  count_ = count;
  measured_ = order_ = -1;
}

// Sums of W p up to a degree.
template <int Dimensions>
template <int Degree>
void MovingLeastSquares<Dimensions>::measure() {
  if (measured_ >= Degree) return;
  constexpr std::size_t size = monomial_count(Dimensions, Degree);
  std::array<Pack, size> sums;
  sums.fill(Pack(0));
  for (std::size_t n = 0; n < count_; n += Pack::size())
    Products::template for_each<size>(load<Dimensions>(offset_, n), Pack(&weight_[n], element_aligned),
                                      [&](auto index, const Pack& value) { sums[index] += value; });
  for (std::size_t m = 0; m < size; ++m) moments_[m] = reduce(sums[m]);
  measured_ = Degree;
}

// M = S L L^T S with S^2 its diagonal.
template <int Dimensions>
template <int Order>
bool MovingLeastSquares<Dimensions>::factor_order() {
  constexpr std::size_t size = monomial_count(Dimensions, Order);
  order_ = -1;
  measure<2 * Order>();
  for (std::size_t i = 0; i < size; ++i) {
    const double diagonal = moments_[product_index<Dimensions, Order>[i][i]];
    if (!(diagonal > 0)) return false;
    scale_[i] = 1 / std::sqrt(diagonal);
  }
  auto& cholesky = factors_->template of<Order>();
  for (std::size_t j = 0; j < size; ++j) {
    cholesky.column[j].fill(0);
    for (std::size_t i = j; i < size; ++i)
      cholesky.column[j][i] = moments_[product_index<Dimensions, Order>[i][j]] * (scale_[i] * scale_[j]);
  }
  if (!cholesky.factor(smallest_pivot)) return false;
  order_ = Order;
  return true;
}

// Of the moments as they are, in the 1-norm: scaled, two planes that nearly coincide would pass for neighbours on all
// sides.
template <int Dimensions>
template <int Order>
double MovingLeastSquares<Dimensions>::reciprocal_condition() const {
  constexpr std::size_t size = monomial_count(Dimensions, Order);
  double norm = 0;
  for (std::size_t j = 0; j < size; ++j) {
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i) sum += std::abs(moments_[product_index<Dimensions, Order>[i][j]]);
    norm = std::max(norm, sum);
  }
  typename MomentFactors<Dimensions>::template Cholesky<Order>::Vector scale{};
  std::copy_n(scale_.begin(), size, scale.begin());
  return 1 / (norm * factors_->template of<Order>().inverse_norm(scale));
}

template <int Dimensions>
bool MovingLeastSquares<Dimensions>::factor(int order) {
  if (order >= 3) return factor_order<3>();
  if (order == 2) return factor_order<2>();
  if (order == 1) return factor_order<1>();
  measure<0>();
  order_ = moments_[0] > 0 ? 0 : -1;
  return order_ == 0;
}

template <int Dimensions>
int MovingLeastSquares<Dimensions>::fit(int order) {
  for (int o = std::min(order, 2); o > 0; --o) {
    if (count_ <= 2 * monomial_count(Dimensions, o)) continue;
    const double reciprocal_condition =
        !factor(o) ? 0 : (o == 2 ? this->reciprocal_condition<2>() : this->reciprocal_condition<1>());
    if (reciprocal_condition > detail::least_reciprocal_condition[static_cast<std::size_t>(o)]) return o;
  }
  return factor(0) ? 0 : -1;
}

// c_j for `factor` times the coefficient of a monomial.
template <int Dimensions>
template <int Order>
void MovingLeastSquares<Dimensions>::solve(std::size_t monomial, double factor) {
  constexpr std::size_t size = monomial_count(Dimensions, Order);
  typename MomentFactors<Dimensions>::template Cholesky<Order>::Vector polynomial{};
  polynomial[monomial] = factor * scale_[monomial];
  factors_->template of<Order>().solve(polynomial);
  for (std::size_t i = 0; i < size; ++i) polynomial[i] *= scale_[i];
  Pack sum = 0;
  for (std::size_t n = 0; n < count_; n += Pack::size()) {
    Pack coefficient = 0;
    Products::template for_each<size>(load<Dimensions>(offset_, n), Pack(&weight_[n], element_aligned),
                                      [&](auto index, const Pack& value) { coefficient += polynomial[index] * value; });
    coefficient.copy_to(&coefficient_[n], element_aligned);
    sum += abs(coefficient);
  }
  amplification_ = reduce(sum);
}

template <int Dimensions>
void MovingLeastSquares<Dimensions>::average() {
  for (std::size_t n = 0; n < count_; ++n) coefficient_[n] = weight_[n] / moments_[0];
  amplification_ = 1;
}

template <int Dimensions>
std::span<const double> MovingLeastSquares<Dimensions>::coefficients(std::size_t monomial, double factor) {
  if (order_ < 0 || monomial >= monomial_count(Dimensions, order_)) {
    std::fill_n(coefficient_.begin(), count_, 0.0);
    amplification_ = 0;
  } else if (order_ == 0) {
    average();
  } else if (order_ == 1) {
    solve<1>(monomial, factor);
  } else if (order_ == 2) {
    solve<2>(monomial, factor);
  } else {
    solve<3>(monomial, factor);
  }
  return {coefficient_.data(), count_};
}

template <int Dimensions>
std::span<const double> MovingLeastSquares<Dimensions>::value() {
  return coefficients(0, 1);
}

template <int Dimensions>
std::span<const double> MovingLeastSquares<Dimensions>::gradient(int axis, double h) {
  typename Products::Exponents wanted{};
  wanted[static_cast<std::size_t>(axis)] = 1;
  return coefficients(Products::find(wanted), 1 / h);
}

template <int Dimensions>
std::span<const double> MovingLeastSquares<Dimensions>::second_derivative(int a, int b, double h) {
  typename Products::Exponents wanted{};
  ++wanted[static_cast<std::size_t>(a)];
  ++wanted[static_cast<std::size_t>(b)];
  return coefficients(Products::find(wanted), (a == b ? 2 : 1) / (h * h));
}

}  // namespace spume
