// SPDX-License-Identifier: MIT
#include "box_bodies.hpp"

#include <algorithm>
#include <string>

#include "spume/geometry/shapes.hpp"

namespace spume {
namespace {

// In spacings: nearer to a side than this a face is in it.
constexpr double in_side = 1e-6;

}  // namespace

bool has_wall_points(const Scene& scene) {
  return !scene.openings.empty() || std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                                [](const Body& body) { return body.wall != BoundaryKind::open; });
}

bool boxes_stand_in_full_domain(const Scene& scene) {
  const auto thick = [&](const SolidBox& box) {
    for (int axis = 0; axis < scene.domain.dimensions; ++axis)
      if (box.upper[axis] - box.lower[axis] < (1 - in_side) * scene.spacing) return false;
    return true;
  };
  const std::vector<SolidBox>& boxes = scene.domain.boxes;
  return !scene.free_surface && !boxes.empty() && std::all_of(boxes.begin(), boxes.end(), thick);
}

void make_bodies_of_boxes(Scene& scene) {
  Domain& domain = scene.domain;
  Bounds whole;
  Vec3 periods{};
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    whole.lower[axis] = domain.lower[axis] - beyond_side * scene.spacing;
    whole.upper[axis] = domain.upper[axis] + beyond_side * scene.spacing;
    if (domain.periodic(axis)) periods[axis] = domain.upper[axis] - domain.lower[axis];
  }
  for (std::size_t k = 0; k < domain.boxes.size(); ++k) {
    const SolidBox& box = domain.boxes[k];
    Vec3 size{};
    Pose pose;
    for (int axis = 0; axis < domain.dimensions; ++axis) {
      const double slack = in_side * scene.spacing, more = beyond_side * scene.spacing;
      const bool below = box.lower[axis] <= domain.lower[axis] + slack,
                 above = box.upper[axis] >= domain.upper[axis] - slack;
      // Along a periodic axis one that does not span it has copies, which join it at the side.
      const bool goes_on = !domain.periodic(axis) || (below && above);
      const double lower = box.lower[axis] - (below && goes_on ? more : 0),
                   upper = box.upper[axis] + (above && goes_on ? more : 0);
      size[axis] = upper - lower;
      pose.position[axis] = 0.5 * (lower + upper);
    }
    const ShapePointer placed = place(make_box(size, domain.dimensions), pose, true, domain.dimensions);
    const ShapePointer repeated = repeat(placed, whole, periods);
    scene.bodies.push_back({.name = "solid." + std::to_string(k),
                            .kind = "box",
                            .shape = repeated,
                            .solid = repeated,
                            .wall = box.kind,
                            .alone = placed});
  }
  domain.boxes.clear();
}

}  // namespace spume
