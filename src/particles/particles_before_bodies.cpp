// SPDX-License-Identifier: MIT
// What meets the surfaces of bodies: particles are kept before them.
#include <algorithm>
#include <cmath>

#include "free_place.hpp"
#include "spume/particles/body_walls.hpp"

namespace spume {

void BodyWalls::keep_outside(Vec3& position, Vec3* velocity, double gap) const {
  if (surely_farther(position, gap)) return;
  const Nearest nearest = nearest_part(position);
  if (nearest.distance >= gap) return;
  const RigidWalls& walls = *nearest.part;
  NearestPoint near = walls.nearest(position);
  const NearestPoint first = near;
  const Vec3 start = position;
  Vec3 outwards = first.normal;
  const auto is_free = [&](const Vec3& place) { return nearest_walls(place).exact_distance(place) >= 0.5 * gap; };
  const auto is_reached = [&](const Vec3& place) {
    for (int axis = 0; axis < scene_.domain.dimensions; ++axis)
      for (const int side : {0, 1}) {
        const double plane = sides_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
        const bool beyond = side == 0 ? place[axis] < plane : place[axis] > plane;
        const BoundaryKind kind = scene_.domain.sides[axis][side].kind;
        if (beyond && (kind == BoundaryKind::free_slip || kind == BoundaryKind::no_slip)) return false;
      }
    return is_free(place);
  };
  position = add(near.point, multiply(std::max(gap, std::abs(near.distance)), near.normal));
  if (!is_free(position)) {
    // Another wall is there: before the nearest face.
    for (int round = 0; round < 3 && near.distance < gap; ++round) {
      position = add(near.point, multiply(gap, near.normal));
      near = nearest_walls(position).nearest(position);
    }
    // Between bodies that touch, faces that no liquid sees push to and fro: out to where there is none.
    if (!is_free(position))
      if (const auto place = free_place_near(start, scene_.domain.dimensions, scene_.spacing / 8, is_reached)) {
        position = *place;
        outwards = multiply(1 / length(subtract(position, start)), subtract(position, start));
      }
  }
  if (velocity == nullptr) return;
  const double inwards = dot(subtract(*velocity, walls.velocity_at(first.point)), outwards);
  if (inwards < 0) *velocity = subtract(*velocity, multiply(inwards, outwards));
}

void BodyWalls::limit_approach(const Vec3& position, double gap, double speed, const Vec3& before,
                               Vec3& velocity) const {
  if (surely_farther(position, gap)) return;
  const Nearest nearest = nearest_part(position);
  if (nearest.distance >= gap) return;
  const RigidWalls& walls = *nearest.part;
  const NearestPoint near = walls.nearest(position);
  const Vec3 surface = walls.velocity_at(near.point);
  const double approach = dot(subtract(velocity, surface), near.normal),
               most = std::min(-speed, dot(subtract(before, surface), near.normal));
  if (approach < most) velocity = add(velocity, multiply(most - approach, near.normal));
}

}  // namespace spume
