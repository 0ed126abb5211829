// SPDX-License-Identifier: MIT
// What is told of a population: counts about the Hinze radius, its size distribution, and what has happened so far.
#pragma once

#include <array>
#include <cstdint>

#include "spume/physics/bubbles/population.hpp"

namespace spume::bubbles {

// Since the start of the run; part of the state. Volumes: injected + entrained = alive + burst, to rounding.
struct History {
  std::int64_t injected = 0, entrained = 0, breakups = 0, bursts = 0;
  double injected_volume = 0, entrained_volume = 0, burst_volume = 0;
  std::int64_t inner_bursts = 0;  // of the bursts those that happened before 6.5 spacings of liquid
};

struct SizeCounts {
  std::size_t above = 0, below = 0;  // of the Hinze radius
};
SizeCounts count_about(const Population& population, double hinze_radius);

// Ten bins per decade of radius / Hinze radius from 10^-3 to 10^2; what lies beyond is in the end bins.
struct SizeDistribution {
  static constexpr int per_decade = 10, first_decade = -3, last_decade = 2;
  static constexpr int bins = per_decade * (last_decade - first_decade);
  std::array<std::int64_t, bins> count{};

  static double edge(int k);    // lower edge of bin k
  static double centre(int k);  // geometric
  std::int64_t total() const;
  double density(int k) const;  // count / (total width of the bin): integrates to one
};
SizeDistribution size_distribution(const Population& population, double hinze_radius);

}  // namespace spume::bubbles
