// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/overlap.hpp"

#include <algorithm>
#include <cmath>

#include "exclusion_search.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/core/random.hpp"

namespace spume {

SampledValue overlap_ratio(Exclusion& exclusion, const Spheres& spheres, std::size_t samples, std::uint64_t seed,
                           std::uint32_t step) {
  if (spheres.size == 0 || samples == 0) return {};
  exclusion.prepare(spheres);
  const PeriodicCells& box = exclusion.cells();

  // Spheres are drawn uniformly and weighted by their volume: a ratio of two means.
  struct Sums {
    double weight = 0, share = 0, weight_2 = 0, share_2 = 0, product = 0;
  };
  const auto sample = [&](std::size_t s) {
    const auto r = random_uniform(seed, RandomPurpose::overlap, s, step, 0);
    const auto q = random_uniform(seed, RandomPurpose::overlap, s, step, 1);
    // 2^-32 is too coarse to reach every one of many spheres evenly; a second number refines it.
    const double place = (r[0] + q[0] * 0x1p-32) * static_cast<double>(spheres.size);
    const std::size_t rank = std::min(static_cast<std::size_t>(place), spheres.size - 1);
    const std::size_t i = exclusion.index_of(rank);
    const double radius = 0.5 * exclusion.diameter_of(rank) * std::cbrt(r[1]);
    const double cosine = 2 * r[2] - 1, angle = 2 * M_PI * r[3];
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const std::array<double, 3> point{
        wrap_periodic(spheres.position[0][i] + radius * sine * std::cos(angle), box.lower[0], box.length[0]),
        wrap_periodic(spheres.position[1][i] + radius * sine * std::sin(angle), box.lower[1], box.length[1]),
        wrap_periodic(spheres.position[2][i] + radius * cosine, box.lower[2], box.length[2])};
    int covering = 0;
    exclusion.for_each_covering(point, [&](std::int32_t, double) { ++covering; });
    const double weight = std::pow(exclusion.diameter_of(rank), 3);
    // Rounding may put a point of the surface outside even its own sphere.
    return std::pair{weight, weight / std::max(covering, 1)};
  };
  const Sums sums = parallel_reduce(
      samples, Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums part;
        for (std::size_t s = first; s < last; ++s) {
          const auto [weight, share] = sample(s);
          part.weight += weight;
          part.share += share;
          part.weight_2 += weight * weight;
          part.share_2 += share * share;
          part.product += weight * share;
        }
        return part;
      },
      [](Sums a, const Sums& b) {
        a.weight += b.weight;
        a.share += b.share;
        a.weight_2 += b.weight_2;
        a.share_2 += b.share_2;
        a.product += b.product;
        return a;
      });
  const double ratio = sums.share / sums.weight;
  const double scatter = sums.share_2 - 2 * ratio * sums.product + ratio * ratio * sums.weight_2;
  return {1 - ratio, std::sqrt(std::max(0.0, scatter)) / sums.weight};
}

std::vector<double> overlap_histogram(Exclusion& exclusion, const Spheres& spheres, int bins) {
  exclusion.prepare(spheres);
  const auto width = static_cast<std::size_t>(bins);
  const std::size_t block = std::max(default_block, block_count(spheres.size, 64));
  std::vector<std::vector<double>> counts(block_count(spheres.size, block), std::vector<double>(width, 0.0));
  parallel_blocks(spheres.size, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k)
      exclusion.for_each_overlap(k, [&](std::int32_t m, double overlap) {
        const double touching = 0.5 * (exclusion.diameter_of(k) + exclusion.diameter_of(static_cast<std::size_t>(m)));
        counts[b][std::min(width - 1, static_cast<std::size_t>(overlap / touching * bins))] += 1;
      });
  });
  std::vector<double> density(width, 0.0);
  double total = 0;
  for (const auto& part : counts)
    for (std::size_t i = 0; i < width; ++i) {
      density[i] += part[i];
      total += part[i];
    }
  if (total > 0)
    for (double& d : density) d *= bins / total;
  return density;
}

}  // namespace spume
