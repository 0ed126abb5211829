// SPDX-License-Identifier: MIT
#include "spume/particles/rigid_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/particles/thin_bodies.hpp"
#include "spume/scene/expression.hpp"

namespace spume {
namespace {

// In support radii: farther from a surface nobody asks for more than a bound.
constexpr double far_away = 4;
// In spacings: by how much the half widths of the sizes of a growing body differ that have wall points of their own,
// and how many sizes there are at most.
constexpr double size_step = 0.5;
constexpr double most_sizes = 100;

bool is_along(const Vec3& direction, int axis) {
  return std::abs(direction[axis]) > 1 - 1e-12;
}

}  // namespace

RigidWalls::RigidWalls(const Scene& scene, std::optional<std::size_t> motion, const Resolution& resolution,
                       double particle_volume, const std::vector<std::uint8_t>& thin)
    : scene_(scene),
      motion_(motion ? &scene.motions[*motion] : nullptr),
      bounds_{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}},
      reach_(far_away * resolution.support_radius) {
  const int d = scene.domain.dimensions;
  std::vector<CombinedPart> parts, thin_parts;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.wall == BoundaryKind::open || body.motion != motion) continue;
    bodies_.push_back(b);
    parts.push_back({motion ? body.alone : body.solid, body.subtract});
    thin_.push_back(thin[b]);
    if (thin[b] != 0) thin_parts.push_back(parts.back());
    const Bounds own = parts.back().shape->bounds();
    for (int axis = 0; axis < d && !body.subtract; ++axis) {
      bounds_.lower[axis] = std::min(bounds_.lower[axis], own.lower[axis]);
      bounds_.upper[axis] = std::max(bounds_.upper[axis], own.upper[axis]);
    }
  }
  walls_ = Combination(std::move(parts));
  thin_walls_ = Combination(std::move(thin_parts));
  if (bodies_.empty()) return;
  if (motion_ != nullptr) place.pivot = place.position = motion_->pivot;
  if (motion_ != nullptr && motion_->release) place = given_place(*motion_, 0);
  accepted = place;
  const Bounds cells = motion_ == nullptr ? Bounds{scene.domain.lower, scene.domain.upper} : window(reach_);
  cells_.emplace(walls_, d, cells.lower, cells.upper, resolution.spacing, resolution.support_radius, error());
  if (has_thin()) {
    const Bounds thin_box = motion_ == nullptr ? cells : window(2 * resolution.support_radius);
    // Half the diagonal of a block less than a spacing and half from its middle. Within thick bodies nobody asks.
    const double far = 1.5 * resolution.spacing;
    thin_cells_.emplace(thin_walls_, d, thin_box.lower, thin_box.upper, resolution.spacing,
                        [&](const Vec3& at) { return cells_->least(at) > far || thin_walls_.distance(at) > far; });
  }
  std::size_t sizes = 1;
  if (grows()) {
    half_width_ = 0;
    for (int axis = 0; axis < d; ++axis)
      half_width_ = std::max(half_width_, (bounds_.upper[axis] - bounds_.lower[axis]) / 2);
    sizes = static_cast<std::size_t>(
        std::clamp(std::ceil(half_width_ / (size_step * resolution.spacing)), 1.0, most_sizes));
  }
  levels_.resize(sizes + 1);
  for (std::size_t level = 1; level <= sizes; ++level)
    levels_[level] = make_level(static_cast<double>(level) / static_cast<double>(sizes), resolution, particle_volume);
  choose_points();
}

RigidWalls::Level RigidWalls::make_level(double scale, const Resolution& resolution, double particle_volume) const {
  const int d = scene_.domain.dimensions;
  Level level;
  Combination scaled;
  if (scale < 1) {
    // A body that is released is alone.
    Pose pose;
    pose.scale = scale;
    pose.position = multiply(1 - scale, motion_->pivot);
    scaled = Combination({{spume::place(scene_.bodies[bodies_[0]].alone, pose, true, d), false}});
  }
  const Domain domain = motion_ == nullptr ? scene_.domain : domain_at_start(resolution.support_radius);
  const bool all_thin = std::find(thin_.begin(), thin_.end(), 0) == thin_.end();
  if (!all_thin) level.points = make_wall_points(scale < 1 ? scaled : walls_, domain, resolution, particle_volume);
  if (has_thin()) {
    std::erase_if(level.points, [&](const WallPoint& point) { return is_thin(body_at(point.foot)); });
  }
  level.body.resize(level.points.size());
  parallel_for(level.points.size(),
               [&](std::size_t g) { level.body[g] = static_cast<std::uint16_t>(body_at(level.points[g].foot)); });
  if (has_thin()) {
    std::vector<StandingBody> bodies;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const Body& body = scene_.bodies[bodies_[k]];
      bodies.push_back({motion_ == nullptr ? body.solid : body.alone, thin_[k] != 0});
    }
    for (const SheetPoint& point : make_sheet_points(bodies, walls_, domain, resolution, particle_volume)) {
      level.points.push_back(point);
      level.body.push_back(static_cast<std::uint16_t>(bodies_[point.body]));
    }
  }
  if (scale < 1)
    for (WallPoint& point : level.points)
      for (Vec3* at : {&point.position, &point.foot, &point.mirror})
        *at = add(motion_->pivot, multiply(1 / scale, subtract(*at, motion_->pivot)));
  return level;
}

