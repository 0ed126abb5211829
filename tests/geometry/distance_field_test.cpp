// SPDX-License-Identifier: MIT
#include "spume/geometry/distance_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "solids.hpp"
#include "spume/core/error.hpp"

namespace spume {
namespace {

using namespace test;
using testing::HasSubstr;

// Between the nodes of a cell of side h a function with second derivatives up to 1/r along each axis differs from the
// linear one by h^2 / (8 r) for each axis. Those of the distance from a sphere of radius r add up to 2/r at the
// surface, those of a circle to 1/r; within a cell from it r is shorter by the diagonal.
TEST(DistanceField, DiffersFromTheShapeByTheSquareOfItsSpacing) {
  for (const int dimensions : {2, 3})
    for (const double h : {0.1, 0.05}) {
      const ShapePointer exact = make_ball(0.7, dimensions);
      const ShapePointer field = make_distance_field(exact, {{-1, -1, -1}, {1, 1, 1}}, h, dimensions);
      const double nearest_radius = 0.7 - 2 * h * std::sqrt(dimensions);
      const double bound = h * h / 8 * (dimensions - 1) / nearest_radius;
      double largest = 0;
      for (std::uint64_t i = 0; i < 20000; ++i) {
        const Vec3 p = random_point(i, 0.99, dimensions);
        if (std::abs(exact->distance(p)) > h) continue;
        const NearestPoint found = field->nearest(p);
        largest = std::max(largest, std::abs(found.distance - exact->distance(p)));
        EXPECT_EQ(field->distance(p), found.distance);
        EXPECT_NEAR(length_of(found.normal), 1, 1e-12);
        // The slope of the interpolant is off by h/2 times the second derivatives along each axis.
        EXPECT_LT(length_of(between(found.normal, exact->nearest(p).normal)), h / nearest_radius);
      }
      EXPECT_LT(largest, bound);
      // What it says of itself is what it is, to the difference between the middles of cells and anywhere.
      EXPECT_GT(field->error(), 0.5 * largest);
      EXPECT_LT(field->error(), 1.01 * bound);
    }
}

TEST(DistanceField, AsksTheShapeOutsideItsBox) {
  const ShapePointer exact = make_box({1, 1, 1}, 3);
  const ShapePointer field = make_distance_field(exact, {{-1, -1, -1}, {1, 1, 1}}, 0.1, 3);
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Vec3 p = random_point(i, 3, 3);
    if (std::abs(p[0]) < 1.1 && std::abs(p[1]) < 1.1 && std::abs(p[2]) < 1.1) continue;
    EXPECT_EQ(field->distance(p), exact->distance(p));
    EXPECT_EQ(field->nearest(p).point, exact->nearest(p).point);
  }
  EXPECT_EQ(field->volume(), exact->volume());
}

// At a kink the interpolant cuts the corner: by less than the slope times half a cell along each axis.
TEST(DistanceField, IsOffByAPartOfItsSpacingAtEdges) {
  const double h = 0.05;
  const ShapePointer exact = place(make_box({1, 0.6, 0.8}, 3), {{0, 0, 0}, rotation_by({20, 30, 40})}, true, 3);
  const ShapePointer field = make_distance_field(exact, {{-1, -1, -1}, {1, 1, 1}}, h, 3);
  double largest = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Vec3 p = random_point(i, 0.99, 3);
    if (std::abs(exact->distance(p)) < h)
      largest = std::max(largest, std::abs(field->distance(p) - exact->distance(p)));
  }
  EXPECT_LT(largest, 0.5 * h);
  EXPECT_GT(field->error(), 0.5 * largest);
  EXPECT_LT(field->error(), 2 * largest);
}

