// SPDX-License-Identifier: MIT
// Cells that moving bodies may reach into, against the distances of the boxes that were marked.
#include "spume/particles/moving_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

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

// Names each body within the margin, once and the last marked first; beyond the margin and two cells along each axis
// none.
TEST(MovingBounds, NameTheBodiesThatMayBeNear) {
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
      bounds.mark(box, static_cast<std::size_t>(&box - boxes.data()));
    }
    int far = 0;
    for (int n = 0; n < 500; ++n) {
      Vec3 point{};
      for (int axis = 0; axis < domain.dimensions; ++axis)
        point[axis] = domain.lower[axis] + uniform(random) * (domain.upper[axis] - domain.lower[axis]);
      std::vector<std::size_t> named;
      ASSERT_TRUE(bounds.visit(point, [&](std::size_t body) { named.push_back(body); }));
      EXPECT_TRUE(std::is_sorted(named.rbegin(), named.rend()));
      EXPECT_EQ(std::adjacent_find(named.begin(), named.end()), named.end());
      double least = INFINITY;
      for (std::size_t body = 0; body < boxes.size(); ++body) {
        const double distance = distance_from(boxes[body], point, domain);
        const bool is_named = std::find(named.begin(), named.end(), body) != named.end();
        if (distance <= margin) {
          EXPECT_TRUE(is_named);
        }
        if (distance > std::sqrt(3.0) * (margin + 2 * 4 * spacing)) {
          EXPECT_FALSE(is_named);
        }
        least = std::min(least, distance);
      }
      if (least > std::sqrt(3.0) * (margin + 2 * 4 * spacing)) ++far;
    }
    if (trial % 17 != 0 && domain.dimensions == 2) {
      EXPECT_GT(far, 0);
    }
    bounds.clear();
    int named = 0;
    const auto count = [&](std::size_t) { ++named; };
    EXPECT_TRUE(bounds.visit({0, 0.7, 1.3}, count));
    EXPECT_FALSE(bounds.visit({5, 0.7, 1.3}, count)) << "outside the domain nothing is known";
    EXPECT_EQ(named, 0);
  }
}

}  // namespace
}  // namespace spume
