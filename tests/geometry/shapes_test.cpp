// SPDX-License-Identifier: MIT
#include "spume/geometry/shapes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "solids.hpp"
#include "spume/core/error.hpp"
#include "spume/geometry/mesh.hpp"

namespace spume {
namespace {

using namespace test;
using testing::HasSubstr;

// Across the corner of a domain of periods 2 and 3: four copies. One without end along an axis has none there.
TEST(Shapes, GoOnBeyondPeriodicSides) {
  const Bounds domain{{0, 0, 0}, {2, 3, 1}};
  const Vec3 periods{2, 3, 0};
  const ShapePointer ball = place(make_ball(0.5, 3), {.position = {0.1, 2.8, 0.4}}, true, 3);
  const ShapePointer repeated = repeat(ball, domain, periods);
  for (std::uint64_t k = 0; k < 200; ++k) {
    Vec3 p = random_point(k, 1, 3);
    p = {1 + p[0], 1.5 + 1.5 * p[1], 0.5 + 0.5 * p[2]};
    double least = std::numeric_limits<double>::infinity();
    for (const double x : {-2.0, 0.0, 2.0})
      for (const double y : {-3.0, 0.0, 3.0}) least = std::min(least, ball->distance({p[0] - x, p[1] - y, p[2]}));
    EXPECT_DOUBLE_EQ(repeated->distance(p), least);
    const NearestPoint near = repeated->nearest(p);
    EXPECT_DOUBLE_EQ(near.distance, least);
    EXPECT_NEAR(length_of(between(near.point, p)), std::abs(least), 1e-12);
  }
  EXPECT_EQ(repeated->volume(), ball->volume());
  const ShapePointer within = place(make_ball(0.5, 3), {.position = {1, 1, 0.4}}, true, 3);
  EXPECT_EQ(repeat(within, domain, periods), within);
  const ShapePointer floor = make_half_space({0, 0, 1}, 3);
  EXPECT_EQ(repeat(floor, domain, periods), floor);
}

// Every fourth has copies, before or after it is placed, with a half-space and the outside of a ball; some are taken
// away where `holes`.
std::vector<CombinedPart> many_parts(int dimensions, bool holes) {
  std::vector<CombinedPart> parts;
  for (std::uint64_t k = 0; k < 24; ++k) {
    const Vec3 size = random_point(k, 8, dimensions);
    const Pose pose{.position = random_point(k, 7, dimensions),
                    .rotation = rotation_by({0, 0, 40.0 * static_cast<double>(k)})};
    const Vec3 sides{0.1 + 0.1 * std::abs(size[0]), 0.1 + 0.1 * std::abs(size[1]),
                     dimensions == 3 ? 0.1 + 0.1 * std::abs(size[2]) : 0};
    const ShapePointer own = k % 3 == 0 ? make_ball(0.15, dimensions) : make_box(sides, dimensions);
    ShapePointer shape = place(own, pose, true, dimensions);
    if (k % 4 == 0) shape = repeat(shape, {{-1, -1, -1}, {1, 1, 1}}, {2, 2, 0});
    if (k % 8 == 0) shape = place(shape, {.position = {0.3, -0.2, 0}}, true, dimensions);
    parts.push_back({shape, holes && k % 5 == 4});
  }
  parts.push_back({place(make_half_space({0, 1, 0}, dimensions), {.position = {0, -0.9, 0}}, true, dimensions)});
  parts.push_back({place(make_ball(1.2, dimensions), {}, false, dimensions)});
  return parts;
}

// What has copies may be repeated once more: the extent is that of all copies.
TEST(Shapes, ExtentsOfRepeatedShapesHoldAllCopies) {
  const Bounds window{{-0.2, 0, 0}, {1.2, 1, 1}};
  const ShapePointer once = repeat(make_box({0.1, 0.2, 0}, 2), window, {1, 0, 0});
  const ShapePointer twice = repeat(place(once, {}, true, 2), window, {0, 1, 0});
  EXPECT_LE(once->extent().lower[0], -0.05);
  EXPECT_GE(once->extent().upper[0], 1.05);
  EXPECT_EQ(twice->extent().lower[0], once->extent().lower[0]);
  EXPECT_EQ(twice->extent().upper[0], once->extent().upper[0]);
}

// Parts that cells and extents rule out change nothing: the same to the bit as asking all.
TEST(Shapes, CombinedAreThoseOfAllParts) {
  for (const int dimensions : {2, 3})
    for (const bool holes : {false, true}) {
      const std::vector<CombinedPart> parts = many_parts(dimensions, holes);
      const Combination all(parts);
      int inside = 0;
      for (std::uint64_t k = 0; k < 2000; ++k) {
        const Vec3 p = random_point(k, 9, dimensions);
        double distance = infinite;
        NearestPoint nearest{infinite, {}, p};
        for (const CombinedPart& part : parts) {
          const double own = part.shape->distance(p);
          distance = part.subtract ? std::max(distance, -own) : std::min(distance, own);
          NearestPoint next = part.shape->nearest(p);
          if (part.subtract) {
            next.distance = -next.distance;
            for (double& component : next.normal) component = -component;
          }
          if (part.subtract ? next.distance > nearest.distance : next.distance < nearest.distance) nearest = next;
        }
        EXPECT_EQ(all.distance(p), distance);
        EXPECT_EQ(all.nearest(p).distance, nearest.distance);
        EXPECT_EQ(all.nearest(p).point, nearest.point);
        EXPECT_EQ(all.nearest(p).normal, nearest.normal);
        inside += distance < 0;
      }
      EXPECT_GT(inside, 100);
    }
}

// The distance is no less than that of some point of the boundary, which nearest() names, and no more than that of all
// points that bisection finds, which lie no further apart than `reach`.
TEST(Shapes, DistancesAreThoseOfTheNearestPointOfTheBoundary) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    const BoundaryPoints boundary = find_boundary(solid.inside, 1, solid.dimensions == 3 ? 50 : 400, solid.dimensions);
    for (std::uint64_t i = 0; i < 300; ++i) {
      const Vec3 p = random_point(i, 1.5, solid.dimensions);
      const NearestPoint found = solid.shape->nearest(p);
      const double distance = std::abs(found.distance), brute = boundary.distance(p);
      EXPECT_LE(distance, brute + 1e-12);
      EXPECT_GE(distance, brute - boundary.reach);
      EXPECT_NEAR(length_of(between(found.point, p)), distance, 1e-12);
      EXPECT_EQ(found.distance < 0, solid.inside(p));
      EXPECT_EQ(solid.shape->distance(p), found.distance);
      // The boundary passes where the nearest point is said to be: next to it are members and others.
      int members = 0, others = 0;
      for (std::uint64_t k = 0; k < 200; ++k)
        ++(solid.inside(moved(found.point, 1e-9, random_point(k, 1, solid.dimensions))) ? members : others);
      EXPECT_TRUE(members > 0 && others > 0);
    }
  }
}

