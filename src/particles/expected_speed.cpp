// SPDX-License-Identifier: MIT
#include "spume/particles/expected_speed.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "spume/particles/open_gates.hpp"

namespace spume {
namespace {

double norm(const Vec3& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double speed_of_inflows(const Scene& scene, double end) {
  constexpr int times = 32;
  double speed = 0;
  if (scene.openings.empty()) return speed;
  OpenGates gates(scene, std::pow(scene.spacing, scene.domain.dimensions));
  for (OpenGate& gate : gates.list)
    for (int n = 0; n <= times && gate.opening->inflow; ++n) {
      const double t = end * n / times;
      const Entering entering(*gate.opening, gate.find_wet(scene.domain.dimensions - 1, t), t);
      for (const OpenGate::Column& column : gate.columns)
        if (column.wet) speed = std::max(speed, norm(entering.velocity(column.foot)));
    }
  return speed;
}

double squared_speed_of_tension(const Scene& scene) {
  if (!(scene.surface_tension > 0)) return 0;
  std::vector<double> volume(scene.phases.size());
  for (const std::int32_t phase : scene.particles.phase)
    volume[static_cast<std::size_t>(phase)] += std::pow(scene.spacing, scene.domain.dimensions);
  double density = 0, smallest = 1e300;
  for (std::size_t n = 0; n < volume.size(); ++n) {
    density = std::max(density, scene.phases[n].density);
    if (volume[n] > 0) smallest = std::min(smallest, volume[n]);
  }
  const bool flat = scene.domain.dimensions == 2;
  const double radius =
      flat ? std::sqrt(smallest / std::numbers::pi) : std::cbrt(3 * smallest / (4 * std::numbers::pi));
  return scene.surface_tension * (flat ? 1 : 2) / (radius * density);
}

}  // namespace

double expected_speed(const Scene& scene, double end, bool falls) {
  const Domain& domain = scene.domain;
  const InitialParticles& p = scene.particles;
  double speed2 = std::max(squared_speed_of_tension(scene), std::pow(speed_of_inflows(scene, end), 2)), length = 0;
  Vec3 centre{};
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    length = std::max(length, domain.upper[axis] - domain.lower[axis]);
    centre[axis] = (domain.lower[axis] + domain.upper[axis]) / 2;
    const double fall2 = 2 * std::abs(scene.fluid.gravity[axis]) * (domain.upper[axis] - domain.lower[axis]);
    if (falls || domain.periodic(axis)) speed2 = std::max(speed2, fall2);
  }
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (const Side& side : domain.sides[axis])
      if (side.velocity) speed2 = std::max(speed2, std::pow(norm((*side.velocity)(centre, 0)), 2));
  for (const BodyMotion& motion : scene.motions)
    for (int k = 0; k <= 100; ++k) {
      const RigidPlace place = given_place(motion, end * k / 100);
      speed2 = std::max(speed2, std::pow(norm(place.velocity) + norm(place.angular_velocity) * length / 2, 2));
    }
  for (std::size_t i = 0; i < p.size(); ++i) {
    Vec3 u{}, r{};
    for (int axis = 0; axis < domain.dimensions; ++axis) {
      u[axis] = p.velocity[axis][i];
      r[axis] = p.position[axis][i];
    }
    speed2 = std::max(speed2, std::pow(norm(u), 2));
    if (scene.body_force) speed2 = std::max(speed2, 2 * length * norm((*scene.body_force)(r, 0)));
  }
  return std::sqrt(speed2);
}

}  // namespace spume
