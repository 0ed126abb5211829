// SPDX-License-Identifier: MIT
// Where facets stand for a round surface, the sphere or the cylinder that it is near a corner of them.
#pragma once

#include <optional>
#include <span>

#include "spume/core/vec3.hpp"

namespace spume {

struct FittedSphere {
  Vec3 centre{};
  double radius = 0;
  Vec3 along{};  // of length 1: a cylinder about this axis; zero: a sphere
};

// Through a point, in two dimensions a circle, with the least squares of |x - point|^2 - 2 (centre - point) . x of the
// points around it. None where the surface is hollow, `outwards` being about its normal, and where one of them is off
// the sphere by more than a twentieth of what it is off the plane: of an edge between flat faces a fifth.
std::optional<FittedSphere> fitted_sphere(const Vec3& point, const Vec3& outwards, std::span<const Vec3> around,
                                          int dimensions);
// The same in space of a cylinder, whose axis is found with it (Gauss and Newton): none of what is round along its axis
// too.
std::optional<FittedSphere> fitted_cylinder(const Vec3& point, const Vec3& outwards, std::span<const Vec3> around);

}  // namespace spume
