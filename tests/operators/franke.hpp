// SPDX-License-Identifier: MIT
// Franke's first test function (1979) with the linear term in its second exponential, Joubert et al., equation (26).
#pragma once

#include <array>
#include <cmath>

namespace spume::test {

struct Franke {
  double value = 0, laplacian = 0;
  std::array<double, 2> gradient{};

  Franke(double x, double y) {
    // exp(-a (9x - p)^2 - b (9y - q)^2) times c.
    const auto bump = [&](double c, double a, double p, double b, double q) {
      const double s = 9 * x - p, t = 9 * y - q, e = c * std::exp(-a * s * s - b * t * t);
      value += e;
      gradient[0] -= 18 * a * s * e;
      gradient[1] -= 18 * b * t * e;
      laplacian += e * (std::pow(18 * a * s, 2) - 162 * a + std::pow(18 * b * t, 2) - 162 * b);
    };
    bump(0.75, 0.25, 2, 0.25, 2);
    bump(0.5, 0.25, 7, 0.25, 3);
    bump(-0.2, 1, 4, 1, 7);
    const double s = 9 * x + 1, e = 0.75 * std::exp(-s * s / 49 - (9 * y + 1) / 10);
    value += e;
    gradient[0] -= 18.0 / 49 * s * e;
    gradient[1] -= 0.9 * e;
    laplacian += e * (std::pow(18.0 / 49 * s, 2) - 162.0 / 49 + 0.81);
  }
};

}  // namespace spume::test
