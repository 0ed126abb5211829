// SPDX-License-Identifier: MIT
#include "spume/particles/sponge.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {

double damp_in_sponges(const Domain& domain, const std::vector<Sponge>& sponges, const VectorField& position,
                       std::size_t particles, double dt, VectorScratch& velocity) {
  return parallel_sum(particles, [&](std::size_t i) {
    double gain = 0;
    for (const Sponge& sponge : sponges) {
      const double x = (*position[sponge.axis])[i];
      const double distance = sponge.side == 0 ? x - domain.lower[sponge.axis] : domain.upper[sponge.axis] - x;
      // A moving wall may take liquid beyond the side.
      const double share = 1 - std::max(distance, 0.0) / sponge.length;
      if (!(share > 0)) continue;
      const double left = std::exp(-sponge.strength * share * share * dt);
      for (int axis = 0; axis < domain.dimensions; ++axis) {
        double& u = velocity[axis][i];
        const double damped = sponge.velocity[axis] + left * (u - sponge.velocity[axis]);
        gain += (damped * damped - u * u) / 2;
        u = damped;
      }
    }
    return gain;
  });
}

}  // namespace spume
