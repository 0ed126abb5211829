// SPDX-License-Identifier: MIT
// Cells that moving bodies may reach into, against the distances of the boxes that were marked.
#include "spume/particles/moving_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace spume {
namespace {

// Of a point from a box and its copies beyond periodic sides.
double distance_from(const Bounds& box, const Vec3& point, const Domain& domain) {
  double sum = 0;
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    const double period = domain.upper[axis] - domain.lower[axis];
    double least = INFINITY;
    for (int copy = -3; copy <= 3; ++copy) {
      if (copy != 0 && !domain.periodic(axis)) continue;
      const double x = point[axis] + copy * period;
      least = std::min(least, std::max({box.lower[axis] - x, x - box.upper[axis], 0.0}));
    }
    sum += least * least;
  }
  return std::sqrt(sum);
}

// Never wrong about a point within the margin; beyond the margin and two cells along each axis it marks none.
TEST(MovingBounds, TellWhichPointsNoBodyIsNear) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    Domain domain;
    domain.dimensions = trial % 2 == 0 ? 2 : 3;
    domain.lower = {-0.3, 0.2, 1};
    domain.upper = {0.71, 1.4, 1.63};
    for (int axis = 0; axis < domain.dimensions; ++axis)
      for (Side& side : domain.sides[axis])
        side.kind = (trial >> axis & 2) != 0 ? BoundaryKind::periodic : BoundaryKind::open;
    const double spacing = 0.013, margin = 0.04;
    MovingBounds bounds(domain, spacing, margin);
    std::vector<Bounds> boxes(1 + trial % 4);
    for (Bounds& box : boxes) {
      for (int axis = 0; axis < domain.dimensions; ++axis) {
        const double length = domain.upper[axis] - domain.lower[axis];
        box.lower[axis] = domain.lower[axis] + (1.6 * uniform(random) - 0.3) * length;
        box.upper[axis] = box.lower[axis] + (trial % 17 == 0 ? 1.2 : 0.2 * uniform(random)) * length;
      }
      bounds.mark(box);
    }
    int far = 0;
    for (int n = 0; n < 500; ++n) {
      Vec3 point{};
      for (int axis = 0; axis < domain.dimensions; ++axis)
        point[axis] = domain.lower[axis] + uniform(random) * (domain.upper[axis] - domain.lower[axis]);
      double least = INFINITY;
      for (const Bounds& box : boxes) least = std::min(least, distance_from(box, point, domain));
      if (least <= margin) {
        EXPECT_TRUE(bounds.near(point));
      }
      if (least > std::sqrt(3.0) * (margin + 2 * 4 * spacing)) {
        EXPECT_FALSE(bounds.near(point));
        ++far;
      }
    }
    if (trial % 17 != 0 && domain.dimensions == 2) {
      EXPECT_GT(far, 0);
    }
    bounds.clear();
    EXPECT_FALSE(bounds.near({0, 0.7, 1.3}));
    EXPECT_TRUE(bounds.near({5, 0.7, 1.3})) << "outside the domain nothing is known";
  }
}

}  // namespace
}  // namespace spume
