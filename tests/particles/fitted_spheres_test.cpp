// SPDX-License-Identifier: MIT
#include "spume/particles/fitted_spheres.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "spume/core/vectors.hpp"

namespace spume {
namespace {

// Of points that all lie on it, to rounding: the equations square the ratio of what they are off the plane to how far
// they are away, 0.01.
TEST(FittedSpheres, FindTheSphereThatAllPointsLieOn) {
  const Vec3 centre{0.3, -0.2, 0.1};
  for (const int dimensions : {2, 3}) {
    const auto on_it = [&](double u, double v) {
      const Vec3 way = unit({u, v * (dimensions - 2), -1});
      return add(dimensions == 2 ? Vec3{0.3, -0.2, 0} : centre,
                 multiply(0.7, dimensions == 2 ? Vec3{way[0], way[2], 0} : way));
    };
    std::vector<Vec3> around;
    for (const double u : {-0.2, -0.07, 0.1, 0.18})
      for (const double v : {-0.17, 0.05, 0.2}) around.push_back(on_it(u, v));
    const Vec3 down = dimensions == 2 ? Vec3{0, -1, 0} : Vec3{0, 0, -1};
    const auto found = fitted_sphere(on_it(0, 0), down, around, dimensions);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->radius, 0.7, 1e-12);
    EXPECT_LT(length(subtract(add(found->centre, multiply(0.7, down)), on_it(0, 0))), 1e-12);
    // From within it is hollow.
    EXPECT_FALSE(fitted_sphere(on_it(0, 0), multiply(-1, down), around, dimensions));
  }
}

// A patch of a cylinder on a slanted axis. A ball has no axis, and the edge between two faces no radius.
TEST(FittedSpheres, FindTheCylinderThatAllPointsLieOn) {
  const Vec3 axis = unit({1, 2, -0.5}), u = unit(cross(axis, {0, 0, 1})), v = cross(axis, u);
  const auto on_it = [&](double angle, double z) {
    return add(add({0.3, -0.2, 0.1}, multiply(z, axis)),
               multiply(0.7, add(multiply(std::cos(angle), u), multiply(std::sin(angle), v))));
  };
  const double angle = 0.4;
  const Vec3 outwards = add(multiply(std::cos(angle), u), multiply(std::sin(angle), v));
  std::vector<Vec3> around, of_edge;
  for (const double turn : {-0.5, -0.2, 0.25, 0.45})
    for (const double z : {-0.3, -0.1, 0.05, 0.4}) {
      around.push_back(on_it(angle + turn, z + 0.1 * turn));
      const double way = 0.7 * turn;
      of_edge.push_back(add(add(on_it(angle, 0), multiply(z, axis)),
                            add(multiply(way, cross(axis, outwards)), multiply(-std::abs(way), outwards))));
    }
  const auto found = fitted_cylinder(on_it(angle, 0), outwards, around);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->radius, 0.7, 1e-10);
  EXPECT_NEAR(std::abs(dot(found->along, axis)), 1, 1e-12);
  const Vec3 foremost = add(found->centre, multiply(0.7, outwards));
  EXPECT_LT(length(subtract(foremost, on_it(angle, 0))), 1e-10);
  EXPECT_FALSE(fitted_cylinder(on_it(angle, 0), multiply(-1, outwards), around));
  EXPECT_FALSE(fitted_cylinder(on_it(angle, 0), outwards, of_edge));
}

TEST(FittedSpheres, AreNoneOfEdgesAndOfFlatFaces) {
  const auto bent = [](double turn) {
    std::vector<Vec3> around;
    for (const double s : {-1.0, -0.5, 0.4, 1.0})
      around.push_back({s * std::cos(turn), -std::abs(s) * std::sin(turn), 0});
    return fitted_sphere({0, 0, 0}, {0, 1, 0}, around, 2);
  };
  for (const double turn : {0.0, 0.01, 0.1, 0.4, 0.8, 1.2}) EXPECT_FALSE(bent(turn)) << turn;
  // Where a flat face becomes round.
  const std::vector<Vec3> joined{
      {-1, 0, 0}, {-0.5, 0, 0}, {std::sin(0.5), std::cos(0.5) - 1, 0}, {std::sin(1.0), std::cos(1.0) - 1, 0}};
  EXPECT_FALSE(fitted_sphere({0, 0, 0}, {0, 1, 0}, joined, 2));
}

}  // namespace
}  // namespace spume
