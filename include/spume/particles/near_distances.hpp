// SPDX-License-Identifier: MIT
// Bounds of distances from a surface around it, of which most questions what lies between two places need no more: by
// the distances of the middles of cells of a quarter of a spacing, and the way from there. A question costs 10 ns where
// that of a mesh costs 3 us.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "spume/geometry/shapes.hpp"

namespace spume {

class NearDistances {
 public:
  // For places in a box from `lower` to `upper`. is_far(place): no place within a spacing and a half of that one is
  // nearer to the surface than half a spacing.
  NearDistances(const Combination& walls, int dimensions, const Vec3& lower, const Vec3& upper, double spacing,
                const std::function<bool(const Vec3&)>& is_far);

  struct Range {
    double least = -infinite, most = infinite;
  };
  // Without bounds where the surface is far.
  Range at(const Vec3& place) const;
  double bytes() const { return static_cast<double>(4 * (block_.capacity() + distance_.capacity())); }

 private:
  static constexpr std::size_t finer = 4;  // cells along the side of a block, a spacing
  int dimensions_;
  Vec3 lower_{};
  double spacing_;
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::size_t cells_ = 1;  // of a block
  double off_ = 0;         // the farthest place of a cell from its middle
  std::vector<std::int32_t> block_;
  std::vector<float> distance_;
};

}  // namespace spume
