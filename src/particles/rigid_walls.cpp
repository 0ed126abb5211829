// SPDX-License-Identifier: MIT
#include "spume/particles/rigid_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/scene/expression.hpp"

namespace spume {
namespace {

// In support radii: farther from a surface nobody asks for more than a bound.
constexpr double far_away = 4;

bool is_along(const Vec3& direction, int axis) {
  return std::abs(direction[axis]) > 1 - 1e-12;
}

}  // namespace

RigidWalls::RigidWalls(const Scene& scene, std::optional<std::size_t> motion, const Resolution& resolution,
                       double particle_volume)
    : scene_(scene),
      motion_(motion ? &scene.motions[*motion] : nullptr),
      bounds_{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}},
      reach_(far_away * resolution.support_radius) {
  const int d = scene.domain.dimensions;
  std::vector<CombinedPart> parts;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.wall == BoundaryKind::open || body.motion != motion) continue;
    bodies_.push_back(b);
    parts.push_back({motion ? body.alone : body.solid, body.subtract});
    const Bounds own = parts.back().shape->bounds();
    for (int axis = 0; axis < d && !body.subtract; ++axis) {
      bounds_.lower[axis] = std::min(bounds_.lower[axis], own.lower[axis]);
      bounds_.upper[axis] = std::max(bounds_.upper[axis], own.upper[axis]);
    }
  }
  walls_ = Combination(std::move(parts));
  if (bodies_.empty()) return;
  if (motion_ != nullptr) place.pivot = place.position = motion_->pivot;
  const Bounds cells = motion_ == nullptr ? Bounds{scene.domain.lower, scene.domain.upper} : window(reach_);
  cells_.emplace(walls_, d, cells.lower, cells.upper, resolution.spacing, resolution.support_radius, error());
  points_ = make_wall_points(walls_, motion_ == nullptr ? scene.domain : domain_at_start(resolution.support_radius),
                             resolution, particle_volume);
  body_.resize(points_.size());
  parallel_for(points_.size(), [&](std::size_t g) { body_[g] = static_cast<std::uint8_t>(body_at(points_[g].foot)); });
}

double RigidWalls::error() const {
  double sum = 0;
  for (const std::size_t b : bodies_) sum += scene_.bodies[b].solid->error();
  return sum;
}

bool RigidWalls::keeps(int axis) const {
  if (motion_->floats) {
    bool turns_away = false;
    for (int other = 0; other < 3; ++other)
      turns_away = turns_away || (other != axis && motion_->free_about[other] != 0);
    return motion_->free_along[axis] == 0 && !turns_away;
  }
  const auto& way = motion_->displacement.component[static_cast<std::size_t>(axis)];
  return (way == nullptr || constant_value(*way)) && (motion_->angle == nullptr || is_along(motion_->axis, axis));
}

Bounds RigidWalls::window(double margin) const {
  const Domain& domain = scene_.domain;
  const double diagonal = length(subtract(domain.upper, domain.lower));
  Bounds found{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    for (const std::size_t b : bodies_) {
      const Bounds own = scene_.bodies[b].shape->bounds();
      found.lower[axis] = std::min(found.lower[axis], own.lower[axis]);
      found.upper[axis] = std::max(found.upper[axis], own.upper[axis]);
    }
    found.lower[axis] = std::max(found.lower[axis], domain.lower[axis] - diagonal) - margin;
    found.upper[axis] = std::min(found.upper[axis], domain.upper[axis] + diagonal) + margin;
  }
  for (int axis = domain.dimensions; axis < 3; ++axis) found.lower[axis] = found.upper[axis] = 0;
  return found;
}

Domain RigidWalls::domain_at_start(double reach) const {
  const Bounds around = window(reach);
  Domain domain;
  domain.dimensions = scene_.domain.dimensions;
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    // Along such an axis points have the images that they have beside bodies that stand still.
    const bool same = keeps(axis);
    domain.lower[axis] = same ? scene_.domain.lower[axis] : around.lower[axis];
    domain.upper[axis] = same ? scene_.domain.upper[axis] : around.upper[axis];
    for (int side = 0; side < 2; ++side)
      if (same) {
        domain.sides[axis][side].kind = scene_.domain.sides[axis][side].kind;
        domain.sides[axis][side].opening = scene_.domain.sides[axis][side].opening;
      }
  }
  return domain;
}

