// SPDX-License-Identifier: MIT
#include "spume/particles/fitted_spheres.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "spume/core/vectors.hpp"
#include "spume/operators/small_matrix.hpp"

namespace spume {
namespace {

constexpr double off_sphere = 0.05;
// Of the axis of a cylinder: half of the directions that it may have are tried, as far apart as the first of them that
// Newton's method finds it from, and so many times; it squares what is left, in radians.
constexpr int first_axes = 6, most_rounds = 8;
constexpr double found_axis = 1e-13;

Vec3 across(const Vec3& axis, const Vec3& x) {
  return subtract(x, multiply(dot(axis, x), axis));
}

// One round: of |P x|^2 = 2 c . P x, P x the part of x across the axis, in c across the last axis, its part along that,
// and what turns the axis, by least squares. The axis turns; the centre is returned, from the point.
std::optional<Vec3> turn_axis(const Vec3& point, std::span<const Vec3> around, Vec3& axis, double& turn) {
  const Vec3 least = std::abs(axis[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = unit(across(axis, least)), v = cross(axis, u);
  double scale = 0;
  for (const Vec3& other : around) scale = std::max(scale, length(subtract(other, point)));
  std::array<double, 25> matrix{};
  std::array<double, 5> found{};
  for (const Vec3& other : around) {
    const Vec3 x = multiply(1 / scale, subtract(other, point));
    const double a = dot(u, x), b = dot(v, x), z = dot(axis, x);
    const std::array<double, 5> row{2 * a, 2 * b, -2 * z, 2 * z * a, 2 * z * b};
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = 0; j < 5; ++j) matrix[5 * i + j] += row[i] * row[j];
      found[i] += row[i] * (a * a + b * b);
    }
  }
  if (!factor_cholesky(matrix.data(), 5)) return std::nullopt;
  solve_cholesky(matrix.data(), 5, found.data());
  turn = std::hypot(found[3], found[4]);
  axis = unit(add(axis, add(multiply(found[3], u), multiply(found[4], v))));
  return multiply(scale, add(multiply(found[0], u), multiply(found[1], v)));
}

}  // namespace

std::optional<FittedSphere> fitted_sphere(const Vec3& point, const Vec3& outwards, std::span<const Vec3> around,
                                          int dimensions) {
  // Normal equations of 2 c . x = |x|^2.
  std::array<Vec3, 3> matrix{};
  if (dimensions == 2) matrix[2][2] = 1;
  Vec3 right{};
  double farthest = 0;
  for (const Vec3& other : around) {
    const Vec3 x = subtract(other, point);
    const double square = dot(x, x);
    farthest = std::max(farthest, square);
    for (std::size_t a = 0; a < 3; ++a) matrix[a] = add(matrix[a], multiply(2 * x[a], x));
    right = add(right, multiply(square, x));
  }
  const Vec3 columns[] = {cross(matrix[1], matrix[2]), cross(matrix[2], matrix[0]), cross(matrix[0], matrix[1])};
  const double determinant = dot(matrix[0], columns[0]);
  Vec3 centre{};
  for (std::size_t a = 0; a < 3; ++a) centre = add(centre, multiply(right[a] / determinant, columns[a]));
  const double radius = length(centre);
  if (!std::isfinite(radius) || !(dot(centre, outwards) < 0)) return std::nullopt;

  const double off_plane = farthest / (2 * radius);
  for (const Vec3& other : around) {
    const double off = std::abs(length(subtract(subtract(other, point), centre)) - radius);
    if (off > off_sphere * off_plane) return std::nullopt;
  }
  return FittedSphere{add(point, centre), radius, {}};
}

std::optional<FittedSphere> fitted_cylinder(const Vec3& point, const Vec3& outwards, std::span<const Vec3> around) {
  const Vec3 up = unit(outwards), least = std::abs(up[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = unit(across(up, least)), v = cross(up, u);
  for (int k = 0; k < first_axes; ++k) {
    const double angle = k * std::numbers::pi / first_axes;
    Vec3 axis = add(multiply(std::cos(angle), u), multiply(std::sin(angle), v));
    std::optional<Vec3> centre;
    double turn = 1;
    for (int round = 0; round < most_rounds && turn > found_axis; ++round)
      if (!(centre = turn_axis(point, around, axis, turn))) break;
    if (!centre || !(turn < 1e-6)) continue;
    const double radius = length(*centre);
    if (!std::isfinite(radius) || !(dot(*centre, outwards) < 0)) continue;
    double farthest = 0, off = 0;
    for (const Vec3& other : around) {
      const Vec3 x = across(axis, subtract(other, point));
      farthest = std::max(farthest, dot(x, x));
      off = std::max(off, std::abs(length(subtract(x, *centre)) - radius));
    }
    if (off <= off_sphere * farthest / (2 * radius)) return FittedSphere{add(point, *centre), radius, axis};
  }
  return std::nullopt;
}

}  // namespace spume
