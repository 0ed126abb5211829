// SPDX-License-Identifier: MIT
#include "spume/particles/body_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/point_fits.hpp"
#include "spume/particles/thin_bodies.hpp"

namespace spume {
namespace {

constexpr double wet_wall_share = 0.5;
// In liquid that has no surface, of a full kernel sum: less is a void, where particles are missing on some side. Fits
// there may amplify what particles carry: with liquid all around, on lattices jittered by a fifth of a spacing, the sum
// of |c_j| is 1.25 to 1.45 and up to 1.85, without 30 % of the particles up to 40. The jet that leaves the lid of a
// cavity of bodies at Re = 1000 then reached 90 times the speed of the lid.
constexpr double full_wall_share = 0.9, most_moduli_beside_void = 1.5;
// Means of a few particles are no values of liquid mirrored at a wall: where one of them has a pressure and the others
// hold p = 0, the mean draws it into the wall, the faster the more its pressure grows. At the back of a weir spray
// reached 135 m/s where the water falls with 2.6 m/s.
// Except before another wall: in slots and wedges, where particles are few, a point that takes no part is a hole in the
// wall. Still water at their mouths grew restless by e in 1 sqrt(H/g), and what fits amplify by 3 at every step.
constexpr int least_order = 1, least_order_before_wall = 0;
// Each part costs a particle 6 ns a question; cells cost 1 ns and a pass over the domain at every step.
constexpr std::size_t many_parts = 4;

}  // namespace

// What a block of wall points found: those that are wet, in their order.
struct BodyWalls::Block {
  std::vector<std::int32_t>& point;
  PointFits& fits;
};

BodyWalls::BodyWalls(const Scene& scene, const Resolution& resolution, double particle_volume)
    : scene_(scene), resolution_(resolution) {
  for (std::size_t axis = 0; axis < 3; ++axis) sides_[axis] = {scene.domain.lower[axis], scene.domain.upper[axis]};
  const std::vector<std::uint8_t> thin = find_thin_bodies(scene, resolution);
  parts_.push_back(std::make_unique<RigidWalls>(scene, std::nullopt, resolution, particle_volume, thin));
  for (std::size_t m = 0; m < scene.motions.size(); ++m)
    parts_.push_back(std::make_unique<RigidWalls>(scene, m, resolution, particle_volume, thin));
  // With the speed that it may set out at.
  for (std::size_t m = 0; m < scene.motions.size(); ++m)
    if (!scene.motions[m].floats) parts_[m + 1]->place = given_place(scene.motions[m], 0);
  std::vector<const RigidWalls*> with_thin;
  for (const auto& part : parts_)
    if (part->has_thin()) with_thin.push_back(part.get());
  if (!with_thin.empty()) thin_ = std::make_unique<ThinWalls>(scene, resolution, std::move(with_thin));
  for (const Body& body : scene.bodies)
    surfaces_move_ = surfaces_move_ || (body.wall != BoundaryKind::open && (body.velocity || body.motion));
  if (parts_.size() > many_parts) bounds_.emplace(scene.domain, resolution.spacing, resolution.support_radius);
  const auto walled = [](const auto& part) { return !part->empty(); };
  if (std::count_if(parts_.begin(), parts_.end(), walled) == 1)
    only_ = std::find_if(parts_.begin(), parts_.end(), walled)->get();
  const RigidWalls& still = *parts_[0];
  points_ = still.points();
  standing_ = points_.size();
  body_.resize(standing_);
  for (std::size_t g = 0; g < standing_; ++g) body_[g] = static_cast<std::uint16_t>(still.body_of(g));
  mark_bounds();
  gather_points();
}

std::unique_ptr<BodyWalls> make_body_walls(const Scene& scene, const Resolution& resolution) {
  const bool walls = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                 [](const Body& body) { return body.wall != BoundaryKind::open; });
  return walls ? std::make_unique<BodyWalls>(scene, resolution, scene.particles.volume) : nullptr;
}

void BodyWalls::move_to(double t) {
  for (std::size_t m = 0; m < scene_.motions.size(); ++m)
    if (!scene_.motions[m].floats) parts_[m + 1]->place = given_place(scene_.motions[m], t);
  mark_bounds();
  gather_points();
}

void BodyWalls::mark_bounds() {
  if (!bounds_) return;
  bounds_->clear();
  // From the last, so that questions come to the first part first.
  for (std::size_t part = parts_.size() - 1; part > 0; --part)
    if (!parts_[part]->empty() && !parts_[part]->absent()) bounds_->mark(parts_[part]->bounds_now(), part);
}