// The function is no distance: its slope varies tenfold and more. Nodes lie half a spacing apart.
TEST(LevelSet, IsTheDistanceFromWhereTheFunctionIsZero) {
  for (const int dimensions : {2, 3})
    for (const double h : {0.05, 0.025}) {
      const auto value = [](const Vec3& p) {
        const double radius = std::hypot(p[0], p[1], p[2]);
        return (0.49 - radius * radius) * (1 + 5 * radius * radius * radius * radius);
      };
      const Bounds window{{-1, -1, -1}, {1, 1, 1}};
      const ShapePointer shape = make_level_set(value, window, 2 * h, dimensions), exact = make_ball(0.7, dimensions);
      // As above; and the facets, whose sides are no longer than the diagonal of a cell, cut up to h^2 dimensions / (8
      // r) off along each of their directions.
      const double bound = h * h / 8 * (dimensions - 1) / (0.7 - 2 * h * std::sqrt(dimensions)) +
                           h * h * dimensions * (dimensions - 1) / (8 * 0.7);
      double largest = 0;
      for (std::uint64_t i = 0; i < 20000; ++i) {
        const Vec3 p = random_point(i, 0.99, dimensions);
        if (std::abs(exact->distance(p)) > h) continue;
        largest = std::max(largest, std::abs(shape->distance(p) - exact->distance(p)));
        EXPECT_LT(length_of(between(shape->nearest(p).normal, exact->nearest(p).normal)), 2 * h / 0.7);
        if (std::abs(exact->distance(p)) > bound) {
          EXPECT_EQ(shape->inside(p), exact->inside(p));
        }
      }
      EXPECT_LT(largest, bound);
      EXPECT_GT(shape->error(), 0.5 * largest);
      EXPECT_LT(shape->error(), 2 * bound);
      // Facets take off their share of the volume, surface times distance.
      EXPECT_NEAR(shape->volume(), exact->volume(), exact->volume() * dimensions / 0.7 * bound);
      for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a) {
        EXPECT_NEAR(shape->bounds().lower[a], -0.7, bound + h * h);
        EXPECT_NEAR(shape->bounds().upper[a], 0.7, bound + h * h);
      }
    }
}

TEST(LevelSet, HasASurfaceOfItsOwnWhichEndsAtTheWindow) {
  const auto bed = [](const Vec3& p) { return 0.3 * std::sin(3 * p[0]) - p[1]; };
  const ShapePointer flat = make_level_set(bed, {{-1, -1, 0}, {1, 1, 0}}, 0.04, 2);
  double area = 0;
  const TriangleSurface surface = flat->surface({}, 0.1);
  for (const auto& [a, b, c] : surface.triangles) {
    const auto at = [&](std::int32_t i) { return surface.points[static_cast<std::size_t>(i)]; };
    const Vec3 u = between(at(a), at(b)), v = between(at(a), at(c));
    EXPECT_GE(u[0] * v[1] - u[1] * v[0], 0);
    area += 0.5 * (u[0] * v[1] - u[1] * v[0]);
  }
  // The integral of the sine vanishes; chords of 0.02 below arcs of curvature 2.7 take 0.02^2 / 12 * 2.7 a length.
  EXPECT_NEAR(area, 2, 2 * 1e-4);
  EXPECT_NEAR(flat->volume(), 2, 1e-3);
  // Beyond the window the distance goes on from its edge.
  EXPECT_NEAR(flat->distance({0, 3, 0}), flat->distance({0, 1, 0}) + 2, 1e-12);
  EXPECT_NEAR(flat->distance({0, -3, 0}), flat->distance({0, -1, 0}) - 2, 1e-12);

  const ShapePointer ball = make_level_set([](const Vec3& p) { return 0.25 - p[0] * p[0] - p[1] * p[1] - p[2] * p[2]; },
                                           {{-1, -1, -1}, {1, 1, 1}}, 0.05, 3);
  for (const Vec3& p : ball->surface({}, 0.1).points) EXPECT_NEAR(length_of(p), 0.5, 1e-10);
}