bool RigidWalls::is_thin(std::size_t body) const {
  return thin_[static_cast<std::size_t>(std::find(bodies_.begin(), bodies_.end(), body) - bodies_.begin())] != 0;
}

std::size_t RigidWalls::level_of(double scale) const {
  return static_cast<std::size_t>(std::round(scale * static_cast<double>(levels_.size() - 1)));
}

void RigidWalls::choose_points() {
  level_ = level_of(place.scale);
}

double RigidWalls::error() const {
  double sum = 0;
  for (const std::size_t b : bodies_) sum += scene_.bodies[b].solid->error();
  return sum;
}

double RigidWalls::error_near(const Vec3& start, double reach) const {
  double sum = 0;
  for (const std::size_t b : bodies_) {
    const Shape& solid = *scene_.bodies[b].solid;
    if (solid.error() > 0 && solid.distance(start) < solid.error() + reach) sum += solid.error();
  }
  return sum;
}

bool RigidWalls::keeps(int axis) const {
  if (grows()) return false;
  if (motion_->floats) {
    bool turns_away = false;
    for (int other = 0; other < 3; ++other)
      turns_away = turns_away || (other != axis && motion_->free_about[other] != 0);
    return motion_->free_along[axis] == 0 && !turns_away;
  }
  const auto& way = motion_->displacement.component[static_cast<std::size_t>(axis)];
  return (way == nullptr || constant_value(*way)) && (motion_->angle == nullptr || is_along(motion_->axis, axis));
}

// Beds that go on beyond periodic sides: where the motion leads them along the axis, they are the same again.
bool RigidWalls::is_endless(int axis) const {
  if (!scene_.domain.periodic(axis) || motion_->floats || motion_->angle != nullptr || grows()) return false;
  return std::all_of(bodies_.begin(), bodies_.end(), [&](std::size_t b) {
    const Bounds own = scene_.bodies[b].shape->bounds();
    return own.lower[axis] == -infinite && own.upper[axis] == infinite;
  });
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
    const bool same = keeps(axis) || is_endless(axis);
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

Vec3 RigidWalls::beside_pivot(const Vec3& point) const {
  if (motion_ == nullptr) return point;
  Vec3 nearest = point;
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
    if (!scene_.domain.periodic(axis)) continue;
    const double period = scene_.domain.upper[axis] - scene_.domain.lower[axis];
    nearest[axis] -= period * std::round((point[axis] - place.position[axis]) / period);
  }
  return nearest;
}

Vec3 RigidWalls::start(const Vec3& now) const {
  return motion_ == nullptr ? now : place.start(beside_pivot(now));
}

double RigidWalls::distance_from_bounds(const Vec3& start) const {
  double sum = 0;
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
    const double away = std::max({bounds_.lower[axis] - start[axis], start[axis] - bounds_.upper[axis], 0.0});
    sum += away * away;
  }
  return std::sqrt(sum);
}

Bounds RigidWalls::bounds_now() const {
  Bounds found{};
  const auto d = static_cast<std::size_t>(scene_.domain.dimensions);
  Vec3 middle{}, half{};
  for (std::size_t axis = 0; axis < d; ++axis) {
    if (!std::isfinite(bounds_.upper[axis] - bounds_.lower[axis])) {
      found.lower.fill(-infinite);
      found.upper.fill(infinite);
      return found;
    }
    middle[axis] = 0.5 * (bounds_.lower[axis] + bounds_.upper[axis]);
    half[axis] = 0.5 * place.scale * (bounds_.upper[axis] - bounds_.lower[axis]);
  }
  middle = place.now(middle);
  for (std::size_t axis = 0; axis < d; ++axis) {
    double reach = 0;
    for (std::size_t own = 0; own < d; ++own) reach += std::abs(place.rotation[axis][own]) * half[own];
    found.lower[axis] = middle[axis] - reach;
    found.upper[axis] = middle[axis] + reach;
  }
  return found;
}

