// SPDX-License-Identifier: MIT
// The weights of a moving-least-squares stencil for one point: the arithmetic behind grid_interpolation.hpp.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <numbers>
#include <vector>

#include "spume/operators/monomials.hpp"

namespace spume::detail {

enum class StencilOrder { none, shepard, linear, cubic };

// Works on the candidates that the caller appends: all particles that may lie in the support of the points to come.
template <int Dimensions>
class ConsistentStencil {
 public:
  using Pack = std::experimental::native_simd<double>;

  void clear_candidates() {
    for (auto& component : candidate_) component.clear();
  }
  void append_candidate(const std::array<double, 3>& position) {
    for (int axis = 0; axis < Dimensions; ++axis) candidate_[axis].push_back(position[axis]);
  }

  // The candidates within `reach` of the point x become the neighbours, in their order; their offsets are in units
  // of the reach. Distances come first, in a loop without branches, since 5 of 6 candidates are out of reach.
  void select(const std::array<double, 3>& x, double support_radius) {
    reserve(candidate_[0].size());
    const std::size_t candidates = candidate_[0].size();
    const double scale = 1 / support_radius;
    for (std::size_t n = 0; n < candidates; ++n) {
      double squared = 0;
      for (int axis = 0; axis < Dimensions; ++axis) {
        const double offset = (candidate_[axis][n] - x[axis]) * scale;
        squared += offset * offset;
      }
      squared_[n] = squared;
    }
    count_ = 0;
    for (std::size_t n = 0; n < candidates; ++n) {
      source_[count_] = static_cast<std::uint32_t>(n);
      count_ += squared_[n] < 1.0 ? 1 : 0;
    }
    for (std::size_t n = 0; n < count_; ++n) {
      kernel_[n] = squared_[source_[n]];
      for (int axis = 0; axis < Dimensions; ++axis) offset_[axis][n] = (candidate_[axis][source_[n]] - x[axis]) * scale;
    }
  }

  std::size_t count() const { return count_; }
  double weight(std::size_t n) const { return weight_[n]; }
  std::size_t source(std::size_t n) const { return source_[n]; }

  // After evaluate_kernel: distance to the nearest neighbour over the support radius, and the fraction of the kernel
  // filled by particles of volume `volume` (in units of the support radius to the power of the dimension).
  double nearest() const { return nearest_; }
  double filled(double volume) const { return kernel_sum_ * volume * normalisation; }

  void evaluate_kernel() {
    pad();
    Pack sum = 0, nearest = 1;
    for (std::size_t n = 0; n < count_; n += Pack::size()) {
      Pack squared(&kernel_[n], std::experimental::element_aligned);
      nearest = std::experimental::min(nearest, squared);
      const Pack distance = sqrt(squared);
      const Pack rest = 1.0 - distance;
      const Pack kernel = (rest * rest) * (rest * rest) * (1.0 + 4.0 * distance);
      sum += kernel;
      kernel.copy_to(&kernel_[n], std::experimental::element_aligned);
    }
    kernel_sum_ = reduce(sum);
    nearest_ = std::sqrt(hmin(nearest));
  }

  // The weights of the highest order that is well-conditioned and amplifies noise by no more than the limit.
  StencilOrder solve(double largest_amplification) {
    if (!(kernel_sum_ > 0)) return StencilOrder::none;
    Moments moments;
    bool measured = false;
    if (count_ >= cubic_size) {
      moments = measure();
      measured = true;
      if (solve_for<cubic_size>(moments) && evaluate_weights<cubic_size>() <= largest_amplification)
        return StencilOrder::cubic;
    }
    if (count_ > Dimensions) {
      if (!measured) moments = measure();
      if (solve_for<Dimensions + 1>(moments) && evaluate_weights<Dimensions + 1>() <= largest_amplification)
        return StencilOrder::linear;
    }
    for (std::size_t n = 0; n < count_; ++n) weight_[n] = kernel_[n] / kernel_sum_;
    return StencilOrder::shepard;
  }

 private:
  using Products = Monomials<Dimensions, 6>;  // all products of two cubic monomials
  static constexpr std::size_t cubic_size = monomial_count(Dimensions, 3);
  using Moments = std::array<double, Products::size>;
  // 1 / integral of (1 - s)^4 (1 + 4 s) over the unit disc and ball.
  static constexpr double normalisation = Dimensions == 2 ? 7 / std::numbers::pi : 21 / (2 * std::numbers::pi);

