// SPDX-License-Identifier: MIT
// Images of the liquid at periodic sides, walls and solids; moving walls; particles kept inside.
#include <algorithm>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {
namespace {

bool is_wall(BoundaryKind kind) {
  return kind == BoundaryKind::free_slip || kind == BoundaryKind::no_slip;
}

// A face of a solid bounds liquid unless it lies on or beyond a side of the domain.
bool face_bounds_liquid(const Domain& domain, const SolidBox& box, int axis, int side, double tolerance) {
  return side == 0 ? box.lower[axis] > domain.lower[axis] + tolerance
                   : box.upper[axis] < domain.upper[axis] - tolerance;
}

// What moving walls add to the velocities of images at time t; with friction no-slip walls along their planes too.
void find_image_offsets(const Liquid& liquid, double t, bool friction, VelocityImageRule& rule) {
  const Domain& domain = liquid.scene.domain;
  const int d = liquid.dimensions;
  const std::size_t m = liquid.images.size();
  for (int axis = 0; axis < d; ++axis) rule.offset[axis].resize(m);
  parallel_blocks(m, 4096, [&](std::size_t, std::size_t first, std::size_t last) {
    // Expressions keep their variables inside: each block evaluates its own copies.
    std::array<std::array<VectorExpression, 2>, 3> velocity;
    for (int axis = 0; axis < d; ++axis)
      for (int side = 0; side < 2; ++side)
        if (domain.sides[axis][side].velocity) velocity[axis][side] = domain.sides[axis][side].velocity->clone();
    for (std::size_t k = first; k < last; ++k) {
      std::array<double, 3> offset{};
      const ImagePath& path = liquid.images.paths()[static_cast<std::size_t>(liquid.images.path()[k])];
      for (int axis = 0; axis < d; ++axis) {
        const int side = path.side[axis];
        if (side < 0 || !is_wall(domain.sides[axis][side].kind)) continue;
        const bool holds = friction && domain.sides[axis][side].kind == BoundaryKind::no_slip;
        Vec3 wall{};
        if (domain.sides[axis][side].velocity) {
          Vec3 foot{};
          for (int a = 0; a < d; ++a) foot[a] = liquid.images.position(a)[k];
          foot[axis] = liquid.next_walls[axis][side];
          wall = velocity[axis][side](foot, t);
        }
        for (int a = 0; a < d; ++a)
          if (holds || a == axis) offset[a] = 2 * wall[a] - offset[a];
      }
      for (int a = 0; a < d; ++a) rule.offset[a][k] = static_cast<float>(offset[a]);
    }
  });
}

}  // namespace

ImageRules image_rules(const Liquid& liquid, const WallPositions& walls) {
  const Domain& domain = liquid.scene.domain;
  ImageRules rules;
  rules.dimensions = liquid.dimensions;
  rules.support_radius = liquid.grid.support_radius() * liquid.largest_length_ratio;
  for (int axis = 0; axis < liquid.dimensions; ++axis) {
    rules.lower[axis] = walls[axis][0];
    rules.upper[axis] = walls[axis][1];
    for (int side = 0; side < 2; ++side) {
      const BoundaryKind kind = domain.sides[axis][side].kind;
      rules.sides[axis][side] = kind == BoundaryKind::periodic ? ImageKind::periodic
                                : is_wall(kind)                ? ImageKind::mirror
                                                               : ImageKind::none;
    }
  }
  const double tolerance = 1e-6 * liquid.scene.spacing;
  for (const SolidBox& solid : domain.boxes) {
    ImageRules::Box box;
    box.lower = solid.lower;
    box.upper = solid.upper;
    for (int axis = 0; axis < liquid.dimensions; ++axis)
      for (int side = 0; side < 2; ++side)
        box.face[axis][side] = face_bounds_liquid(domain, solid, axis, side, tolerance);
    rules.boxes.push_back(box);
  }
  return rules;
}

WallPositions advanced_walls(const Liquid& liquid, double dt) {
  WallPositions walls = liquid.walls;
  if (!liquid.plan.displaced_walls) return walls;
  const Domain& domain = liquid.scene.domain;
  for (int axis = 0; axis < liquid.dimensions; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto& velocity = domain.sides[axis][side].velocity;
      if (!velocity || velocity->component[axis] == nullptr) continue;
      Vec3 centre = liquid.origin;
      centre[axis] = liquid.walls[axis][side];
      const double t = liquid.time;
      // Simpson's rule in time: exact for walls whose velocity is cubic over a step.
      const double mean = ((*velocity)(centre, t)[axis] + 4 * (*velocity)(centre, t + dt / 2)[axis] +
                           (*velocity)(centre, t + dt)[axis]) /
                          6;
      walls[axis][side] += mean * dt;
    }
  return walls;
}