// A condition is 0 or 1: its surface lay on the nodes outside, off by up to a cell.
TEST(LevelSet, OfAConditionHasItsSurfaceWhereThatChanges) {
  const ShapePointer below =
      make_level_set([](const Vec3& p) { return p[1] < 0.03 ? 1.0 : 0.0; }, {{-1, -1, 0}, {1, 1, 0}}, 0.1, 2);
  for (const double y : {-0.5, 0.0, 0.03, 0.07, 0.6}) EXPECT_NEAR(below->distance({0.22, y}), y - 0.03, 1e-9);
}

// Repeated with a period of 2 the bed is as near to places beside the window as its copies are.
TEST(LevelSet, SeesItsCopies) {
  const auto wall = [](const Vec3& p) { return 0.2 - std::abs(p[0] + 0.5 - 2 * std::round((p[0] + 0.5) / 2)); };
  const Bounds window{{-1.1, -1, 0}, {1.1, 1, 0}};
  const ShapePointer alone = make_level_set(wall, window, 0.1, 2),
                     copied = make_level_set(wall, window, 0.1, 2, {{-2, 0, 0}, {2, 0, 0}});
  for (const double x : {-1.0, -0.5, 0.5, 0.9, 1.0})
    EXPECT_NEAR(copied->distance({x, 0.3}), -wall({x, 0, 0}), 1e-9) << x;
  EXPECT_GT(alone->distance({1, 0.3}), 1.2);
  const ShapePointer endless = continue_periodically(copied, {-1, 0, 0}, {2, 0, 0});
  for (const double x : {-7.3, -1.0, 3.1, 5.5}) {
    EXPECT_NEAR(endless->distance({x, 0.3}), -wall({x, 0, 0}), 1e-9) << x;
    EXPECT_NEAR(std::abs(endless->nearest({x, 0.3}).point[0] - x), std::abs(endless->distance({x, 0.3})), 1e-9);
  }
  // Each period of the window has its own wall, and the first is cut by none of its ends.
  EXPECT_NEAR(area_in_plane(endless->surface({{-3, -1, 0}, {3, 1, 0}}, 0.1)), 3 * 0.4 * 2, 1e-9);
}

// Facets and interpolation are the same on both sides to what each is off by.
TEST(LevelSet, IsNearlyTheSameOnBothSidesOfADisc) {
  const double spacing = 0.05, radius = 4 * spacing, h = spacing / 2;
  const ShapePointer disc = make_level_set(
      [&](const Vec3& p) { return radius * radius - (p[0] - 1) * (p[0] - 1) - (p[1] - 0.4) * (p[1] - 0.4); },
      {{-0.2, -0.2, 0}, {2.2, 1.4, 0}}, spacing, 2);
  const double bound = h * h / 8 / (radius - 2 * h * std::sqrt(2)) + h * h * 2 / (8 * radius);
  double largest = 0;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 16; ++j) {
      const Vec3 p{spacing * (i + 0.5), spacing * (j + 0.5), 0}, mirrored{2 - p[0], p[1], 0};
      largest = std::max(largest, std::abs(disc->distance(p) - disc->distance(mirrored)));
    }
  EXPECT_LT(largest, bound);
}

std::string refusal_of(const std::function<double(const Vec3&)>& value) {
  try {
    make_level_set(value, {{-1, -1, 0}, {1, 1, 0}}, 0.1, 2);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LevelSet, FunctionsWithoutASurfaceAreRefused) {
  EXPECT_THAT(refusal_of([](const Vec3&) { return 1.0; }), HasSubstr("positive everywhere in the domain"));
  EXPECT_THAT(refusal_of([](const Vec3&) { return -1.0; }), HasSubstr("positive nowhere in the domain"));
  EXPECT_THAT(refusal_of([](const Vec3& p) { return std::sqrt(p[0]); }), HasSubstr("not finite at (-1, -1)"));
}

}  // namespace
}  // namespace spume