TEST(Shapes, NormalsAreTheGradientOfTheDistance) {
  constexpr double step = 1e-6;
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    int smooth = 0;
    for (std::uint64_t i = 0; i < 300; ++i) {
      const Vec3 p = random_point(i, 1.3, solid.dimensions);
      const NearestPoint found = solid.shape->nearest(p);
      EXPECT_NEAR(length_of(found.normal), 1, 1e-12);
      Vec3 gradient{};
      for (std::size_t a = 0; a < static_cast<std::size_t>(solid.dimensions); ++a) {
        Vec3 e{};
        e[a] = 1;
        gradient[a] =
            (solid.shape->distance(moved(p, step, e)) - solid.shape->distance(moved(p, -step, e))) / (2 * step);
      }
      // Within a step of the points that have two nearest ones the difference means nothing: its length tells.
      if (std::abs(length_of(gradient) - 1) > 1e-4) continue;
      ++smooth;
      // Rounding of the distance over the step, and step^2 / distance^2.
      EXPECT_LT(length_of(between(gradient, found.normal)), 1e-3);
    }
    EXPECT_GT(smooth, 280);
  }
}

// Of n random points in a cube of volume v, the share f inside has the standard deviation sqrt(f (1 - f) / n).
TEST(Shapes, VolumesAreThoseOfRandomPointsAndOfTextbooks) {
  constexpr std::uint64_t n = 40000;
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    std::size_t inside = 0;
    for (std::uint64_t i = 0; i < n; ++i) inside += solid.shape->inside(random_point(i, 1, solid.dimensions));
    const double cube = std::pow(2, solid.dimensions), share = static_cast<double>(inside) / n;
    EXPECT_NEAR(solid.shape->volume(), solid.volume, 1e-12);
    EXPECT_NEAR(cube * share, solid.volume, 5 * cube * std::sqrt(share * (1 - share) / n));
  }
}