  // product_index[i][j]: the monomial that is the product of monomials i and j.
  static constexpr std::array<std::array<std::size_t, cubic_size>, cubic_size> product_index = [] {
    std::array<std::array<std::size_t, cubic_size>, cubic_size> table{};
    for (std::size_t i = 0; i < cubic_size; ++i)
      for (std::size_t j = 0; j < cubic_size; ++j) {
        auto sum = Products::exponents[i];
        for (int axis = 0; axis < Dimensions; ++axis) sum[axis] += Products::exponents[j][axis];
        table[i][j] = Products::find(sum);
      }
    return table;
  }();

  void reserve(std::size_t candidates) {
    const std::size_t padded = candidates + Pack::size();
    if (kernel_.size() >= padded) return;
    for (auto& component : offset_) component.resize(padded);
    for (auto* values : {&squared_, &kernel_, &weight_}) values->resize(padded);
    source_.resize(padded);
  }

  // Neighbours that fill the last pack sit on the edge of the support, where the kernel is zero.
  void pad() {
    for (std::size_t n = count_; n % Pack::size() != 0; ++n) {
      for (auto& component : offset_) component[n] = 0;
      kernel_[n] = 1;
    }
  }

  std::array<Pack, Dimensions> load(std::size_t n) const {
    std::array<Pack, Dimensions> x;
    for (int axis = 0; axis < Dimensions; ++axis)
      x[axis].copy_from(&offset_[axis][n], std::experimental::element_aligned);
    return x;
  }

  Moments measure() const {
    std::array<Pack, Products::size> sums;
    sums.fill(Pack(0));
    for (std::size_t n = 0; n < count_; n += Pack::size())
      Products::template for_each<Products::size>(load(n), Pack(&kernel_[n], std::experimental::element_aligned),
                                                  [&](auto index, const Pack& value) { sums[index] += value; });
    Moments moments;
    for (std::size_t m = 0; m < Products::size; ++m) moments[m] = reduce(sums[m]);
    return moments;
  }

  // Solves M c = p(0) for the first Size monomials, M scaled to a unit diagonal. False when M is numerically
  // singular: a squared pivot is the part of a monomial that the ones before it do not explain.
  template <std::size_t Size>
  bool solve_for(const Moments& moments) {
    constexpr double smallest_pivot = 1e-10;
    Eigen::Matrix<double, Size, Size> matrix;
    std::array<double, Size> scale;
    for (std::size_t i = 0; i < Size; ++i) {
      const double diagonal = moments[product_index[i][i]];
      if (!(diagonal > 0)) return false;
      scale[i] = 1 / std::sqrt(diagonal);
    }
    for (std::size_t j = 0; j < Size; ++j)
      for (std::size_t i = j; i < Size; ++i) matrix(i, j) = moments[product_index[i][j]] * (scale[i] * scale[j]);
    const Eigen::LLT<Eigen::Ref<Eigen::Matrix<double, Size, Size>>> factor(matrix);
    if (factor.info() != Eigen::Success) return false;
    for (std::size_t i = 0; i < Size; ++i)
      if (!(matrix(i, i) * matrix(i, i) > smallest_pivot)) return false;
    Eigen::Matrix<double, Size, 1> solution = Eigen::Matrix<double, Size, 1>::Zero();
    solution(0) = scale[0];
    factor.solveInPlace(solution);
    for (std::size_t i = 0; i < Size; ++i) coefficient_[i] = solution(i) * scale[i];
    return true;
  }

  // w_j = W_j c . p(xi_j); returns sum |w_j|.
  template <std::size_t Size>
  double evaluate_weights() {
    Pack amplification = 0;
    for (std::size_t n = 0; n < count_; n += Pack::size()) {
      Pack weight = 0;
      Products::template for_each<Size>(load(n), Pack(&kernel_[n], std::experimental::element_aligned),
                                        [&](auto index, const Pack& value) { weight += coefficient_[index] * value; });
      weight.copy_to(&weight_[n], std::experimental::element_aligned);
      amplification += abs(weight);
    }
    return reduce(amplification);
  }

  std::size_t count_ = 0;
  std::array<std::vector<double>, Dimensions> candidate_;
  std::vector<double> squared_;  // of the candidates
  std::array<std::vector<double>, Dimensions> offset_;
  std::vector<double> kernel_;  // squared distance until evaluate_kernel, the kernel after it
  std::vector<double> weight_;
  std::vector<std::uint32_t> source_;  // candidate of each neighbour
  std::array<double, cubic_size> coefficient_{};
  double kernel_sum_ = 0;
  double nearest_ = 1;
};

}  // namespace spume::detail
