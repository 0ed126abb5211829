// SPDX-License-Identifier: MIT
#include "salient_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr double least_fall = 0.2;  // of the reach: see the header

// Two directions across a normal; in two dimensions the first lies in the plane.
std::array<Vec3, 2> tangents(const Vec3& normal, int dimensions) {
  if (dimensions == 2) return {Vec3{-normal[1], normal[0], 0}, Vec3{}};
  std::size_t least = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) < std::abs(normal[least])) least = axis;
  Vec3 across{};
  across[least] = 1;
  across = subtract(across, multiply(dot(across, normal), normal));
  across = multiply(1 / length(across), across);
  return {across, cross(normal, across)};
}

bool in_domain(const Domain& domain, const Vec3& point, int dimensions) {
  for (int axis = 0; axis < dimensions; ++axis)
    if (!domain.periodic(axis) && (point[axis] < domain.lower[axis] || point[axis] > domain.upper[axis])) return false;
  return true;
}

bool bends_away(const BodyWalls& bodies, const Domain& domain, const Vec3& point, double reach, int dimensions) {
  const NearestPoint wall = bodies.nearest_wall(point);
  const std::array<Vec3, 2> along = tangents(wall.normal, dimensions);
  for (int axis = 0; axis + 1 < dimensions; ++axis)
    for (const double way : {-reach, reach}) {
      const Vec3 beside = add(wall.point, multiply(way, along[axis]));
      if (in_domain(domain, beside, dimensions) && bodies.distance(beside) > least_fall * reach) return true;
    }
  return false;
}

}  // namespace

bool salient_edge_near(const Boundary& boundary, const Vec3& point, double reach, int dimensions) {
  if (boundary.solids() != nullptr && !boundary.solids()->open_around(point, reach)) return true;
  const BodyWalls* bodies = boundary.bodies();
  return bodies != nullptr && bodies->nearer_than(point, reach) &&
         bends_away(*bodies, boundary.domain(), point, reach, dimensions);
}

}  // namespace spume