void BodyWalls::set_place(std::size_t motion, const RigidPlace& place, const RigidPlace& behind,
                          const RigidPlace& ahead) {
  RigidWalls& walls = *parts_[motion + 1];
  walls.place = place;
  walls.behind = behind;
  walls.ahead = ahead;
  mark_bounds();
}

// Where bodies overlap, the points of the first of them stand for all.
void BodyWalls::gather_points() {
  if (scene_.motions.empty()) return;
  points_.resize(standing_);
  body_.resize(standing_);
  origin_.clear();
  for (std::size_t part = 1; part < parts_.size(); ++part) {
    RigidWalls& walls = *parts_[part];
    walls.choose_points();
    const std::size_t count = walls.points().size();
    std::vector<WallPoint> now(count);
    std::vector<std::uint8_t> seen(count);
    parallel_for(count, [&](std::size_t g) {
      bool is_first = walls.now(g, sides_, now[g]);
      const Vec3& at = now[g].one_sided ? now[g].foot : now[g].position;
      ask_near(at, [&](std::size_t before) {
        if (!is_first || before >= part) return;
        is_first =
            parts_[before]->empty() || parts_[before]->surely_farther(at, 0) || !(parts_[before]->distance(at) < 0);
      });
      seen[g] = is_first ? 1 : 0;
    });
    for (std::size_t g = 0; g < count; ++g) {
      if (seen[g] == 0) continue;
      points_.push_back(now[g]);
      body_.push_back(static_cast<std::uint16_t>(walls.body_of(g)));
      origin_.push_back({static_cast<std::int32_t>(part), static_cast<std::int32_t>(g)});
    }
  }
}

template <class Visit>
bool BodyWalls::ask_near(const Vec3& point, Visit&& visit) const {
  if (!parts_[0]->empty()) visit(std::size_t{0});
  if (bounds_ && bounds_->visit(point, visit)) return true;
  for (std::size_t part = 1; part < parts_.size(); ++part)
    if (!parts_[part]->empty()) visit(part);
  return false;
}

BodyWalls::Nearest BodyWalls::nearest_part(const Vec3& point) const {
  Nearest best;
  const auto ask = [&](std::size_t part) {
    const double own = parts_[part]->distance(point);
    if (best.part == nullptr || own < best.distance) best = {parts_[part].get(), own};
  };
  if (ask_near(point, ask) && !(best.distance <= bounds_->margin()))
    for (std::size_t part = 1; part < parts_.size(); ++part)
      if (!parts_[part]->empty()) ask(part);
  return best;
}

// The same part; where there is one alone it is not asked.
const RigidWalls& BodyWalls::nearest_walls(const Vec3& point) const {
  return only_ != nullptr ? *only_ : *nearest_part(point).part;
}

double BodyWalls::distance(const Vec3& point) const {
  return nearest_part(point).distance;
}

bool BodyWalls::surely_farther(const Vec3& point, double gap) const {
  bool farther = true;
  const auto ask = [&](std::size_t part) { farther = farther && parts_[part]->surely_farther(point, gap); };
  if (ask_near(point, ask) && gap > bounds_->margin())
    for (std::size_t part = 1; part < parts_.size(); ++part)
      if (!parts_[part]->empty()) ask(part);
  return farther;
}

BodyWalls::NearestWall BodyWalls::nearest_wall(const Vec3& point) const {
  const RigidWalls& walls = nearest_walls(point);
  NearestWall found;
  static_cast<NearestPoint&>(found) = walls.nearest(point);
  found.body = walls.body_near(found.point);
  found.half_width = walls.half_width();
  return found;
}

std::optional<BodyWalls::NearWall> BodyWalls::wall_within(const Vec3& point, double gap) const {
  if (surely_farther(point, gap)) return {};
  const Nearest nearest = nearest_part(point);
  if (nearest.distance > gap) return {};
  NearWall found;
  static_cast<NearestPoint&>(found) = nearest.part->nearest(point);
  found.velocity = nearest.part->velocity_at(found.point);
  return found;
}

bool BodyWalls::is_wet(std::size_t point) const {
  return std::binary_search(wet_points_.begin(), wet_points_.end(), static_cast<std::int32_t>(point));
}

WallPointView BodyWalls::wet() const {
  WallPointView view{.size = stencils_.size(), .source = stencils_.nearest.data()};
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) view.position[axis] = wet_position_[axis].data();
  return view;
}

