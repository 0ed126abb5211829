// SPDX-License-Identifier: MIT
// Weakly compressible phases.
#pragma once

#include <cmath>

namespace spume {

// The exponent of liquids (Monaghan 1994).
inline constexpr double liquid_exponent = 7;

// x^7 without a logarithm: water is most of most scenes.
inline double tait_power(double x, double exponent) {
  if (exponent != liquid_exponent) return std::pow(x, exponent);
  const double x3 = x * x * x;
  return x3 * x3 * x;
}

// Tait's equation of state of a phase, p = B ((1 + s)^gamma - 1) with s = rho / rho_0 - 1 and B = rho_0 c^2 / gamma.
struct PhaseLaw {
  double density = 0, viscosity = 0, sound_speed = 0, exponent = liquid_exponent;
  double stiffness() const { return density * sound_speed * sound_speed / exponent; }
  double pressure(double excess) const { return stiffness() * (tait_power(1 + excess, exponent) - 1); }
  double excess(double pressure) const { return std::pow(1 + pressure / stiffness(), 1 / exponent) - 1; }
  // c^2 = dp / d rho = c_0^2 (1 + s)^(gamma - 1).
  double local_sound_speed(double excess) const {
    return sound_speed * std::sqrt(tait_power(1 + excess, exponent) / (1 + excess));
  }
  // Of a unit of volume at rest over B: the integral of rho_0 p / rho^2 d rho.
  double energy_over_stiffness(double excess) const {
    const double x = 1 + excess, gamma = exponent;
    const double of_state = gamma == 1 ? std::log(x) : (std::pow(x, gamma - 1) - 1) / (gamma - 1);
    return of_state + 1 / x - 1;
  }
};

}  // namespace spume
