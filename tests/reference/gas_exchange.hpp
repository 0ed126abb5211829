// SPDX-License-Identifier: MIT
// Transfer between bubbles and a periodic liquid, bubble by bubble and particle by particle: slow twin of what rides on
// the exchange of momentum.
#pragma once

#include <cmath>
#include <vector>

#include "spume/core/kernel.hpp"
#include "spume/methods/les_sph/flow.hpp"

namespace spume::reference {

struct GasExchange {
  std::vector<double> change;  // of the concentration of every particle
  double given = 0;
};

// After the bubble forces of a step dt of a cube of side `length`, for a coefficient that does not depend on the slip.
inline GasExchange gas_exchange(const les_sph::Flow& flow, double length, double dt) {
  const bubbles::Population& bubbles = flow.bubbles->population();
  const oxygen::Gas& gas = flow.solutes.oxygen->gas();
  GasExchange result{.change = std::vector<double>(flow.size(), 0.0)};
  for (std::size_t b = 0; b < bubbles.size(); ++b) {
    std::vector<double> weight(flow.size());
    double sum = 0, concentration = 0;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      double r2 = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        double d = (*flow.intermediate_position[a])[i] - (*bubbles.next_position[a])[b];
        d -= length * std::round(d / length);
        r2 += d * d;
      }
      const double h = flow.resolution.smoothing_length * flow.sizes.length_ratio[i];
      const double volume = flow.particles.volume * flow.sizes.volume_ratio[i];
      const double q = std::sqrt(r2) / h;
      weight[i] = q < WendlandC2::support ? volume * WendlandC2::w(q) / (h * h * h) : 0;
      sum += weight[i];
      concentration += weight[i] * flow.solutes.oxygen->dissolved()[i];
    }
    const oxygen::Exchange exchange =
        oxygen::exchange(gas, {(*bubbles.oxygen)[b], (*bubbles.inert)[b]}, oxygen::sphere(bubbles.radius(b)),
                         (*bubbles.next_position[2])[b], 0, concentration / sum, dt);
    result.given += exchange.given;
    for (std::size_t i = 0; i < flow.size(); ++i)
      result.change[i] += exchange.given * weight[i] / sum / flow.particles.volume;
  }
  return result;
}

}  // namespace spume::reference