template <int dimensions>
void BodyWalls::fit_block(const Arrangement& arrangement, const VectorField& at, double particle_volume,
                          std::size_t first, std::size_t last, Block& block) const {
  const double h = resolution_.smoothing_length;
  PointFit<dimensions> fit(resolution_);
  std::vector<double> across;  // of the particles near a point, from its tangent plane
  for (std::size_t g = first; g < last; ++g) {
    const WallPoint& point = points_[g];
    const double free = thin_ == nullptr ? infinite : thin_->free_distance(point.mirror);
    if (point.one_sided && !point.in_corner && !sees_mirror(point, free)) continue;
    double kernel_sum = 0;
    bool seen = false;  // from within the support radius
    const NearParticles& near = fit.begin(scene_.domain, arrangement, at, point.mirror);
    const double depth = dot(subtract(point.mirror, point.foot), point.normal),
                 support2 = resolution_.support_radius * resolution_.support_radius;
    const Vec3 behind = subtract(point.mirror, point.position);
    with_plain_kernel(dimensions, resolution_.kernel, [&]<int d, class Kernel>() {
      const double scale = particle_volume * Kernel::normalisation(d) / std::pow(h, d);
      across.resize(near.size());
      const auto with_mirrored = [&](double r2, double height) {
        const double mirrored2 = std::max(0.0, r2 + 4 * height * depth);
        return Kernel::w(std::sqrt(r2) / h) + Kernel::w(std::sqrt(mirrored2) / h);
      };
      double nearest2 = support2, sum = 0;
#pragma omp simd reduction(min : nearest2) reduction(+ : sum)
      for (std::size_t k = 0; k < near.size(); ++k) {
        double height = depth, way2 = 0;
        for (int axis = 0; axis < d; ++axis) {
          const double offset = near.offset(axis, k), way = offset + behind[axis];
          height += offset * point.normal[axis];
          way2 += way * way;
        }
        across[k] = height;
        nearest2 = std::min(nearest2, way2);
        const double both = with_mirrored(near.r2(k), height);
        sum += height < 0 ? 0 : both;
      }
      seen = nearest2 < support2;
      // Behind the tangent plane stands liquid of another side, or of a curved one, which the fit can miss.
      for (std::size_t k = 0; k < near.size(); ++k) {
        if (across[k] < 0) continue;
        if (free < fit.reach()) {
          Vec3 offset{};
          for (int axis = 0; axis < d; ++axis) offset[axis] = near.offset(axis, k);
          if (thin_->hides(point.mirror, free, add(point.mirror, offset),
                           thin_->particle_distance(static_cast<std::size_t>(near.particle(k))))) {
            sum -= with_mirrored(near.r2(k), across[k]);
            continue;
          }
        }
        fit.add(k);
      }
      kernel_sum = scale * sum;
    });
    if (kernel_sum < wet_wall_share || !seen) continue;
    const bool beside_void = !scene_.free_surface && scene_.motions.empty() && kernel_sum < full_wall_share;
    const bool before_wall = gap_before(point.foot, point.normal, sides_).has_value();
    const int least = before_wall ? least_order_before_wall : least_order;
    if (fit.fit(beside_void || before_wall ? most_moduli_beside_void : infinite) < least) continue;
    block.point.push_back(static_cast<std::int32_t>(g));
    fit.append(block.fits);
    if (scene_.bodies[body_[g]].wall == BoundaryKind::no_slip && !point.past_edge)
      fit.append_bend(subtract(point.position, point.mirror), block.fits);
  }
}

void BodyWalls::find_stencils(const Arrangement& arrangement, const VectorField& at, double particle_volume, double t,
                              double ahead) {
  const int d = scene_.domain.dimensions;
  std::vector<PointFits> fits(block_count(points_.size(), PointFits::block));
  std::vector<std::vector<std::int32_t>> wet_of(fits.size());
  parallel_blocks(points_.size(), PointFits::block, [&](std::size_t b, std::size_t first, std::size_t last) {
    Block block{wet_of[b], fits[b]};
    if (d == 3)
      fit_block<3>(arrangement, at, particle_volume, first, last, block);
    else
      fit_block<2>(arrangement, at, particle_volume, first, last, block);
  });
  stencils_.clear();
  append_points(fits, d, stencils_);
  const std::size_t wet = stencils_.size();
  wet_points_.clear();
  for (const auto& points : wet_of) wet_points_.insert(wet_points_.end(), points.begin(), points.end());
  for (int axis = 0; axis < d; ++axis) wet_position_[axis].resize(wet);
  parallel_for(wet, [&](std::size_t g) {
    const auto p = static_cast<std::size_t>(wet_points_[g]);
    stencils_.no_slip[g] = scene_.bodies[body_[p]].wall == BoundaryKind::no_slip ? 1 : 0;
    for (int axis = 0; axis < d; ++axis) {
      wet_position_[axis][g] = points_[p].position[axis];
      stencils_.normal[axis][g] = static_cast<float>(points_[p].normal[axis]);
    }
  });
  set_surfaces(t, ahead);
}

