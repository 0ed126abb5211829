// SPDX-License-Identifier: MIT
// Arithmetic of vectors. A component that is not a number makes a length none either.
#pragma once

#include <cmath>

#include "spume/core/vec3.hpp"

namespace spume {

inline Vec3 add(const Vec3& a, const Vec3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec3 subtract(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec3 multiply(double factor, const Vec3& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
inline double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec3& a) {
  return std::sqrt(dot(a, a));
}
// Of length 1; along the last axis for a vector that is zero.
inline Vec3 unit(const Vec3& a, int dimensions = 3) {
  const double size = length(a);
  if (size > 0) return multiply(1 / size, a);
  return dimensions == 3 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
}

}  // namespace spume
