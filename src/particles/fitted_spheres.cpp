// SPDX-License-Identifier: MIT
#include "spume/particles/fitted_spheres.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr double off_sphere = 0.05;

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
  return FittedSphere{add(point, centre), radius};
}

}  // namespace spume