void BodyWalls::set_surfaces(double t, double ahead) {
  const int d = scene_.domain.dimensions;
  const std::size_t wet = stencils_.size();
  if (!surfaces_move_) {
    for (int axis = 0; axis < d; ++axis) stencils_.wall_velocity[axis].fill(0);
    return;
  }
  for (std::size_t m = 0; m < scene_.motions.size(); ++m) {
    if (scene_.motions[m].floats) continue;
    parts_[m + 1]->behind = given_place(scene_.motions[m], t);
    parts_[m + 1]->ahead = given_place(scene_.motions[m], ahead);
  }
  parallel_blocks(wet, 1024, [&](std::size_t, std::size_t first, std::size_t last) {
    // Expressions keep their variables inside: each block evaluates its own copies.
    std::vector<VectorExpression> velocity;
    for (const Body& body : scene_.bodies)
      velocity.push_back(body.velocity ? body.velocity->clone() : VectorExpression{});
    for (std::size_t g = first; g < last; ++g) {
      const auto p = static_cast<std::size_t>(wet_points_[g]);
      const std::size_t body = body_[p];
      const Vec3 u = scene_.bodies[body].motion ? part_of(body).velocity_behind(points_[p].foot)
                                                : velocity[body](points_[p].foot, t);
      for (int axis = 0; axis < d; ++axis) stencils_.wall_velocity[axis][g] = static_cast<float>(u[axis]);
    }
  });
  set_pressure_behind(ahead - t);
  largest_speed_ = std::sqrt(parallel_max(wet, 0.0, [&](std::size_t g) {
    double speed2 = 0;
    for (int axis = 0; axis < d; ++axis) {
      const double u = stencils_.wall_velocity[axis][g];
      speed2 += u * u;
    }
    return speed2;
  }));
  if (std::isfinite(largest_speed_)) return;
  StepFailure::Details details;
  details.cause = "the velocity of the surface of a body is not a finite number";
  details.option = scene_.motions.empty() ? "body.velocity" : "body.displacement";
  details.value = largest_speed_;
  throw StepFailure(details);
}

void BodyWalls::take_all_points(double t) {
  if (!scene_.motions.empty()) move_to(t);
  const std::size_t count = points_.size();
  stencils_.clear();
  stencils_.first.resize(count + 1);
  stencils_.first.fill(0);
  stencils_.nearest.resize(count);
  stencils_.nearest.fill(0);
  stencils_.no_slip.resize(count);
  wet_points_.resize(count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    stencils_.normal[axis].resize(count);
    stencils_.wall_velocity[axis].resize(count);
    wet_position_[axis].resize(count);
  }
  for (std::size_t g = 0; g < count; ++g) {
    wet_points_[g] = static_cast<std::int32_t>(g);
    stencils_.no_slip[g] = scene_.bodies[body_[g]].wall == BoundaryKind::no_slip ? 1 : 0;
  }
  place_wet_points(0);
  set_surfaces(t, t);
  set_acceleration(t);
}

void BodyWalls::follow_points(double t) {
  if (!surfaces_move_) return;
  for (std::size_t m = 0; m < scene_.motions.size(); ++m) parts_[m + 1]->place = given_place(scene_.motions[m], t);
  mark_bounds();
  parallel_for(origin_.size(), [&](std::size_t k) {
    const auto [part, number] = origin_[k];
    WallPoint& point = points_[standing_ + k];
    const Vec3 before = point.position;
    parts_[static_cast<std::size_t>(part)]->now(static_cast<std::size_t>(number), sides_, point);
    for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
      if (!scene_.domain.periodic(axis)) continue;
      // The copy of the body that the point was of.
      const double period = scene_.domain.upper[axis] - scene_.domain.lower[axis];
      const double shift = period * std::round((before[axis] - point.position[axis]) / period);
      for (Vec3* place : {&point.position, &point.foot, &point.mirror}) (*place)[axis] += shift;
    }
  });
  place_wet_points(standing_);
  set_surfaces(t, t);
  set_acceleration(t);
}

