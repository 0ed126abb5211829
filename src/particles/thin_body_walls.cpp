// SPDX-License-Identifier: MIT
// Walls of bodies where some are thin.
#include <algorithm>

#include "spume/core/vectors.hpp"
#include "spume/particles/body_walls.hpp"

namespace spume {
namespace {

// Spacings: a place before a face that the face itself does not hide.
constexpr double before_face = 0.1;

}  // namespace

void BodyWalls::keep_before_thin(const Vec3& from, Vec3& position, Vec3* velocity, double gap) const {
  const double way = length(subtract(position, from));
  if (surely_farther(position, 2 * way + resolution_.spacing)) return;
  for (const RigidWalls* part : thin_->parts()) {
    const Vec3 start = part->motion() == nullptr ? from : part->place.now(part->accepted.start(from));
    if (part->surely_farther(position, length(subtract(position, start)))) continue;
    const std::optional<ThinWalls::Entry> entry = thin_->entry(*part, start, position);
    if (!entry) continue;
    const Vec3 beyond = subtract(position, entry->place);
    const double depth = std::max(0.0, -dot(beyond, entry->normal));
    position = add(position, multiply(2 * depth, entry->normal));
    const Vec3 before = add(entry->place, multiply(gap, entry->normal));
    if (thin_->hides(before, position)) position = before;
    if (velocity == nullptr) continue;
    const double inwards = dot(subtract(*velocity, part->velocity_at(entry->place)), entry->normal);
    if (inwards < 0) *velocity = subtract(*velocity, multiply(inwards, entry->normal));
  }
}

void BodyWalls::look(Images& images) {
  images.set_sight(thin_.get());
  if (thin_ != nullptr) thin_->measure(images, points_, wet_points_);
}

void BodyWalls::accept() {
  if (thin_ == nullptr) return;
  for (const auto& part : parts_) part->accepted = part->place;
}

// Nothing thin lies between the face that a point is behind and what it mirrors there.
bool BodyWalls::sees_mirror(const WallPoint& point, double mirror_distance) const {
  if (point.flat && thin_->parts().size() == 1) return true;
  const Vec3 before = add(point.foot, multiply(before_face * resolution_.spacing, point.normal));
  return !thin_->hides(point.mirror, mirror_distance, before, 0);
}

}  // namespace spume
