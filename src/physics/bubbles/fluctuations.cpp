// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/fluctuations.hpp"

#include <cmath>

namespace spume::bubbles {
namespace {
// Squared slip over variance below which the direction of the slip is rounding; decay and noise along and across it
// then agree to rounding.
constexpr double directionless = 1e-20;
}  // namespace

Vec3 advance_fluctuation(const Vec3& fluctuation, const Vec3& relative_velocity, double energy, double width,
                         double constant, double dt, const Vec3& noise) {
  const double variance = 2.0 / 3 * energy;
  if (!(variance > 0)) return {};
  const double sigma = std::sqrt(variance), tau = constant * width / sigma;
  const Vec3& w = relative_velocity;
  const double slip2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
  const double along_decay = std::exp(-dt / tau * std::sqrt(1 + slip2 / variance));
  const double across_decay = std::exp(-dt / tau * std::sqrt(1 + 4 * slip2 / variance));
  const double along_noise = sigma * std::sqrt(1 - along_decay * along_decay);
  const double across_noise = sigma * std::sqrt(1 - across_decay * across_decay);
  const bool directed = slip2 > directionless * variance;
  double part = 0, noise_part = 0;
  if (directed) {
    part = (fluctuation[0] * w[0] + fluctuation[1] * w[1] + fluctuation[2] * w[2]) / slip2;
    noise_part = (noise[0] * w[0] + noise[1] * w[1] + noise[2] * w[2]) / slip2;
  }
  Vec3 result;
  for (std::size_t a = 0; a < 3; ++a) {
    const double along = (along_decay - across_decay) * part + (along_noise - across_noise) * noise_part;
    result[a] = across_decay * fluctuation[a] + across_noise * noise[a] + along * w[a];
  }
  return result;
}

}  // namespace spume::bubbles
