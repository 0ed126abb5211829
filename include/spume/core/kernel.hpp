// SPDX-License-Identifier: MIT
// Smoothing kernels as compile-time policies. With q = r / h, W = sigma_d / h^d w(q), and
// F(q) = w'(q) / q, so that grad W = sigma_d / h^(d+2) F(q) r_vec: F is finite at q = 0 and no pair loop
// divides by the distance. Both functions are zero beyond the support radius without a branch. The variance is that of
// W along one direction, over h^2; the kurtosis its fourth moment over the square of the variance.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/simd.hpp"

namespace spume {

// Wendland C2 (Wendland 1995): w = (1 - q/2)^4 (2q + 1), support 2h.
// sigma_2 = 7/(4 pi), sigma_3 = 21/(16 pi).
struct WendlandC2 {
  static constexpr double support = 2;
  static constexpr double normalisation(int dimensions) {
    return dimensions == 2 ? 7 / (4 * std::numbers::pi) : 21 / (16 * std::numbers::pi);
  }
  static constexpr double variance(int dimensions) { return dimensions == 2 ? 5.0 / 18 : 4.0 / 15; }
  static constexpr double kurtosis(int dimensions) { return dimensions == 2 ? 756.0 / 275 : 30.0 / 11; }
  static double w(double q) {
    const double s = std::max(0.0, 1 - q / 2);
    return s * s * s * s * (2 * q + 1);
  }
  static double f(double q) {
    const double s = std::max(0.0, 1 - q / 2);
    return -5 * s * s * s;
  }
  template <simd::FloatVector V>
  [[gnu::always_inline]] static V w(V q) {
    const V s = simd::max(1.0F - 0.5F * q, simd::splat<V>(0));
    const V s2 = s * s;
    return s2 * s2 * (2.0F * q + 1.0F);
  }
  template <simd::FloatVector V>
  [[gnu::always_inline]] static V f(V q) {
    const V s = simd::max(1.0F - 0.5F * q, simd::splat<V>(0));
    return (s * s) * (-5.0F * s);  // two products one after the other, not three
  }
};

// Quintic spline (Morris, Fox & Zhu 1997): w = (3-q)^5 - 6 (2-q)^5 + 15 (1-q)^5, terms cut at zero, support 3h.
// sigma_2 = 7/(478 pi), sigma_3 = 1/(120 pi).
struct QuinticSpline {
  static constexpr double support = 3;
  static constexpr double normalisation(int dimensions) {
    return dimensions == 2 ? 7 / (478 * std::numbers::pi) : 1 / (120 * std::numbers::pi);
  }
  static constexpr double variance(int dimensions) { return dimensions == 2 ? 2771.0 / 5736 : 7.0 / 15; }
  static constexpr double kurtosis(int dimensions) { return dimensions == 2 ? 236429316.0 / 84462851 : 960.0 / 343; }
  static double w(double q) {
    const double a = std::max(0.0, 3 - q), b = std::max(0.0, 2 - q), c = std::max(0.0, 1 - q);
    return std::pow(a, 5) - 6 * std::pow(b, 5) + 15 * std::pow(c, 5);
  }
  static double f(double q) {
    if (q < 1) return -120 + q * (0 + q * (120 - 50 * q));
    const double a = std::max(0.0, 3 - q), b = std::max(0.0, 2 - q);
    return -5 * (std::pow(a, 4) - 6 * std::pow(b, 4)) / q;
  }
  template <simd::FloatVector V>
  [[gnu::always_inline]] static V w(V q) {
    const auto fifth = [](V x) {
      const V x2 = x * x;
      return x2 * x2 * x;
    };
    const V zero = simd::splat<V>(0);
    return fifth(simd::max(3.0F - q, zero)) - 6.0F * fifth(simd::max(2.0F - q, zero)) +
           15.0F * fifth(simd::max(1.0F - q, zero));
  }
  template <simd::FloatVector V>
  [[gnu::always_inline]] static V f(V q) {
    const auto fourth = [](V x) {
      const V x2 = x * x;
      return x2 * x2;
    };
    // Near the centre the three quartics cancel to -120 q + 120 q^3 - 50 q^4: the expanded form is exact there.
    const V zero = simd::splat<V>(0);
    const V inner = -120.0F + q * q * (120.0F - 50.0F * q);
    const V outer = -5.0F * (fourth(simd::max(3.0F - q, zero)) - 6.0F * fourth(simd::max(2.0F - q, zero))) /
                    simd::max(q, simd::splat<V>(0.5F));
    return q < 1.0F ? inner : outer;
  }
};

}  // namespace spume
