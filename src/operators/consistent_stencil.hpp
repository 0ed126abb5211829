// SPDX-License-Identifier: MIT
// The stencil of one grid point of grid_interpolation.hpp: selects its neighbours, weighs them, and chooses the order
// of the fit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <numbers>
#include <span>
#include <vector>

#include "spume/operators/moving_least_squares.hpp"

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

  // The candidates within `support_radius` of the point x become the neighbours, in their order; their offsets are in
  // units of that radius. Distances come first, in a loop without branches, since 5 of 6 candidates are farther.
  void select(const std::array<double, 3>& x, double support_radius) {
    const std::size_t candidates = candidate_[0].size();
    if (source_.size() < candidates + Pack::size())
      for (auto* values : {&squared_, &distance2_}) values->resize(candidates + Pack::size());
    source_.resize(squared_.size());
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
    fit_.resize(count_);
    for (std::size_t n = 0; n < count_; ++n) {
      distance2_[n] = squared_[source_[n]];
      for (int axis = 0; axis < Dimensions; ++axis)
        fit_.offset(axis)[n] = (candidate_[axis][source_[n]] - x[axis]) * scale;
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
    // Neighbours that fill the last pack sit on the edge of the support, where the kernel is zero.
    for (std::size_t n = count_; n % Pack::size() != 0; ++n) distance2_[n] = 1;
    Pack sum = 0, nearest = 1;
    for (std::size_t n = 0; n < count_; n += Pack::size()) {
      Pack squared(&distance2_[n], std::experimental::element_aligned);
      nearest = std::experimental::min(nearest, squared);
      const Pack distance = sqrt(squared);
      const Pack rest = 1.0 - distance;
      const Pack kernel = (rest * rest) * (rest * rest) * (1.0 + 4.0 * distance);
      sum += kernel;
      kernel.copy_to(&fit_.weight()[n], std::experimental::element_aligned);
    }
    kernel_sum_ = reduce(sum);
    nearest_ = std::sqrt(hmin(nearest));
  }

  // The weights of the highest order that is well-conditioned and amplifies noise by no more than the limit.
  StencilOrder solve(double largest_amplification) {
    if (!(kernel_sum_ > 0)) return StencilOrder::none;
    const auto bears = [&](int order) {
      if (!fit_.factor(order)) return false;
      weight_ = fit_.value();
      return fit_.amplification() <= largest_amplification;
    };
    if (count_ >= monomial_count(Dimensions, 3) && bears(3)) return StencilOrder::cubic;
    if (count_ >= monomial_count(Dimensions, 1) && bears(1)) return StencilOrder::linear;
    fit_.factor(0);
    weight_ = fit_.value();
    return StencilOrder::shepard;
  }

 private:
  // 1 / integral of (1 - s)^4 (1 + 4 s) over the unit disc and ball.
  static constexpr double normalisation = Dimensions == 2 ? 7 / std::numbers::pi : 21 / (2 * std::numbers::pi);

  std::size_t count_ = 0;
  std::array<std::vector<double>, Dimensions> candidate_;
  std::vector<double> squared_;        // of the candidates
  std::vector<double> distance2_;      // of the neighbours, over the squared support radius
  std::vector<std::uint32_t> source_;  // candidate of each neighbour
  MovingLeastSquares<Dimensions> fit_;
  std::span<const double> weight_;  // of the neighbours
  double kernel_sum_ = 0;
  double nearest_ = 1;
};

}  // namespace spume::detail
