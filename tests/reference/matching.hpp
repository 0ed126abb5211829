// SPDX-License-Identifier: MIT
// The strongest overlaps by the book: all pairs, sorted, every second occurrence of a particle purged.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "spume/core/periodic_grid.hpp"
#include "spume/physics/point_particles/exclusion.hpp"

namespace spume::test {

// Whether spheres that touch at distance `touching` overlap by more than rounding.
inline bool overlapping(double distance_2, double touching) {
  return distance_2 < (1 - 1e-6) * touching * touching;
}

inline std::vector<std::int32_t> greedy_matching(const Spheres& s, const std::array<double, 3>& length) {
  struct Pair {
    double overlap;
    std::size_t i, j;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < s.size; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double d[3];
      for (int c = 0; c < 3; ++c) d[c] = nearest_image(s.position[c][i] - s.position[c][j], length[c]);
      const double distance_2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      const auto radius = [&](std::size_t p) {
        return 0.5 * (s.diameter == nullptr ? s.common_diameter : s.diameter[p]);
      };
      if (overlapping(distance_2, radius(i) + radius(j)))
        pairs.push_back({radius(i) + radius(j) - std::sqrt(distance_2), i, j});
    }
  std::sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) {
    return stronger_overlap(a.overlap, s.identifier[a.i], s.identifier[a.j], b.overlap, s.identifier[b.i],
                            s.identifier[b.j]);
  });
  std::vector<std::int32_t> partner(s.size, -1);
  for (const Pair& p : pairs)
    if (partner[p.i] < 0 && partner[p.j] < 0) {
      partner[p.i] = static_cast<std::int32_t>(p.j);
      partner[p.j] = static_cast<std::int32_t>(p.i);
    }
  return partner;
}

}  // namespace spume::test
