// SPDX-License-Identifier: MIT
// Points of the boundary of a solid, of which only a test of membership is known.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "spume/core/vec3.hpp"

namespace spume::test {

using Membership = std::function<bool(const Vec3&)>;

struct BoundaryPoints {
  std::vector<Vec3> points;
  // Of a boundary point from the next one of `points`, where the solid and its surroundings are thicker than a cell:
  // the diagonal of a cell.
  double reach = 0;
  double distance(const Vec3& p) const {
    double best = std::numeric_limits<double>::infinity();
    for (const Vec3& q : points) best = std::min(best, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    return best;
  }
};

// Bisects every edge of a grid of cubes, `cells` to a side of the cube [-half, half], between a member and none.
inline BoundaryPoints find_boundary(const Membership& inside, double half, int cells, int dimensions) {
  BoundaryPoints found;
  const double side = 2 * half / cells;
  found.reach = side * std::sqrt(static_cast<double>(dimensions));
  const auto node = [&](int i, int j, int k) {
    return Vec3{-half + side * i, -half + side * j, dimensions == 3 ? -half + side * k : 0};
  };
  const int layers = dimensions == 3 ? cells : 0;
  for (int k = 0; k <= layers; ++k)
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i)
        for (int a = 0; a < dimensions; ++a) {
          Vec3 p = node(i, j, k), q = node(i + (a == 0), j + (a == 1), k + (a == 2));
          const bool in = inside(p);
          if (in == inside(q)) continue;
          for (int n = 0; n < 50; ++n) {
            const Vec3 middle{0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]), 0.5 * (p[2] + q[2])};
            (inside(middle) == in ? p : q) = middle;
          }
          found.points.push_back(p);
        }
  return found;
}

}  // namespace spume::test