void update_image_rules(Liquid& liquid, double t) {
  const Domain& domain = liquid.scene.domain;
  const ImageRules rules = image_rules(liquid, liquid.next_walls);
  const auto& paths = liquid.images.paths();
  const int d = liquid.dimensions;
  liquid.velocity_rule.sign.resize(paths.size());
  liquid.reflection.resize(paths.size());
  const auto reflect = [&](std::array<float, 3>& sign, int axis, BoundaryKind kind) {
    if (kind == BoundaryKind::free_slip) sign[axis] = -sign[axis];
    if (kind == BoundaryKind::no_slip)
      for (float& s : sign) s = -s;
  };
  for (std::size_t p = 0; p < paths.size(); ++p) {
    std::array<float, 3> sign{1, 1, 1};
    if (paths[p].box_face >= 0)
      reflect(sign, paths[p].box_face % 6 / 2, domain.boxes[static_cast<std::size_t>(paths[p].box_face / 6)].kind);
    for (int axis = 0; axis < d; ++axis)
      if (const int side = paths[p].side[axis]; side >= 0) reflect(sign, axis, domain.sides[axis][side].kind);
    liquid.velocity_rule.sign[p] = sign;
    for (int axis = 0; axis < 3; ++axis)
      liquid.reflection[p][axis] = axis < d ? static_cast<float>(Images::sign(paths[p], rules, axis)) : 1.0F;
  }
  if (liquid.plan.no_slip) liquid.mirror_rule.sign = liquid.reflection;
  if (!liquid.plan.moving_walls) return;
  find_image_offsets(liquid, t, true, liquid.velocity_rule);
  if (liquid.plan.no_slip && liquid.plan.displaced_walls) find_image_offsets(liquid, t, false, liquid.mirror_rule);
  // An image behind a wall moves with twice the velocity of the wall.
  liquid.wall_speed = 0.5 * std::sqrt(parallel_max(liquid.images.size(), 0.0, [&](std::size_t k) {
                        double speed2 = 0;
                        for (int a = 0; a < d; ++a) {
                          const double u = liquid.velocity_rule.offset[a][k];
                          speed2 += u * u;
                        }
                        return speed2;
                      }));
  if (std::isfinite(liquid.wall_speed)) return;
  StepFailure::Details details;
  details.cause = "the velocity of a wall is not a finite number";
  details.option = "domain.wall_velocity";
  details.value = liquid.wall_speed;
  throw StepFailure(details);
}

void apply_walls(const Liquid& liquid, const WallPositions& walls, Vec3& position, Vec3* velocity) {
  const Domain& domain = liquid.scene.domain;
  const double tiny = 1e-3 * liquid.scene.spacing;
  for (int axis = 0; axis < liquid.dimensions; ++axis) {
    double& x = position[axis];
    const double lower = walls[axis][0], upper = walls[axis][1];
    if (domain.periodic(axis)) {
      if (x < lower || x >= upper) {
        const double length = upper - lower;
        x -= length * std::floor((x - lower) / length);
        if (x >= upper) x = lower;  // rounding of a point just below the lower side
      }
      continue;
    }
    // Reflected, and never so far back that a fast particle crosses the domain.
    if (x < lower + tiny && is_wall(domain.sides[axis][0].kind)) {
      x = std::clamp(2 * lower - x, lower + tiny, lower + domain.upper[axis] - domain.lower[axis]);
      if (velocity != nullptr) (*velocity)[axis] = std::max((*velocity)[axis], 0.0);
    } else if (x > upper - tiny && is_wall(domain.sides[axis][1].kind)) {
      x = std::clamp(2 * upper - x, upper - domain.upper[axis] + domain.lower[axis], upper - tiny);
      if (velocity != nullptr) (*velocity)[axis] = std::min((*velocity)[axis], 0.0);
    }
  }
  for (const SolidBox& box : domain.boxes) {
    double nearest = 1e300;
    int face_axis = -1, face_side = 0;
    for (int axis = 0; axis < liquid.dimensions; ++axis)
      for (int side = 0; side < 2; ++side) {
        const double depth = side == 0 ? position[axis] - box.lower[axis] : box.upper[axis] - position[axis];
        if (depth <= 0) nearest = -1;
        if (nearest < 0) continue;
        if (depth < nearest && face_bounds_liquid(domain, box, axis, side, tiny)) {
          nearest = depth;
          face_axis = axis;
          face_side = side;
        }
      }
    if (nearest <= 0 || face_axis < 0) continue;
    const double outward = face_side == 0 ? -1 : 1;
    position[face_axis] += outward * (2 * nearest + tiny);
    if (velocity != nullptr && (*velocity)[face_axis] * outward < 0) (*velocity)[face_axis] = 0;
  }
}

}  // namespace spume::les_sph