double RigidWalls::distance(const Vec3& point) const {
  if (place.scale == 1) return distance_at_start(start(point));
  return absent() ? infinite : place.scale * distance_at_start(start(point));
}

double RigidWalls::distance_at_start(const Vec3& at) const {
  if (motion_ != nullptr)
    if (const double away = distance_from_bounds(at); away > reach_) return away;
  return cells_->distance(at);
}

bool RigidWalls::surely_farther(const Vec3& point, double gap) const {
  if (place.scale != 1) {
    if (absent()) return true;
    gap /= place.scale;
  }
  const Vec3 at = start(point);
  if (motion_ != nullptr && distance_from_bounds(at) > gap) return true;
  return cells_->surely_farther(at, gap);
}

NearestPoint RigidWalls::nearest(const Vec3& point) const {
  if (motion_ == nullptr) return walls_.nearest(point);
  NearestPoint found = walls_.nearest(start(point));
  found.distance *= place.scale;
  found.normal = place.direction_now(found.normal);
  found.point = subtract(point, multiply(found.distance, found.normal));
  return found;
}

NearestPoint RigidWalls::thin_nearest(const Vec3& point) const {
  NearestPoint found = thin_walls_.nearest(start(point));
  if (motion_ == nullptr) return found;
  found.normal = place.direction_now(found.normal);
  found.point = subtract(point, multiply(found.distance, found.normal));
  return found;
}

NearDistances::Range RigidWalls::thin_range(const Vec3& point) const {
  const Vec3 at = start(point);
  NearDistances::Range range = thin_cells_->at(at);
  if (range.most == infinite) range.least = cells_->least(at);
  if (motion_ != nullptr) range.least = std::max(range.least, distance_from_bounds(at));
  return range;
}

std::optional<Vec3> RigidWalls::foremost(const Vec3& point, const Vec3& direction, double size, double about) const {
  const Vec3 at = place.start(point), way = rotated_back(place.rotation, direction);
  // What is nearest to a place far away reaches farthest to it: of a ball of radius r the share r / (r + far) of the
  // way to there is missed, and again of what is left. At the first place the forces of walls turned a ball of 3
  // spacings that slid down a ramp by 0.1 degrees.
  const Vec3 far = multiply(100 * size, way);
  Vec3 found = walls_.nearest(add(at, far)).point;
  if (length(subtract(found, at)) < about) {
    for (int round = 0; round < 3; ++round) {
      const Vec3 next = walls_.nearest(add(found, far)).point;
      if (!(length(subtract(next, at)) < about)) break;
      found = next;
    }
    return place.now(found);
  }
  // Something else reaches farther; the point may still do so beside its neighbours.
  const Vec3 beside = walls_.nearest(add(at, multiply(about, way))).point;
  if (length(subtract(beside, at)) < 1e-6 * about) return point;
  return std::nullopt;
}

bool RigidWalls::now(std::size_t point, const WallPositions& sides, WallPoint& found) const {
  found = points()[point];
  if (motion_ == nullptr) return true;
  found.position = place.now(found.position);
  found.foot = place.now(found.foot);
  found.mirror = place.now(found.mirror);
  found.normal = place.direction_now(found.normal);
  const Domain& domain = scene_.domain;
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    double shift = 0;
    const bool periodic = domain.periodic(axis);
    // Points behind the face of a thin body may lie beyond a side that the body is before.
    const double x = found.one_sided && !periodic ? found.mirror[axis] : found.position[axis];
    const double period = domain.upper[axis] - domain.lower[axis];
    if (periodic) {
      shift = -period * std::floor((x - domain.lower[axis]) / period);
    } else {
      for (int side = 0; side < 2; ++side) {
        const Side& at = domain.sides[axis][side];
        const double plane = sides[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
        const bool beyond = side == 0 ? x < plane : x > plane;
        if (beyond && at.bounds_liquid()) return false;
      }
    }
    if (shift != 0)
      for (Vec3* place_of : {&found.position, &found.foot, &found.mirror}) (*place_of)[axis] += shift;
  }
  return true;
}

double RigidWalls::bytes() const {
  double sum = (cells_ ? cells_->bytes() : 0) + (thin_cells_ ? thin_cells_->bytes() : 0);
  for (const Level& level : levels_)
    sum += static_cast<double>(level.points.capacity() * sizeof(WallPoint) + 2 * level.body.capacity());
  return sum;
}

}  // namespace spume
