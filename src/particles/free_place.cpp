// SPDX-License-Identifier: MIT
#include "free_place.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace spume {
namespace {

std::vector<Vec3> directions(int dimensions) {
  std::vector<Vec3> found;
  if (dimensions == 2) {
    constexpr int number = 16;
    for (int k = 0; k < number; ++k) {
      const double angle = 2 * std::numbers::pi * k / number;
      found.push_back({std::cos(angle), std::sin(angle), 0});
    }
    return found;
  }
  for (int k = 0; k < 27; ++k) {
    const Vec3 way{static_cast<double>(k % 3 - 1), static_cast<double>(k / 3 % 3 - 1), static_cast<double>(k / 9 - 1)};
    if (dot(way, way) > 0) found.push_back(multiply(1 / length(way), way));
  }
  return found;
}

}  // namespace

std::optional<Vec3> free_place_near(const Vec3& point, int dimensions, double step,
                                    const std::function<bool(const Vec3&)>& free) {
  constexpr int rings = 32;
  const std::vector<Vec3> ways = directions(dimensions);
  for (int ring = 1; ring <= rings; ++ring)
    for (const Vec3& way : ways) {
      const Vec3 place = add(point, multiply(step * ring, way));
      if (free(place)) return place;
    }
  return std::nullopt;
}

}  // namespace spume
