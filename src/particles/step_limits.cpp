// SPDX-License-Identifier: MIT
#include "spume/particles/step_limits.hpp"

#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/size_bits.hpp"

namespace spume {

Speeds find_speeds(const Arrangement& arrangement, const ParticleStore& particles) {
  const int d = particles.dimensions;
  const auto speed2_at = [&](std::size_t i) { return squared_norm(particles.velocity, d, i); };
  Speeds speeds;
  speeds.largest = std::sqrt(parallel_max(particles.size(), 0.0, speed2_at));
  const int spray = spray_neighbours(d);
  const bool listed = arrangement.list.particles() == particles.size();
  speeds.limiting = listed ? std::sqrt(parallel_max(
                                 particles.size(), 0.0,
                                 [&](std::size_t i) { return arrangement.list.count(i) < spray ? 0.0 : speed2_at(i); }))
                           : speeds.largest;
  return speeds;
}

void refuse_long_strides(const ParticleStore& particles, const VectorField& at, const VectorScratch& velocity,
                         double support_radius, double dt) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  const auto speed2_at = [&](std::size_t i) { return squared_norm(velocity, d, i); };
  const double fastest = std::sqrt(parallel_max(n, 0.0, speed2_at));
  const double limit = 0.5 * support_radius / dt;
  if (fastest <= limit) return;
  StepFailure::Details details;
  blame_first(details, particles, at, [&](std::size_t i) {
    details.value = std::sqrt(speed2_at(i));
    return !(details.value <= limit);
  });
  details.cause = std::isfinite(fastest) ? "a particle would cross half its support in one step"
                                         : "a velocity is not a finite number";
  details.option = "time.courant";
  throw StepFailure(details);
}

void refuse_burst(const ParticleStore& particles, const CompressedState& state, const char* option) {
  constexpr double largest_excess_of_a_flow = 0.5;
  const double largest = parallel_reduce(
      particles.size(), 0.0,
      [&](std::size_t first, std::size_t last) {
        double strongest = 0;
        for (int axis = 0; axis < particles.dimensions; ++axis)
          strongest = larger_or_nan(strongest, double{largest_size(state.force[axis].data(), first, last)});
        return std::isfinite(strongest) ? double{largest_size(state.excess, first, last)} : NAN;
      },
      larger_or_nan);
  if (largest <= largest_excess_of_a_flow) return;
  StepFailure::Details details;
  details.cause =
      std::isfinite(largest) ? "the density has changed by more than half" : "a force is not a finite number";
  details.option = option;
  details.value = largest;
  blame_first(details, particles, state.at, [&](std::size_t i) {
    return !(std::abs(state.excess[i]) <= largest_excess_of_a_flow && std::isfinite(state.force[0][i]));
  });
  throw StepFailure(details);
}

}  // namespace spume
