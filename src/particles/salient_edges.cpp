// SPDX-License-Identifier: MIT
#include "salient_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr double least_fall = 0.2;  // of the reach: see the header

// Directions across a normal, one of each pair of opposite ones.
std::array<Vec3, 4> tangents(const Vec3& normal, int dimensions) {
  if (dimensions == 2) return {Vec3{-normal[1], normal[0], 0}, Vec3{}, Vec3{}, Vec3{}};
  std::size_t least = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) < std::abs(normal[least])) least = axis;
  Vec3 across{};
  across[least] = 1;
  across = subtract(across, multiply(dot(across, normal), normal));
  across = multiply(1 / length(across), across);
  const Vec3 other = cross(normal, across);
  const double half = std::sqrt(0.5);
  return {across, other, multiply(half, add(across, other)), multiply(half, subtract(across, other))};
}

bool in_domain(const Domain& domain, const Vec3& point, int dimensions) {
  for (int axis = 0; axis < dimensions; ++axis)
    if (!domain.periodic(axis) && (point[axis] < domain.lower[axis] || point[axis] > domain.upper[axis])) return false;
  return true;
}

bool bends_away(const BodyWalls& bodies, const Domain& domain, const Vec3& point, double reach, int dimensions) {
  const NearestPoint wall = bodies.nearest_wall(point);
  const std::array<Vec3, 4> along = tangents(wall.normal, dimensions);
  for (int k = 0; k < (dimensions == 2 ? 1 : 4); ++k)
    for (const double way : {-reach, reach}) {
      const Vec3 beside = add(wall.point, multiply(way, along[k]));
      if (in_domain(domain, beside, dimensions) && bodies.distance(beside) > least_fall * reach) return true;
    }
  return false;
}

// Faces of boxes, and of walls, that bound the free space around the point: just behind the plane of one, within its
// length there is solid.
bool ends_near(const SolidUnion& solids, const Vec3& point, double reach, int dimensions) {
  const auto [lower, upper] = solids.free_box(point, reach);
  const double behind = 1e-3 * reach, seen = (1 - least_fall) * reach;
  for (int axis = 0; axis < dimensions; ++axis)
    for (const bool above : {false, true}) {
      const double face = above ? upper[axis] : lower[axis];
      if (!(std::abs(face - point[axis]) < reach)) continue;
      for (int along = 0; along < dimensions; ++along)
        for (const double way : {-seen, seen}) {
          if (along == axis) continue;
          Vec3 before = point, beyond = point;
          before[along] += way;
          before[axis] = face + (above ? -behind : behind);
          beyond[along] += way;
          beyond[axis] = face + (above ? behind : -behind);
          if (!solids.inside(before) && !solids.inside(beyond)) return true;
        }
    }
  return false;
}

}  // namespace

bool salient_edge_near(const Boundary& boundary, const Vec3& point, double reach, int dimensions) {
  if (boundary.solids() != nullptr && ends_near(*boundary.solids(), point, reach, dimensions)) return true;
  const BodyWalls* bodies = boundary.bodies();
  return bodies != nullptr && bodies->nearer_than(point, reach) &&
         bends_away(*bodies, boundary.domain(), point, reach, dimensions);
}

}  // namespace spume
