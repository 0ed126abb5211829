// SPDX-License-Identifier: MIT
#include "spume/scene/wave_modes.hpp"

#include <cmath>
#include <numbers>

#include "spume/scene/wave_theory.hpp"

namespace spume {
namespace {

// sinh(kappa h) times the projection of the motion on the mode over that of the mode on itself, both sides divided by
// cosh^2(kappa h): no overflow for short waves.
std::complex<double> transfer_of(WavemakerKind kind, const WaveMode& mode, double depth) {
  const std::complex<double> q = mode.wavenumber * depth, t = mode.tanh;
  const std::complex<double> moved = kind == WavemakerKind::piston ? t : t - (1.0 - mode.sech) / q;
  return 2.0 * t * moved / (q * mode.sech * mode.sech + t);
}

}  // namespace

double decaying_wavenumber(double angular_frequency, double depth, double gravity, std::size_t j) {
  // q = j pi - atan(y / q), whose slope beside that of q is below 1 / pi.
  const double y = angular_frequency * angular_frequency * depth / gravity;
  const double whole = static_cast<double>(j) * std::numbers::pi;
  double q = whole - std::atan(y / whole);
  for (int step = 0; step < 30; ++step) {
    const double next = q - (q - whole + std::atan(y / q)) / (1 - y / (q * q + y * y));
    if (std::abs(next - q) < 1e-15 * q) break;
    q = next;
  }
  return q / depth;
}

std::vector<WaveMode> wave_modes(WavemakerKind kind, double angular_frequency, double depth, double gravity,
                                 std::size_t decaying) {
  std::vector<WaveMode> modes(1 + decaying);
  const double over_gravity = angular_frequency * angular_frequency / gravity;
  for (std::size_t j = 0; j <= decaying; ++j) {
    WaveMode& mode = modes[j];
    if (j == 0) {
      const double k = wavenumber(angular_frequency, depth, gravity);
      mode.wavenumber = k;
      mode.sech = 1 / std::cosh(k * depth);
    } else {
      const double k = decaying_wavenumber(angular_frequency, depth, gravity, j);
      mode.wavenumber = {0, -k};
      mode.sech = 1 / std::cos(k * depth);
    }
    mode.tanh = over_gravity / mode.wavenumber;
    mode.transfer = transfer_of(kind, mode, depth);
  }
  return modes;
}

}  // namespace spume