// The facets of a round face lie within it: m of them around take 2 pi^2 / (3 m^2) of a circle, and those down a ball
// pi^2 / m^2 more, 16.5 / m^2 in all.
TEST(Shapes, SurfacesAreClosedAndEncloseTheVolume) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    const TriangleSurface surface = solid.shape->surface({{-1, -1, -1}, {1, 1, 1}}, 0.01);
    double volume = 0;
    if (solid.dimensions == 3) {
      EXPECT_THAT(mesh_faults(surface), testing::IsEmpty());
      volume = enclosed_volume(surface);
    }
    for (const auto& [a, b, c] : surface.triangles) {
      const auto at = [&](std::int32_t i) { return surface.points[static_cast<std::size_t>(i)]; };
      if (solid.dimensions == 2) {
        const Vec3 u = between(at(a), at(b)), v = between(at(a), at(c));
        EXPECT_GE(u[0] * v[1] - u[1] * v[0], 0);
        volume += 0.5 * (u[0] * v[1] - u[1] * v[0]);
      }
      for (const std::int32_t i : {a, b, c}) EXPECT_NEAR(solid.shape->distance(at(i)), 0, 1e-12);
    }
    // Circles of radius 0.3 at least, in steps of 0.01: 188 facets.
    EXPECT_NEAR(volume / solid.volume, 1, 16.5 / (188 * 188));
  }
}

TEST(Shapes, BoundsHoldTheShapeAndTouchIt) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    const Bounds bounds = solid.shape->bounds();
    const BoundaryPoints boundary = find_boundary(solid.inside, 1, 100, solid.dimensions);
    for (std::size_t a = 0; a < static_cast<std::size_t>(solid.dimensions); ++a) {
      double low = 1, high = -1;
      for (const Vec3& p : boundary.points) {
        low = std::min(low, p[a]);
        high = std::max(high, p[a]);
      }
      EXPECT_LE(bounds.lower[a], low + 1e-12);
      EXPECT_GE(bounds.upper[a], high - 1e-12);
      EXPECT_GE(bounds.lower[a], low - boundary.reach);
      EXPECT_LE(bounds.upper[a], high + boundary.reach);
    }
  }
}

TEST(Shapes, HalfSpacesAndEndlessShapesReachFarAndAreExact) {
  const ShapePointer ramp = make_half_space({3, 0, 4}, 3);
  EXPECT_NEAR(ramp->distance({5, 9, 0}), 3, 1e-14);
  EXPECT_NEAR(ramp->distance({0, -7, -5}), -4, 1e-14);
  EXPECT_EQ(ramp->volume(), std::numeric_limits<double>::infinity());
  const TriangleSurface face = ramp->surface({{-1, -1, -1}, {1, 1, 1}}, 0.1);
  ASSERT_EQ(face.triangles.size(), 2u);  // a rectangle: the plane leaves through x = -1 and x = 1
  for (const Vec3& p : face.points) EXPECT_NEAR(ramp->distance(p), 0, 1e-14);

  const ShapePointer bottom = make_half_space({0, 1, 0}, 2);
  EXPECT_EQ(bottom->bounds().upper[1], 0);
  EXPECT_NEAR(area_in_plane(bottom->surface({{-1, -2, 0}, {3, 1, 0}}, 0.1)), 8, 1e-12);

  const ShapePointer pipe = make_cylinder(0.5, {}, 3);
  EXPECT_NEAR(pipe->distance({3, 4, 1e6}), 4.5, 1e-14);
  EXPECT_NEAR(pipe->distance({0, 0, -3}), -0.5, 1e-14);
  const ShapePointer weir = make_outline({{0, 0}, {1, 0}, {0, 1}}, {}, 3);
  EXPECT_NEAR(weir->distance({-2, 100, 0.5}), 2, 1e-14);
  EXPECT_EQ(weir->volume(), std::numeric_limits<double>::infinity());
}

