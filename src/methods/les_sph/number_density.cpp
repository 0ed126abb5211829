// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/number_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume::les_sph {
namespace {

constexpr double largest_excess = 0.1;

bool near_box(const Liquid& liquid, std::size_t i) {
  for (const SolidBox& box : liquid.scene.domain.boxes) {
    double distance2 = 0;
    for (int axis = 0; axis < liquid.dimensions; ++axis) {
      const double x = (*liquid.intermediate[axis])[i];
      const double outside = std::max({box.lower[axis] - x, x - box.upper[axis], 0.0});
      distance2 += outside * outside;
    }
    if (distance2 < liquid.grid.reach() * liquid.grid.reach()) return true;
  }
  return false;
}

bool has_full_support(const Liquid& liquid, std::size_t i) {
  return (!liquid.plan.free_surface || liquid.interior_weight[i] == 1) && !near_box(liquid, i);
}

double excess(const Liquid& liquid, std::size_t i) {
  const double ratio = (*liquid.divergence_of_position)[i] / liquid.lattice.divergence_of_position;
  return std::clamp(ratio - 1, -largest_excess, largest_excess);
}

}  // namespace

double displacement_fraction(const Liquid& liquid, double dt) {
  const int d = liquid.dimensions;
  const std::size_t n = liquid.size();
  Vec3 mean{};
  for (int axis = 0; axis < d; ++axis)
    mean[axis] = parallel_sum(n, [&](std::size_t i) { return (*liquid.velocity[axis])[i]; }) /
                 static_cast<double>(std::max<std::size_t>(n, 1));
  const double fastest2 = parallel_max(n, 0.0, [&](std::size_t i) {
    if (liquid.list.count(i) < spray_neighbours(d)) return 0.0;
    double speed2 = 0;
    for (int axis = 0; axis < d; ++axis) {
      const double relative = (*liquid.velocity[axis])[i] - mean[axis];
      speed2 += relative * relative;
    }
    return speed2;
  });
  const double fraction = std::sqrt(fastest2) * dt / (liquid.options.time.courant * liquid.smoothing_length);
  return fraction < 1e-12 ? 0.0 : std::min(1.0, fraction);  // less than positions can tell
}

void even_out_density(const Liquid& liquid, double dt, std::span<double> divergence) {
  struct Sum {
    double excess = 0, particles = 0;
  };
  const Sum total = parallel_reduce(
      liquid.size(), Sum{},
      [&](std::size_t first, std::size_t last) {
        Sum sum;
        for (std::size_t i = first; i < last; ++i)
          if (has_full_support(liquid, i)) {
            sum.excess += excess(liquid, i);
            sum.particles += 1;
          }
        return sum;
      },
      [](const Sum& a, const Sum& b) {
        return Sum{a.excess + b.excess, a.particles + b.particles};
      });
  const double mean = total.excess / std::max(total.particles, 1.0);
  const double rate = liquid.displacement / (liquid.options.pressure.density_relaxation * dt);
  parallel_for(liquid.size(), [&](std::size_t i) {
    if (has_full_support(liquid, i)) divergence[i] -= rate * (excess(liquid, i) - mean);
  });
}

}  // namespace spume::les_sph
