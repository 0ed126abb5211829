// SPDX-License-Identifier: MIT
// What keeps particles half a spacing from walls beside a free surface.
//
// A particle on a mirror is at rest there: its force towards its image vanishes, and what the others leave of a flat
// density field cancels it to first order. Closer to its image than the spacing it feels the artificial stress of
// Monaghan (8) too; its image behind the wall of a body is as far behind it. Bodies that stand still do without:
// particles that a slanted face leaves nearer than half a spacing are at rest there, and (8) would stir them.
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/methods/wcsph/flow.hpp"

namespace spume::wcsph {
namespace {

// Monaghan (2000): R = eps |P| f^4, f = W(r) / W(spacing).
constexpr double stress_share = 0.2;

}  // namespace

// Away from the wall, per volume; `head`: what the image has of pressure beside the particle.
double Flow::parting_force(std::size_t i, double distance, double gap, double head) const {
  const double h = resolution.smoothing_length, way = 2 * distance;
  const double scale = arrangement.context.gradient_scale * particles.volume * WendlandC2::normalisation(dimensions) /
                       std::pow(h, dimensions + 2);
  const double f = WendlandC2::w(way / h) / WendlandC2::w(2 * gap / h);
  const double stress = stress_share * std::abs(2 * pressure[i] + head) * (f * f * f * f - 1);
  return -scale * WendlandC2::f(way / h) * volume[i] * stress * way;
}

// The wall of a body that is nearer than half a spacing, and the force. A bubble that begins to grow appears beside
// particles, or under one: it claims no more than half of its half width around it.
std::optional<Flow::Parting> Flow::parting_from_bodies(std::size_t i, const Vec3& r) const {
  const BodyWalls& walls = *boundary.bodies();
  const double gap = scene.spacing / 2;
  if (walls.surely_farther(r, gap) || !(walls.distance(r) < gap)) return std::nullopt;
  const BodyWalls::NearestWall near = walls.nearest_wall(r);
  const double distance = std::max(near.distance, 0.0), own_gap = std::min(gap, near.half_width / 2);
  if (distance >= own_gap || !scene.bodies[near.body].motion) return std::nullopt;
  const double head = -2 * distance * law(i).density * dot(wall_gravity, near.normal);
  return Parting{near.body, near.point, multiply(parting_force(i, distance, own_gap, head), near.normal)};
}

void Flow::part_from_walls() {
  parallel_for(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis)
      for (std::size_t side = 0; side < 2; ++side) {
        const double way = boundary.walls[axis][side] - place[axis][i];
        if (std::abs(way) >= scene.spacing / 2 || !is_wall(scene.domain.sides[axis][side].kind)) continue;
        const double force =
            parting_force(i, std::abs(way), scene.spacing / 2, 2 * law(i).density * wall_gravity[axis] * way);
        pressure_force[axis][i] += static_cast<float>(way > 0 ? -force : force);
      }
    if (!features.displaced_bodies) return;
    if (const auto found = parting_from_bodies(i, vector_at(place, dimensions, i)))
      for (int axis = 0; axis < dimensions; ++axis) pressure_force[axis][i] += static_cast<float>(found->force[axis]);
  });
}

// What the bodies take of them, in the order of the particles.
void Flow::add_parting_forces(std::vector<WallForce>& forces) const {
  if (!features.displaced_bodies) return;
  std::vector<std::vector<Parting>> found(block_count(size(), default_block));
  parallel_blocks(size(), default_block, [&](std::size_t block, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      auto parting = parting_from_bodies(i, vector_at(particles.position, dimensions, i));
      if (!parting) continue;
      parting->force = multiply(-particles.volume * double{volume[i]}, parting->force);
      found[block].push_back(*parting);
    }
  });
  for (const auto& block : found)
    for (const Parting& parting : block) {
      forces[parting.body].pressure = add(forces[parting.body].pressure, parting.force);
      forces[parting.body].pressure_torque =
          add(forces[parting.body].pressure_torque, cross(parting.foot, parting.force));
    }
}

}  // namespace spume::wcsph
