// SPDX-License-Identifier: MIT
#include "spume/particles/convex_corners.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "spume/core/vectors.hpp"
#include "spume/particles/rigid_walls.hpp"

namespace spume {
namespace {

constexpr double least_turn = 0.1;  // to either side: see the header
// Spacings: how near the faces beside a point are asked for their normals, and how far away it is looked at from.
constexpr double beside = 1e-3, away = 0.1;

// Of length 1, across `direction` as `way` is; of no length if it is not.
Vec3 across(const Vec3& direction, const Vec3& way) {
  const Vec3 part = subtract(way, multiply(dot(way, direction), direction));
  const double size = length(part);
  return size > 1e-9 ? multiply(1 / size, part) : Vec3{};
}

std::vector<Vec3> ways_across(const Vec3& normal, int dimensions) {
  if (dimensions == 2) return {{-normal[1], normal[0], 0}, {normal[1], -normal[0], 0}};
  std::size_t least = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) < std::abs(normal[least])) least = axis;
  Vec3 axis{};
  axis[least] = 1;
  const Vec3 u = across(normal, axis), v = cross(normal, u);
  std::vector<Vec3> ways;
  for (int k = 0; k < 8; ++k) {
    const double angle = k * std::numbers::pi / 4;
    ways.push_back(add(multiply(std::cos(angle), u), multiply(std::sin(angle), v)));
  }
  return ways;
}

}  // namespace

ConvexCorner convex_corner(const RigidWalls& walls, const Vec3& point, const Vec3& outwards, double spacing,
                           int dimensions) {
  // Pieces of round walls are chords, whose normals are off by half of what they span: the faces beside the point tell
  // its own. A little above them, where a flat face has its normal whatever the rounding.
  const Vec3 up = unit(outwards, dimensions);
  std::vector<Vec3> normals;
  Vec3 sum{};
  for (const Vec3& way : ways_across(up, dimensions)) {
    const Vec3 at = add(point, multiply(beside * spacing, add(way, multiply(0.1, up))));
    normals.push_back(walls.nearest(at).normal);
    sum = add(sum, normals.back());
  }
  const Vec3 middle = unit(sum, dimensions);
  Vec3 side = middle;
  for (const Vec3& normal : normals)
    if (dot(normal, middle) < dot(side, middle)) side = normal;
  const Vec3 u = across(middle, side);
  if (length(u) == 0) return {};  // flat

  // From a corner all of these directions lead back to it; from a round wall each to a place as far off as it leans.
  const auto stays = [&](const Vec3& way) {
    for (const double lean : {-least_turn, least_turn}) {
      const Vec3 at = add(point, multiply(away * spacing, add(middle, multiply(lean, way))));
      if (length(subtract(walls.nearest(at).point, point)) > 0.1 * least_turn * away * spacing) return false;
    }
    return true;
  };
  if (!stays(u)) return {};
  if (dimensions == 2) return {ConvexCorner::Kind::corner, {}};
  const Vec3 v = cross(middle, u);
  if (stays(v)) return {ConvexCorner::Kind::corner, {}};
  return {ConvexCorner::Kind::edge, v};
}

}  // namespace spume
