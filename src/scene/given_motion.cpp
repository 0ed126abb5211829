// SPDX-License-Identifier: MIT
// Where bodies with a given motion are.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/scene/expression.hpp"
#include "spume/scene/scene.hpp"

namespace spume {
namespace {

// Of a body that is released again and again: which time it is on its way, and for how long.
struct Turn {
  double number = 0, age = 0;
  bool waits = false;
};

Turn turn_at(const BodyMotion& motion, double t) {
  if (!motion.release) return {.age = t};
  const Release& release = *motion.release;
  const double since = t - release.first;
  if (since < 0) return {.number = -1, .waits = true};
  const double number = std::floor(since / release.cycle), age = since - number * release.cycle;
  if (age > release.duration) return {.number = number, .waits = true};
  return {.number = number, .age = age};
}

// To s (2 - s) of its size; `rate`: of the share s.
void grow(RigidPlace& place, double s, double rate) {
  place.scale = s * (2 - s);
  place.growth = s > 0 ? 2 * (1 - s) * rate / place.scale : 0;
}

}  // namespace

RigidPlace given_place(const BodyMotion& motion, double t) {
  const auto way = [&](double at) {
    Vec3 sum{};
    for (std::size_t a = 0; a < 3; ++a)
      if (const auto& part = motion.displacement.component[a]) sum[a] = (*part)(0, 0, 0, at) - (*part)(0, 0, 0, 0);
    return sum;
  };
  const auto angle = [&](double at) {
    return motion.angle ? ((*motion.angle)(0, 0, 0, at) - (*motion.angle)(0, 0, 0, 0)) * std::numbers::pi / 180 : 0;
  };
  const Turn turn = turn_at(motion, t);
  const double age = turn.age, e = 1e-7 * motion.time_scale;
  const auto rate = [&](const auto& of, auto&& combine) {
    return combine(of(age - 2 * e), of(age - e), of(age + e), of(age + 2 * e));
  };
  RigidPlace place;
  place.pivot = motion.pivot;
  place.position = add(motion.pivot, way(age));
  place.rotation = rotation_by_vector(multiply(angle(age), motion.axis));
  if (turn.waits) {
    place.scale = 0;
    return place;
  }
  if (motion.release) {
    const double left = motion.release->duration - age;
    if (age < motion.release->growth)
      grow(place, age / motion.release->growth, 1 / motion.release->growth);
    else if (left < motion.release->shrinkage)
      grow(place, left / motion.release->shrinkage, -1 / motion.release->shrinkage);
  }
  place.velocity = rate(way, [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return multiply(1 / (12 * e), add(subtract(a, d), multiply(8, subtract(c, b))));
  });
  const double spin =
      rate(angle, [&](double a, double b, double c, double d) { return (a - d + 8 * (c - b)) / (12 * e); });
  place.angular_velocity = multiply(spin, motion.axis);
  return place;
}

std::vector<std::array<RigidPlace, 2>> ways_between(const BodyMotion& motion, double from, double to) {
  const auto between = [&](double a, double b) { return std::array{given_place(motion, a), given_place(motion, b)}; };
  const Turn before = turn_at(motion, from), after = turn_at(motion, to);
  if (before.number == after.number && before.waits == after.waits) return {between(from, to)};
  // To the end of its way, and from the start of the next one.
  std::vector<std::array<RigidPlace, 2>> ways;
  const Release& release = *motion.release;
  const auto set_out = [&](const Turn& turn) { return release.first + turn.number * release.cycle; };
  if (!before.waits) ways.push_back(between(from, set_out(before) + (1 - 1e-12) * release.duration));
  if (!after.waits) ways.push_back(between(set_out(after), to));
  return ways;
}

}  // namespace spume
