// SPDX-License-Identifier: MIT
// Cardinal B-splines of even order (order = number of points of the support: 2 linear, 4 cubic, 6 quintic).
//
// A field given at the points of a periodic grid is interpolated by sum_i c_i B(x - i), whose coefficients c solve
// sum_i c_i B(j - i) = u_j. On a periodic grid that is a division of the Fourier coefficients by the transform of
// B at the points, so that a field that is transformed anyhow is prefiltered for free (van Hinsberg et al. 2013).
#pragma once

#include <cmath>

namespace spume {

// Factor of the Fourier coefficient with wave number k (in periods per box, either sign) along one axis of n
// points: u -> c. The three axes multiply. Orders 2, 4, 6; at least 1, at most 3 (cubic) and 15/2 (quintic).
inline double b_spline_prefilter(int order, int k, int n) {
  const double angle = 2 * M_PI * k / n;
  if (order == 4) return 3 / (2 + std::cos(angle));
  if (order == 6) return 60 / (33 + 26 * std::cos(angle) + std::cos(2 * angle));
  return 1;
}

template <int order>
struct BSpline {
  static_assert(order == 2 || order == 4 || order == 6);
  static constexpr int below = order / 2 - 1;  // points of the support below the cell of the argument
  static constexpr int above = order / 2;      // and above its lower point

  // Weights of the points -below .. above of the cell that holds the argument at fraction t in [0, 1], and their
  // derivatives with respect to t.
  template <class Real>
  [[gnu::always_inline]] static void weights(Real t, Real (&w)[order], Real (&dw)[order]) {
    const Real s = 1 - t;
    if constexpr (order == 2) {
      w[0] = s;
      w[1] = t;
      dw[0] = -1;
      dw[1] = 1;
    } else if constexpr (order == 4) {
      constexpr Real sixth = Real(1) / 6, half = Real(1) / 2;
      w[0] = sixth * s * s * s;
      w[1] = sixth * (4 + t * t * (3 * t - 6));
      w[2] = sixth * (4 + s * s * (3 * s - 6));
      w[3] = sixth * t * t * t;
      dw[0] = -half * s * s;
      dw[1] = half * t * (3 * t - 4);
      dw[2] = -half * s * (3 * s - 4);
      dw[3] = half * t * t;
    } else {
      constexpr Real c = Real(1) / 120;
      const auto second = [](Real r) { return 26 + r * (-50 + r * (20 + r * (20 + r * (-20 + 5 * r)))); };
      const auto second_slope = [](Real r) { return -50 + r * (40 + r * (60 + r * (-80 + 25 * r))); };
      const auto third = [](Real r) { return 66 + r * r * (-60 + r * r * (30 - 10 * r)); };
      const auto third_slope = [](Real r) { return r * (-120 + r * r * (120 - 50 * r)); };
      const Real s2 = s * s, t2 = t * t;
      w[0] = c * s2 * s2 * s;
      w[1] = c * second(t);
      w[2] = c * third(t);
      w[3] = c * third(s);
      w[4] = c * second(s);
      w[5] = c * t2 * t2 * t;
      dw[0] = -5 * c * s2 * s2;
      dw[1] = c * second_slope(t);
      dw[2] = c * third_slope(t);
      dw[3] = -c * third_slope(s);
      dw[4] = -c * second_slope(s);
      dw[5] = 5 * c * t2 * t2;
    }
  }
};

}  // namespace spume