// Newton's steps end at the root also where two axes, or all points of a plane, are as near.
TEST(Shapes, EllipsoidsAreExactWhereTheNearestPointIsNotOne) {
  const ShapePointer flat = make_ellipsoid({0.8, 0.8, 0.3}, 3);
  EXPECT_NEAR(flat->distance({0, 0, 0}), -0.3, 1e-15);
  EXPECT_NEAR(flat->distance({0, 0, 1}), 0.7, 1e-15);
  const ShapePointer ball = make_ellipsoid({0.5, 0.5, 0.5}, 3);
  EXPECT_NEAR(ball->distance({0, 0, 0}), -0.5, 1e-15);
  EXPECT_NEAR(ball->distance({1e-300, 0, 0}), -0.5, 1e-15);
  const ShapePointer needle = make_ellipsoid({1, 1e-3, 1e-3}, 3);
  EXPECT_NEAR(needle->distance({0.5, 0, 0}), -1e-3 * std::sqrt(1 - 0.25 / (1 - 1e-6)), 1e-12);
  EXPECT_NEAR(needle->distance({2, 0, 0}), 1, 1e-15);
  EXPECT_NEAR(needle->distance({1e9, 1e9, 0}), std::hypot(1e9, 1e9), 1);
  // On the longest axis near its end the nearest point is that end: |e_0 (1 - (e_1/e_0)^2)| is the last centre of
  // curvature.
  const ShapePointer ellipse = make_ellipsoid({0.8, 0.4, 0}, 2);
  EXPECT_NEAR(ellipse->distance({0.7, 0, 0}), -0.1, 1e-15);
  EXPECT_NEAR(ellipse->distance({0.3, 1e-18, 0}), ellipse->distance({0.3, 0, 0}), 1e-15);
}

TEST(Shapes, PlacingTurnsMovesAndScales) {
  const Pose pose{{1, 2, 3}, rotation_by({20, -35, 70}), 2.5};
  for (const Solid& solid : solids()) {
    if (solid.dimensions == 2) continue;
    SCOPED_TRACE(solid.name);
    const ShapePointer placed = place(solid.shape, pose, true, 3), hole = place(solid.shape, pose, false, 3);
    for (std::uint64_t i = 0; i < 100; ++i) {
      const Vec3 own = random_point(i, 1.2, 3);
      Vec3 p = pose.position;
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) p[a] += pose.scale * pose.rotation[a][b] * own[b];
      const Vec3 back = to_own_coordinates(pose, p);
      EXPECT_LT(length_of(between(own, back)), 1e-14);
      const NearestPoint found = placed->nearest(p), turned = hole->nearest(p);
      EXPECT_NEAR(found.distance, 2.5 * solid.shape->distance(own), 1e-13);
      EXPECT_NEAR(length_of(between(p, found.point)), std::abs(found.distance), 1e-12);
      const Vec3 normal = solid.shape->nearest(own).normal;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& row = pose.rotation[k];
        EXPECT_NEAR(found.normal[k], row[0] * normal[0] + row[1] * normal[1] + row[2] * normal[2], 1e-12);
      }
      EXPECT_EQ(turned.distance, -found.distance);
      EXPECT_EQ(turned.normal, (Vec3{-found.normal[0], -found.normal[1], -found.normal[2]}));
      EXPECT_EQ(hole->distance(p), -placed->distance(p));
      EXPECT_EQ(turned.point, found.point);
    }
    EXPECT_NEAR(placed->volume(), solid.volume * 2.5 * 2.5 * 2.5, 1e-11);
    EXPECT_EQ(hole->volume(), std::numeric_limits<double>::infinity());
    const TriangleSurface surface = placed->surface({{-9, -9, -9}, {9, 9, 9}}, 0.1);
    EXPECT_GT(enclosed_volume(surface), 0);
    EXPECT_LT(enclosed_volume(hole->surface({{-9, -9, -9}, {9, 9, 9}}, 0.1)), 0);
    const Bounds bounds = placed->bounds();
    for (const Vec3& p : surface.points)
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_GE(p[a], bounds.lower[a] - 1e-12);
        EXPECT_LE(p[a], bounds.upper[a] + 1e-12);
      }
  }
}

