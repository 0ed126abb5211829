// SPDX-License-Identifier: MIT
// Where facets stand for a round surface, the sphere that it is near a corner of them.
#pragma once

#include <optional>
#include <span>

#include "spume/core/vec3.hpp"

namespace spume {

struct FittedSphere {
  Vec3 centre{};
  double radius = 0;
};

// Through a point, in two dimensions a circle, with the least squares of |x - point|^2 - 2 (centre - point) . x of the
// points around it. None where the surface is hollow, `outwards` being about its normal, and where one of them is off
// the sphere by more than a twentieth of what it is off the plane: of an edge between flat faces a fifth.
std::optional<FittedSphere> fitted_sphere(const Vec3& point, const Vec3& outwards, std::span<const Vec3> around,
                                          int dimensions);

}  // namespace spume
