// SPDX-License-Identifier: MIT
#include "spume/particles/work_of_bodies.hpp"

#include <algorithm>
#include <cmath>

namespace spume {
namespace {

// Drag and torque of cylinder_2d and taylor_couette are within 2 %, of hydrostatic_bodies within 0.5 %, at 20 to 40
// spacings; of coarse bodies forces are off by more.
constexpr double share_of_forces = 0.05;

bool moves_as_given(const Scene& scene, const Body& body) {
  return body.wall != BoundaryKind::open && body.motion && !scene.motions[*body.motion].floats;
}

}  // namespace

WorkOfBodies::WorkOfBodies(const Scene& scene) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (moves_as_given(scene, scene.bodies[b])) bodies_.push_back(b);
}

bool WorkOfBodies::any(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [&](const Body& body) { return moves_as_given(scene, body); });
}

bool WorkOfBodies::tells_all(const Scene& scene) {
  bool given = false, floats = false, other = false;
  for (const Body& body : scene.bodies) {
    given = given || moves_as_given(scene, body);
    floats = floats || (body.motion && scene.motions[*body.motion].floats);
    other = other || body.velocity || (body.motion && scene.motions[*body.motion].release);
  }
  return !other && !(given && floats);
}

bool WorkOfBodies::any_moves(const BodyWalls& walls) const {
  return std::any_of(bodies_.begin(), bodies_.end(), [&](std::size_t b) {
    const RigidPlace& place = walls.part_of(b).place;
    return place.velocity != Vec3{} || place.angular_velocity != Vec3{};
  });
}

double WorkOfBodies::power(const std::vector<SurfaceForce>& forces, const BodyWalls& walls) const {
  double sum = 0;
  for (const std::size_t b : bodies_) {
    const RigidPlace& place = walls.part_of(b).place;
    const Vec3 force = spume::add(forces[b].pressure, forces[b].viscous);
    const Vec3 torque =
        subtract(spume::add(forces[b].pressure_torque, forces[b].viscous_torque), cross(place.position, force));
    sum -= dot(force, place.velocity) + dot(torque, place.angular_velocity);
  }
  return sum;
}

void WorkOfBodies::add(double t, const std::vector<SurfaceForce>& forces, const BodyWalls& walls,
                       const std::function<double()>& energy) {
  if (samples_ > 0 && t <= last_.time) return;
  const Sample now{t, power(forces, walls)};
  const auto between = [](const Sample& a, const Sample& b) { return (b.time - a.time) * (a.power + b.power) / 2; };
  if (samples_ == 0) {
    set_out_ = any_moves(walls) ? 1 : 0;
    first_energy_ = energy();
  } else {
    if (samples_ == 1 && set_out_ > 0) start_ = std::abs(energy() - first_energy_);
    done_ += between(last_, now);
    gross_ += (t - last_.time) * (std::abs(last_.power) + std::abs(now.power)) / 2;
  }
  if (samples_ > 1 && std::fmod(samples_, 2) == 0) {
    const double e = between(before_, last_) + between(last_, now) - between(before_, now);
    off_ += e;
    scatter2_ += e * e;
  }
  before_ = last_, last_ = now, ++samples_;
}

double WorkOfBodies::uncertainty() const {
  return std::abs(off_) + 3 * std::sqrt(scatter2_) + start_ + share_of_forces * gross_;
}

void WorkOfBodies::save_with(SavedNumbers& saved) {
  for (double* value : {&done_, &gross_, &off_, &scatter2_, &samples_, &last_.time, &last_.power, &before_.time,
                        &before_.power, &set_out_, &first_energy_, &start_})
    saved.add(*value);
}

}  // namespace spume
