// SPDX-License-Identifier: MIT
// The kernels as they are printed.
#pragma once

#include <cmath>
#include <numbers>

#include "spume/core/kernel_kind.hpp"

namespace spume::reference {

// w(q) and F(q) = w'(q) / q of the kernels, from their printed forms.
struct PlainKernel {
  KernelKind kind = KernelKind::wendland_c2;
  int dimensions = 3;

  double support() const { return kind == KernelKind::wendland_c2 ? 2 : 3; }
  double normalisation() const {
    const double pi = std::numbers::pi;
    if (kind == KernelKind::wendland_c2) return dimensions == 2 ? 7 / (4 * pi) : 21 / (16 * pi);
    return dimensions == 2 ? 7 / (478 * pi) : 1 / (120 * pi);
  }
  double w(double q) const {
    if (q >= support()) return 0;
    if (kind == KernelKind::wendland_c2) return std::pow(1 - q / 2, 4) * (2 * q + 1);
    double sum = std::pow(3 - q, 5);
    if (q < 2) sum -= 6 * std::pow(2 - q, 5);
    if (q < 1) sum += 15 * std::pow(1 - q, 5);
    return sum;
  }
  double f(double q) const {
    if (q >= support()) return 0;
    if (kind == KernelKind::wendland_c2) return -5 * std::pow(1 - q / 2, 3);
    if (q < 1e-3) return -120;  // the limit; the next term is 120 q^2
    double sum = std::pow(3 - q, 4);
    if (q < 2) sum -= 6 * std::pow(2 - q, 4);
    if (q < 1) sum += 15 * std::pow(1 - q, 4);
    return -5 * sum / q;
  }
};

}  // namespace spume::reference
