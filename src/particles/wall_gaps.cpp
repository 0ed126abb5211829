// SPDX-License-Identifier: MIT
// Walls of bodies seen from a place on one of them: where it is whole, and how far away the next wall is.
#include <algorithm>
#include <cmath>

#include "spume/core/vectors.hpp"
#include "spume/geometry/way_to_wall.hpp"
#include "spume/particles/body_walls.hpp"

namespace spume {
namespace {

constexpr double thinnest = 0.05;  // spacings, of a plate across a gap
// Spacings before a surface: another wall that is there touches it.
constexpr double touches_within = 0.005;
constexpr double of_rounding = 1e-9;  // of the widest gap: what is inside another wall touches it

}  // namespace

Vec3 BodyWalls::whole_place(std::size_t body, const Vec3& point) const {
  const Body& own = scene_.bodies[body];
  if (own.motion) return part_of(body).beside_pivot(point);
  const Bounds bounds = own.shape->bounds();
  Vec3 whole = point;
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
    const double middle = 0.5 * (bounds.lower[axis] + bounds.upper[axis]);
    if (!scene_.domain.periodic(axis) || !std::isfinite(middle)) continue;
    const double period = scene_.domain.upper[axis] - scene_.domain.lower[axis];
    whole[axis] -= period * std::round((point[axis] - middle) / period);
  }
  return whole;
}

std::optional<double> BodyWalls::gap_before(const Vec3& foot, const Vec3& normal, const WallPositions& sides) const {
  const Domain& domain = scene_.domain;
  const double width = widest_gap * scene_.spacing;
  std::optional<double> gap;
  const auto limit = [&](double found) { gap = std::min(found, gap.value_or(width)); };
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    const std::size_t end = normal[axis] < 0 ? 0 : 1;
    const double room = end == 0 ? foot[axis] - sides[static_cast<std::size_t>(axis)][0]
                                 : sides[static_cast<std::size_t>(axis)][1] - foot[axis];
    if (is_wall(domain.sides[axis][end].kind) && width * std::abs(normal[axis]) > room)
      limit(room > touches_within * scene_.spacing ? room / std::abs(normal[axis]) : 0);
  }
  // What is farther from a wall than it is from the ends has none before it.
  const auto at = [&](const Vec3& place) { return distance(place); };
  if (at(add(foot, multiply(0.5 * width, normal))) > 0.49 * width) return gap;
  const double first = touches_within * scene_.spacing;
  const std::optional<Vec3> wall =
      way_to_wall(add(foot, multiply(first, normal)), multiply(width - first, normal), thinnest * scene_.spacing, at,
                  [&](const Vec3& place) { return at(place) < 0; });
  if (wall) {
    const double way = dot(subtract(*wall, foot), normal) - first;
    limit(way > of_rounding * width ? way : 0);
  }
  return gap;
}

}  // namespace spume
