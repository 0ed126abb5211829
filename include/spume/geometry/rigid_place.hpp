// SPDX-License-Identifier: MIT
// Where a rigid body stands and how it moves: the point x of the start is now at
//
//   position + rotation (scale (x - pivot)),
//
// and the body's velocity there is velocity + angular_velocity x arm + growth arm, arm = its distance from position. In
// two dimensions rotations are about z.
#pragma once

#include <array>
#include <cmath>

#include "spume/core/vec3.hpp"
#include "spume/core/vectors.hpp"

namespace spume {

using RotationMatrix = std::array<Vec3, 3>;  // rows

inline constexpr RotationMatrix no_rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

inline Vec3 rotated(const RotationMatrix& m, const Vec3& v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}
inline Vec3 rotated_back(const RotationMatrix& m, const Vec3& v) {
  return add(add(multiply(v[0], m[0]), multiply(v[1], m[1])), multiply(v[2], m[2]));
}

// `first`, then `second`.
inline RotationMatrix combined(const RotationMatrix& second, const RotationMatrix& first) {
  RotationMatrix result{};
  for (std::size_t i = 0; i < 3; ++i) result[i] = rotated_back(first, second[i]);
  return result;
}

// About the direction of `turn` by its length in radians (Rodrigues).
inline RotationMatrix rotation_by_vector(const Vec3& turn) {
  const double angle = length(turn);
  if (!(angle > 0)) return no_rotation;
  const Vec3 k = multiply(1 / angle, turn);
  const double c = std::cos(angle), s = std::sin(angle);
  RotationMatrix m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) m[i][j] = (1 - c) * k[i] * k[j] + (i == j ? c : 0);
  m[0][1] -= s * k[2];
  m[1][0] += s * k[2];
  m[0][2] += s * k[1];
  m[2][0] -= s * k[1];
  m[1][2] -= s * k[0];
  m[2][1] += s * k[0];
  return m;
}

// Of an angle from 0 to pi.
inline Vec3 rotation_vector(const RotationMatrix& m) {
  // Of twice the size of the sine.
  const Vec3 axis{m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
  const double sine = 0.5 * length(axis), cosine = 0.5 * (m[0][0] + m[1][1] + m[2][2] - 1);
  const double angle = std::atan2(sine, cosine);
  if (sine > 1e-6) return multiply(0.5 * angle / sine, axis);
  if (cosine > 0) return multiply(0.5, axis);
  // About half a turn: (1 + m) / 2 is the square of the axis.
  std::size_t largest = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (m[k][k] > m[largest][largest]) largest = k;
  Vec3 direction = m[largest];
  direction[largest] += 1;
  return multiply(angle / length(direction), direction);
}

struct RigidPlace {
  Vec3 pivot{}, position{};
  RotationMatrix rotation = no_rotation;
  Vec3 velocity{}, angular_velocity{};  // radians per time
  // Of a body that grows: its lengths over those at the start, and their rate of change over them. A body of no size is
  // not there.
  double scale = 1, growth = 0;

  Vec3 now(const Vec3& start) const {
    return add(position, rotated(rotation, multiply(scale, subtract(start, pivot))));
  }
  Vec3 start(const Vec3& now) const {
    return add(pivot, multiply(scale > 0 ? 1 / scale : 0, rotated_back(rotation, subtract(now, position))));
  }
  Vec3 direction_now(const Vec3& direction) const { return rotated(rotation, direction); }
  Vec3 velocity_at(const Vec3& now) const {
    const Vec3 arm = subtract(now, position);
    return add(add(velocity, cross(angular_velocity, arm)), multiply(growth, arm));
  }
};

}  // namespace spume