double BodyWalls::way_of_points(double from, double to) const {
  double farthest = 0;
  for (std::size_t m = 0; m < scene_.motions.size(); ++m) {
    const std::vector<WallPoint>& points = parts_[m + 1]->whole();
    double sum = 0;
    for (const auto& [before, after] : ways_between(scene_.motions[m], from, to)) {
      const auto way2 = [&, &before = before, &after = after](const Vec3& start) {
        const Vec3 way = subtract(after.now(start), before.now(start));
        return dot(way, way);
      };
      // Without a turn or growth all points go the same way.
      sum += std::sqrt(scene_.motions[m].turns() || before.scale != after.scale
                           ? parallel_max(points.size(), 0.0, [&](std::size_t g) { return way2(points[g].position); })
                           : way2(before.pivot));
    }
    farthest = std::max(farthest, sum);
  }
  return farthest;
}

void BodyWalls::place_wet_points(std::size_t from) {
  parallel_for(points_.size() - from, [&](std::size_t k) {
    const std::size_t g = from + k;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      wet_position_[axis][g] = points_[g].position[axis];
      stencils_.normal[axis][g] = static_cast<float>(points_[g].normal[axis]);
    }
  });
}

// By central differences of the velocities, over a time that is short for the motion and long for their rounding.
void BodyWalls::set_acceleration(double t) {
  constexpr double share_of_time_scale = 1e-4;
  if (scene_.motions.empty()) return;
  for (auto& component : acceleration_) {
    component.resize(points_.size());
    component.fill(0);
  }
  const auto duration = [](const BodyMotion& motion) { return share_of_time_scale * motion.time_scale; };
  for (std::size_t m = 0; m < scene_.motions.size(); ++m) {
    const BodyMotion& motion = scene_.motions[m];
    parts_[m + 1]->behind = given_place(motion, t - duration(motion));
    parts_[m + 1]->ahead = given_place(motion, t + duration(motion));
  }
  parallel_for(origin_.size(), [&](std::size_t k) {
    const RigidWalls& walls = *parts_[static_cast<std::size_t>(origin_[k][0])];
    const WallPoint& at = points_[standing_ + k];
    const Vec3 gained = subtract(walls.velocity_ahead(at.foot), walls.velocity_behind(at.foot));
    for (std::size_t axis = 0; axis < 3; ++axis)
      acceleration_[axis][standing_ + k] = gained[axis] / (2 * duration(*walls.motion()));
  });
  for (std::size_t m = 0; m < scene_.motions.size(); ++m)
    parts_[m + 1]->behind = parts_[m + 1]->ahead = parts_[m + 1]->place;
}

void BodyWalls::set_pressure_behind(double duration) {
  pressure_behind_.resize(scene_.motions.empty() || !(duration > 0) ? 0 : stencils_.size());
  parallel_for(pressure_behind_.size(), [&](std::size_t g) {
    const auto p = static_cast<std::size_t>(wet_points_[g]);
    pressure_behind_[g] = 0;
    if (!scene_.bodies[body_[p]].motion) return;
    const RigidWalls& walls = part_of(body_[p]);
    const WallPoint& at = points_[p];
    const Vec3 gained = subtract(walls.velocity_ahead(at.foot), walls.velocity_behind(at.foot));
    pressure_behind_[g] = dot(gained, subtract(at.mirror, at.position)) / duration;
  });
}

double BodyWalls::pressure_behind_unit(std::size_t wet_point, std::size_t motion, const Vec3& direction,
                                       bool turning) const {
  if (wet_point >= wet_points_.size()) return 0;  // of an opening
  const auto p = static_cast<std::size_t>(wet_points_[wet_point]);
  if (scene_.bodies[body_[p]].motion != motion) return 0;
  const WallPoint& at = points_[p];
  const Vec3 acceleration = turning ? cross(direction, part_of(body_[p]).arm_ahead(at.foot)) : direction;
  return dot(acceleration, subtract(at.mirror, at.position));
}

double BodyWalls::bytes() const {
  double sum = stencils_.bytes() + static_cast<double>(points_.capacity() * sizeof(WallPoint) + 2 * body_.capacity() +
                                                       4 * wet_points_.capacity());
  for (const auto& part : parts_) sum += part->bytes();
  if (thin_ != nullptr) sum += thin_->bytes();
  for (const auto& component : wet_position_) sum += component.bytes();
  return sum;
}

}  // namespace spume
