// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace spume::bubbles {

SizeCounts count_about(const Population& population, double hinze_radius) {
  const double limit = volume_of(hinze_radius);
  const double above =
      parallel_sum(population.size(), [&](std::size_t b) { return (*population.volume)[b] > limit ? 1.0 : 0.0; });
  SizeCounts counts;
  counts.above = static_cast<std::size_t>(above);
  counts.below = population.size() - counts.above;
  return counts;
}

double SizeDistribution::edge(int k) {
  return std::pow(10.0, first_decade + static_cast<double>(k) / per_decade);
}

double SizeDistribution::centre(int k) {
  return std::pow(10.0, first_decade + (k + 0.5) / per_decade);
}

std::int64_t SizeDistribution::total() const {
  return std::accumulate(count.begin(), count.end(), std::int64_t{0});
}

double SizeDistribution::density(int k) const {
  const auto all = static_cast<double>(total());
  return all > 0 ? static_cast<double>(count[static_cast<std::size_t>(k)]) / (all * (edge(k + 1) - edge(k))) : 0;
}

SizeDistribution size_distribution(const Population& population, double hinze_radius) {
  SizeDistribution result;
  for (std::size_t b = 0; b < population.size(); ++b) {
    const double place = (std::log10(population.radius(b) / hinze_radius) - SizeDistribution::first_decade) *
                         SizeDistribution::per_decade;
    const double bin = std::clamp(std::floor(place), 0.0, SizeDistribution::bins - 1.0);
    ++result.count[static_cast<std::size_t>(bin)];
  }
  return result;
}

}  // namespace spume::bubbles