TEST(Shapes, RotationsTurnAboutXThenYThenZByTheRightHandRule) {
  const auto turned = [](const Vec3& degrees, const Vec3& p) {
    const auto m = rotation_by(degrees);
    Vec3 q{};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) q[a] += m[a][b] * p[b];
    return q;
  };
  EXPECT_EQ(turned({0, 0, 90}, {1, 0, 0}), (Vec3{0, 1, 0}));
  EXPECT_EQ(turned({90, 0, 0}, {0, 1, 0}), (Vec3{0, 0, 1}));
  EXPECT_EQ(turned({0, 90, 0}, {0, 0, 1}), (Vec3{1, 0, 0}));
  EXPECT_EQ(turned({90, 0, 90}, {0, 1, 0}), (Vec3{0, 0, 1}));
  const Vec3 slanted = turned({0, 0, 30}, {1, 0, 0});
  EXPECT_NEAR(slanted[0], std::sqrt(0.75), 1e-15);
  EXPECT_NEAR(slanted[1], 0.5, 1e-15);
}

TEST(Shapes, ALaterShapeIsAddedOrTakenAway) {
  const Pose left{{-0.5, 0, 0}}, right{{0.5, 0, 0}};
  const ShapePointer ball = make_ball(0.7, 3);
  const CombinedPart first{place(ball, left, true, 3), false}, second{place(ball, right, true, 3), false};
  const Combination both({first, second}), cut({first, {second.shape, true}}),
      filled({first, {second.shape, true}, second});
  EXPECT_EQ(Combination().distance({1, 2, 3}), std::numeric_limits<double>::infinity());
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vec3 p = random_point(i, 1.5, 3);
    const bool a = first.shape->inside(p), b = second.shape->inside(p);
    EXPECT_EQ(both.inside(p), a || b);
    EXPECT_EQ(cut.inside(p), a && !b);
    EXPECT_EQ(filled.inside(p), a || b);
    for (const Combination* one : {&both, &cut}) {
      const NearestPoint found = one->nearest(p);
      EXPECT_EQ(found.distance, one->distance(p));
      EXPECT_NEAR(one->distance(moved(p, 1e-6, found.normal)), found.distance + 1e-6, 1e-8);
    }
  }
}

std::string refusal_of(const std::vector<std::array<double, 2>>& points) {
  try {
    make_outline(points, {}, 2);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Shapes, OutlinesThatBoundNoAreaAreRefused) {
  EXPECT_THAT(refusal_of({{0, 0}, {1, 1}}), HasSubstr("at least 3 points, found 2"));
  EXPECT_THAT(refusal_of({{0, 0}, {1, 0}, {1, 1}, {0, 0}}), HasSubstr("points 4 and 1 are the same, [0, 0]"));
  EXPECT_THAT(refusal_of({{0, 0}, {1, 1}, {1, 0}, {0, 1}}),
              HasSubstr("the side from point 1, [0, 0], to [1, 1] meets the side from point 3, [1, 0], to [0, 1]"));
  EXPECT_THAT(refusal_of({{0, 0}, {1, 0}, {2, 0}}), HasSubstr("runs back on itself"));
  EXPECT_THAT(refusal_of({{0, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}}), HasSubstr("meets"));
  EXPECT_EQ(refusal_of({{0, 0}, {0, 1}, {1, 1}, {1, 0}, {0.5, 0}}), "");
  EXPECT_NEAR(make_outline({{0, 0}, {0, 1}, {1, 1}, {1, 0}}, {}, 2)->volume(), 1, 1e-15) << "clockwise";
}

}  // namespace
}  // namespace spume
