// SPDX-License-Identifier: MIT
// Shapes beside the plain definition of what belongs to them; all lie in the cube [-1, 1].
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "reference/boundary_points.hpp"
#include "spume/core/random.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume::test {

struct Solid {
  std::string name;
  int dimensions;
  ShapePointer shape;
  Membership inside;
  double volume;  // by textbook formula
};

inline double squared(double x) {
  return x * x;
}

// Of an outline with a notch: a square with a wedge cut out of its upper side.
inline const std::vector<std::array<double, 2>> notched{
    {-0.8, -0.6}, {0.8, -0.6}, {0.8, 0.6}, {0.1, -0.2}, {-0.8, 0.6}};
inline bool in_notched(double x, double y) {
  if (std::abs(x) > 0.8 || y < -0.6) return false;
  return x > 0.1 ? y < -0.2 + 0.8 * (x - 0.1) / 0.7 : y < -0.2 + 0.8 * (0.1 - x) / 0.9;
}

inline std::vector<Solid> solids() {
  constexpr double pi = std::numbers::pi;
  std::vector<Solid> list;
  list.push_back({"ball", 3, make_ball(0.7, 3),
                  [](const Vec3& p) { return squared(p[0]) + squared(p[1]) + squared(p[2]) < squared(0.7); },
                  4 * pi / 3 * 0.343});
  list.push_back({"disc", 2, make_ball(0.7, 2),
                  [](const Vec3& p) { return squared(p[0]) + squared(p[1]) < squared(0.7); }, pi * 0.49});
  list.push_back({"box", 3, make_box({1.2, 0.8, 1.6}, 3),
                  [](const Vec3& p) { return std::abs(p[0]) < 0.6 && std::abs(p[1]) < 0.4 && std::abs(p[2]) < 0.8; },
                  1.2 * 0.8 * 1.6});
  list.push_back({"rectangle", 2, make_box({1.2, 0.8, 0}, 2),
                  [](const Vec3& p) { return std::abs(p[0]) < 0.6 && std::abs(p[1]) < 0.4; }, 1.2 * 0.8});
  list.push_back({"cylinder", 3, make_cylinder(0.5, 1.4, 3),
                  [](const Vec3& p) { return std::hypot(p[0], p[1]) < 0.5 && std::abs(p[2]) < 0.7; }, pi * 0.25 * 1.4});
  list.push_back({"cylinder across the plane", 2, make_cylinder(0.5, {}, 2),
                  [](const Vec3& p) { return std::hypot(p[0], p[1]) < 0.5; }, pi * 0.25});
  list.push_back({"cone", 3, make_cone(0.6, 0, 1.2, 3),
                  [](const Vec3& p) { return p[2] > -0.6 && std::hypot(p[0], p[1]) < 0.6 * (0.6 - p[2]) / 1.2; },
                  pi / 3 * 0.36 * 1.2});
  list.push_back(
      {"frustum upside down", 3, make_cone(0.3, 0.7, 1.2, 3),
       [](const Vec3& p) { return std::abs(p[2]) < 0.6 && std::hypot(p[0], p[1]) < 0.3 + 0.4 * (p[2] + 0.6) / 1.2; },
       pi / 3 * 1.2 * (0.09 + 0.21 + 0.49)});
  list.push_back({"triangle", 2, make_cone(0.6, 0, 1.2, 2),
                  [](const Vec3& p) { return p[1] > -0.6 && std::abs(p[0]) < 0.6 * (0.6 - p[1]) / 1.2; }, 0.6 * 1.2});
  list.push_back({"capsule", 3, make_capsule(0.4, 0.8, 3),
                  [](const Vec3& p) { return std::hypot(p[0], p[1], std::max(0.0, std::abs(p[2]) - 0.4)) < 0.4; },
                  pi * 0.16 * 0.8 + 4 * pi / 3 * 0.064});
  list.push_back({"stadium", 2, make_capsule(0.4, 0.8, 2),
                  [](const Vec3& p) { return std::hypot(p[0], std::max(0.0, std::abs(p[1]) - 0.4)) < 0.4; },
                  pi * 0.16 + 0.8 * 0.8});
  list.push_back({"ellipsoid", 3, make_ellipsoid({0.8, 0.3, 0.5}, 3),
                  [](const Vec3& p) { return squared(p[0] / 0.8) + squared(p[1] / 0.3) + squared(p[2] / 0.5) < 1; },
                  4 * pi / 3 * 0.8 * 0.3 * 0.5});
  list.push_back({"oblate ellipsoid", 3, make_ellipsoid({0.8, 0.8, 0.3}, 3),
                  [](const Vec3& p) { return squared(p[0] / 0.8) + squared(p[1] / 0.8) + squared(p[2] / 0.3) < 1; },
                  4 * pi / 3 * 0.64 * 0.3});
  list.push_back({"ellipse", 2, make_ellipsoid({0.3, 0.8, 0}, 2),
                  [](const Vec3& p) { return squared(p[0] / 0.3) + squared(p[1] / 0.8) < 1; }, pi * 0.24});
  // The notch takes 0.8 * 1.6 / 2 from 1.6 * 1.2.
  list.push_back(
      {"outline", 2, make_outline(notched, {}, 2), [](const Vec3& p) { return in_notched(p[0], p[1]); }, 1.92 - 0.64});
  list.push_back({"extruded outline", 3, make_outline(notched, 1.0, 3),
                  [](const Vec3& p) { return std::abs(p[1]) < 0.5 && in_notched(p[0], p[2]); }, 1.92 - 0.64});
  return list;
}

// Point number i of a fixed sequence in the cube [-half, half], in the plane z = 0 in two dimensions.
inline Vec3 random_point(std::uint64_t i, double half, int dimensions) {
  const auto u = random_uniform(7, RandomPurpose::test, i, 0, 0);
  return {half * (2 * u[0] - 1), half * (2 * u[1] - 1), dimensions == 3 ? half * (2 * u[2] - 1) : 0};
}

inline double length_of(const Vec3& a) {
  return std::hypot(a[0], a[1], a[2]);
}
inline Vec3 between(const Vec3& from, const Vec3& to) {
  return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}

// Of a surface in the plane, less what faces down.
inline double area_in_plane(const TriangleSurface& surface) {
  double area = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const auto at = [&](std::int32_t i) { return surface.points[static_cast<std::size_t>(i)]; };
    const Vec3 u = between(at(a), at(b)), v = between(at(a), at(c));
    area += 0.5 * (u[0] * v[1] - u[1] * v[0]);
  }
  return area;
}
inline Vec3 moved(const Vec3& p, double way, const Vec3& along) {
  return {p[0] + way * along[0], p[1] + way * along[1], p[2] + way * along[2]};
}

}  // namespace spume::test
