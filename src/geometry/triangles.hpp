// SPDX-License-Identifier: MIT
#pragma once

#include "spume/core/vec3.hpp"

namespace spume {

// The place of a triangle nearest to a point, and which of its features holds it: 0 the face; 1, 2, 3 the edges from
// corner 0, 1, 2 to the next; 4, 5, 6 the corners.
struct TrianglePoint {
  Vec3 point{};
  int feature = 0;
};
TrianglePoint nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

}  // namespace spume