// The wall whose surface the foot lies on: the later of two that touch there.
std::size_t RigidWalls::body_at(const Vec3& foot) const {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t b : bodies_) {
    const Body& body = scene_.bodies[b];
    const double away = std::abs((motion_ == nullptr ? body.solid : body.alone)->distance(foot));
    if (away <= least) {
      least = away;
      best = b;
    }
  }
  return best;
}

Vec3 RigidWalls::start(const Vec3& now) const {
  if (motion_ == nullptr) return now;
  Vec3 nearest = now;
  // The copy of the body that is nearest: exact for bodies that are shorter than half a period, their reach included.
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
    if (!scene_.domain.periodic(axis)) continue;
    const double period = scene_.domain.upper[axis] - scene_.domain.lower[axis];
    nearest[axis] -= period * std::round((now[axis] - place.position[axis]) / period);
  }
  return place.start(nearest);
}

double RigidWalls::distance_from_bounds(const Vec3& start) const {
  double sum = 0;
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
    const double away = std::max({bounds_.lower[axis] - start[axis], start[axis] - bounds_.upper[axis], 0.0});
    sum += away * away;
  }
  return std::sqrt(sum);
}

double RigidWalls::distance(const Vec3& point) const {
  const Vec3 at = start(point);
  if (motion_ != nullptr)
    if (const double away = distance_from_bounds(at); away > reach_) return away;
  return cells_->distance(at);
}

bool RigidWalls::surely_farther(const Vec3& point, double gap) const {
  const Vec3 at = start(point);
  if (motion_ != nullptr && distance_from_bounds(at) > gap) return true;
  return cells_->surely_farther(at, gap);
}

NearestPoint RigidWalls::nearest(const Vec3& point) const {
  if (motion_ == nullptr) return walls_.nearest(point);
  NearestPoint found = walls_.nearest(start(point));
  found.normal = place.direction_now(found.normal);
  found.point = subtract(point, multiply(found.distance, found.normal));
  return found;
}

std::optional<Vec3> RigidWalls::foremost(const Vec3& point, const Vec3& direction, double size, double about) const {
  const Vec3 at = place.start(point), way = rotated_back(place.rotation, direction);
  // What is nearest to a place far away reaches farthest to it: of a ball of radius r the share r / (r + far) of the
  // way to there is missed.
  const Vec3 found = walls_.nearest(add(at, multiply(100 * size, way))).point;
  if (length(subtract(found, at)) < about) return place.now(found);
  // Something else reaches farther; the point may still do so beside its neighbours.
  const Vec3 beside = walls_.nearest(add(at, multiply(about, way))).point;
  if (length(subtract(beside, at)) < 1e-6 * about) return point;
  return std::nullopt;
}

bool RigidWalls::now(std::size_t point, WallPoint& found) const {
  found = points_[point];
  if (motion_ == nullptr) return true;
  found.position = place.now(found.position);
  found.foot = place.now(found.foot);
  found.mirror = place.now(found.mirror);
  found.normal = place.direction_now(found.normal);
  const Domain& domain = scene_.domain;
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    double shift = 0;
    const double x = found.position[axis], period = domain.upper[axis] - domain.lower[axis];
    if (domain.periodic(axis)) {
      shift = -period * std::floor((x - domain.lower[axis]) / period);
    } else {
      for (int side = 0; side < 2; ++side) {
        const Side& at = domain.sides[axis][side];
        const bool beyond = side == 0 ? x < domain.lower[axis] : x > domain.upper[axis];
        if (beyond && at.bounds_liquid()) return false;
      }
    }
    if (shift != 0)
      for (Vec3* place_of : {&found.position, &found.foot, &found.mirror}) (*place_of)[axis] += shift;
  }
  return true;
}

double RigidWalls::bytes() const {
  return (cells_ ? cells_->bytes() : 0) +
         static_cast<double>(points_.capacity() * sizeof(WallPoint) + body_.capacity());
}

}  // namespace spume
