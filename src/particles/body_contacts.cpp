// SPDX-License-Identifier: MIT
#include "spume/particles/body_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/convex_corners.hpp"

namespace spume {
namespace {

// Spacings: what lies deeper in the walls, or farther from them, is no part of their surface.
constexpr double touching = 1e-3;
// Mean of the normals around a point within a flat face: they turn by less than 1e-5, as over half a spacing of a ball
// of 50,000. Places of facets are bisected to 1e-12, and facets as short as 1e-6 turn by 1e-6 of that.
constexpr double flat = 1 - 1e-11;
// Of the sine between a direction and the axis of a cylinder: along it an end reaches farther.
constexpr double least_across = 0.1;

// Of a sphere that moves as its body does, what reaches farthest along a direction; of a cylinder as far along its axis
// as a place. None where the direction leads along that.
std::optional<Vec3> farthest_of(const FittedSphere& sphere, const RigidPlace& place, const Vec3& direction,
                                const Vec3& at) {
  Vec3 centre = place.now(sphere.centre), way = direction;
  if (dot(sphere.along, sphere.along) > 0) {
    const Vec3 axis = place.direction_now(sphere.along);
    way = subtract(way, multiply(dot(axis, way), axis));
    const double size = length(way);
    if (size < least_across) return std::nullopt;
    way = multiply(1 / size, way);
    centre = add(centre, multiply(dot(axis, subtract(at, centre)), axis));
  }
  return add(centre, multiply(place.scale * sphere.radius, way));
}

// Spacings around a point that a sphere is fitted to: at least two rows of nodes on all sides.
constexpr double fitted_reach = 1.5;

}  // namespace

BodyContacts::BodyContacts(const Scene& scene, const Resolution& resolution, const BodyWalls& walls)
    : scene_(scene),
      resolution_(resolution),
      walls_(walls),
      parts_(walls.parts()),
      others_(parts_ + 6),
      radius_(parts_, 0) {
  gather_points();
  set_clearances();
}

void BodyContacts::gather_points() {
  const int dimensions = scene_.domain.dimensions;
  const auto corners = static_cast<std::size_t>(dimensions);
  std::vector<Vec3> facing;  // of each point, the mean of the normals of its pieces
  for (const Body& body : scene_.bodies) {
    if (body.wall == BoundaryKind::open) continue;
    const std::size_t part = body.motion ? *body.motion + 1 : 0;
    const std::vector<SurfacePiece> pieces = surface_pieces(scene_.domain, body, resolution_.spacing);
    // Facets of what an expression gives are off its distances by as much as these are.
    const double off = std::max(touching * resolution_.spacing, body.shape->error());
    const bool faceted = off > touching * resolution_.spacing;
    std::map<Vec3, std::pair<Vec3, int>> normals;
    for (const SurfacePiece& piece : pieces)
      for (std::size_t k = 0; k < corners && length(piece.area) > 0; ++k) {
        auto& [sum, count] = normals[piece.corner[k]];
        sum = add(sum, unit(piece.area, dimensions));
        ++count;
      }
    std::set<Vec3> known;
    const std::size_t first = points_.size();
    for (const SurfacePiece& piece : pieces)
      for (std::size_t k = 0; k < corners; ++k) {
        const Vec3& corner = piece.corner[k];
        if (!known.insert(corner).second) continue;
        if (std::abs(walls_of(part).exact_distance(corner)) > off) continue;
        const auto& [sum, count] = normals[corner];
        const Vec3 mean = multiply(1.0 / std::max(count, 1), sum);
        // A flat face reaches no farther than its corners do; what stands still has them asked for no other place.
        if ((faceted || part == 0) && length(mean) >= flat) continue;
        points_.push_back({corner, part, {}, faceted});
        facing.push_back(mean);
        if (part > 0) radius_[part] = std::max(radius_[part], length(subtract(corner, scene_.motions[part - 1].pivot)));
      }
    if (faceted && part > 0) fit_spheres(pieces, first, facing);
  }
  parallel_for(points_.size(), [&](std::size_t p) {
    Point& point = points_[p];
    if (point.part == 0 || point.faceted) return;
    point.corner = convex_corner(walls_of(point.part), point.start, facing[p], resolution_.spacing, dimensions);
  });
}

// Facets end anywhere between the nodes: two of them may be 1e-6 spacings long, and tell an edge from a round surface
// together with those around alone.
void BodyContacts::fit_spheres(const std::vector<SurfacePiece>& pieces, std::size_t first,
                               const std::vector<Vec3>& facing) {
  const auto corners = static_cast<std::size_t>(scene_.domain.dimensions);
  std::map<Vec3, std::size_t> number;
  std::vector<Vec3> place;
  std::vector<std::set<std::size_t>> beside;
  const auto number_of = [&](const Vec3& at) {
    const auto [entry, fresh] = number.try_emplace(at, place.size());
    if (fresh) {
      place.push_back(at);
      beside.emplace_back();
    }
    return entry->second;
  };
  for (const SurfacePiece& piece : pieces)
    for (std::size_t k = 0; k < corners; ++k)
      for (std::size_t j = 0; j < k; ++j) {
        const std::size_t a = number_of(piece.corner[k]), b = number_of(piece.corner[j]);
        if (a == b) continue;
        beside[a].insert(b);
        beside[b].insert(a);
      }
  parallel_for(points_.size() - first, [&](std::size_t n) {
    Point& point = points_[first + n];
    const std::size_t own = number.at(point.start);
    const auto away = [&](std::size_t other) { return length(subtract(place[other], point.start)); };
    for (const std::size_t next : beside[own]) point.longest_side = std::max(point.longest_side, away(next));
    const double reach = std::max(fitted_reach * resolution_.spacing, 2 * point.longest_side);
    std::vector<std::size_t> found{own};
    for (std::size_t k = 0; k < found.size(); ++k)
      for (const std::size_t next : beside[found[k]])
        if (away(next) <= reach && std::find(found.begin(), found.end(), next) == found.end()) found.push_back(next);
    std::vector<Vec3> around;
    for (std::size_t k = 1; k < found.size(); ++k) around.push_back(place[found[k]]);
    point.round = fitted_sphere(point.start, facing[first + n], around, scene_.domain.dimensions);
    if (!point.round && scene_.domain.dimensions == 3)
      point.round = fitted_cylinder(point.start, facing[first + n], around);
    // More than a sixth of the circle to a side: few places tell it from an edge.
    if (point.round && point.round->radius < point.longest_side) point.round.reset();
  });
}

// Of those that start nearer to each other than a spacing what they start with. A distance from what an expression
// gives is off by its error: what lies on it may seem to be in it by that.
void BodyContacts::set_clearances() {
  const double spacing = resolution_.spacing;
  clearance_.assign(parts_ * others_, spacing);
  Sides sides{};
  for (int axis = 0; axis < 3; ++axis) sides[axis] = {scene_.domain.lower[axis], scene_.domain.upper[axis]};
  for (const Point& point : points_)
    for (std::size_t other = 0; other < others_; ++other) {
      if (!may_touch(point.part, other)) continue;
      const double start = distance(other, sides, point.start, spacing);
      const double off = other < parts_ ? walls_of(other).error_near(point.start, spacing) : 0;
      double& own = clearance(point.part, other);
      if (start < -touching * spacing - off) own = passes_through;
      if (own > passes_through) own = std::min(own, std::max(-off, start));
    }
  for (std::size_t a = 0; a < parts_; ++a)
    for (std::size_t b = 0; b < a; ++b) clearance(a, b) = clearance(b, a) = std::min(clearance(a, b), clearance(b, a));
}

bool BodyContacts::overlaps_at_start(std::size_t motion) const {
  for (std::size_t other = 0; other < others_; ++other)
    if (clearance(motion + 1, other) == passes_through) return true;
  return false;
}

Vec3 BodyContacts::now(const Point& point) const {
  return point.part == 0 ? point.start : walls_of(point.part).place.now(point.start);
}

std::optional<BodyContacts::Place> BodyContacts::place_towards(const Point& point, const Vec3& at, const Vec3& towards,
                                                               std::size_t other) const {
  // Of a round body the point is one of a polygon: off the place that touches, its force would turn the body.
  if (point.round) {
    const RigidPlace& place = walls_of(point.part).place;
    const std::optional<Vec3> foremost = farthest_of(*point.round, place, towards, at);
    if (!foremost || length(subtract(*foremost, at)) > place.scale * point.longest_side) return std::nullopt;
    return Place{*foremost, false};
  }
  // Seen from far away interpolated distances lead to places 0.06 spacings off the surface, which come and go as the
  // body turns: a block hopped on a floor with 0.05 m/s. Corners of facets are on the surface.
  if (point.faceted) return Place{at, true};
  const std::optional<Vec3> foremost =
      walls_of(point.part).foremost(at, towards, radius_[point.part], resolution_.spacing);
  const std::optional<Vec3> turning = may_come_foremost(point, at, towards, foremost, other);
  if (turning) return Place{*turning, true};
  if (foremost) return Place{*foremost, false};
  return std::nullopt;
}

Vec3 BodyContacts::through_centre(const Point& point, const Place& place, const Vec3& normal) const {
  const Vec3 towards = multiply(-1, normal);
  if (point.round) return farthest_of(*point.round, walls_of(point.part).place, towards, place.at).value_or(place.at);
  if (place.turning || point.faceted) return place.at;
  return walls_of(point.part).foremost(place.at, towards, radius_[point.part], resolution_.spacing).value_or(place.at);
}

// A body that is turned until an edge just becomes the one that reaches farthest, and 0.1 rad on, has its foremost
// place there where the edge leads no farther on: a rim has it between the points asked.
std::optional<Vec3> BodyContacts::may_come_foremost(const Point& point, const Vec3& at, const Vec3& towards,
                                                    const std::optional<Vec3>& foremost, std::size_t other) const {
  const double spacing = resolution_.spacing;
  if (point.corner.kind == ConvexCorner::Kind::none) return std::nullopt;
  if (point.corner.kind == ConvexCorner::Kind::corner) {
    if (foremost && length(subtract(*foremost, at)) <= touching * spacing) return std::nullopt;
    return at;
  }
  if (foremost) return std::nullopt;
  if (other < parts_) return at;  // edges meet crosswise wherever they lead
  const RigidWalls& walls = walls_of(point.part);
  const Vec3 slide = subtract(walls.nearest(add(at, multiply(spacing, towards))).point, at),
             along = walls.place.direction_now(point.corner.along),
             across = subtract(slide, multiply(dot(slide, along), along));
  // Turned by more than 45 degrees a right edge stands nearer to its other face.
  const double turn = length(across) / spacing;
  if (turn < touching || turn > std::sqrt(0.5)) return std::nullopt;
  const Vec3 turned = subtract(multiply(spacing, towards), multiply(1 + 0.1 / turn, across));
  return walls.foremost(at, unit(turned), radius_[point.part], spacing);
}

Vec3 BodyContacts::turning_acceleration(std::size_t part, const Vec3& at) const {
  const RigidPlace& place = floats(part) ? walls_of(part).place : walls_of(part).ahead;
  const Vec3& spin = place.angular_velocity;
  return cross(spin, cross(spin, subtract(at, place.position)));
}

double BodyContacts::restitution(std::size_t part) const {
  return floats(part) ? scene_.motions[part - 1].restitution : 1;
}

double BodyContacts::largest_speed_of(std::size_t part) const {
  if (part == 0 || part >= parts_) return 0;
  const RigidPlace& place = floats(part) ? walls_of(part).place : walls_of(part).ahead;
  return length(place.velocity) + length(place.angular_velocity) * radius_[part];
}

double BodyContacts::distance(std::size_t other, const Sides& sides, const Vec3& at, double reach) const {
  if (other >= parts_) {
    const std::size_t axis = (other - parts_) / 2, side = (other - parts_) % 2;
    return side == 0 ? at[axis] - sides[axis][0] : sides[axis][1] - at[axis];
  }
  const Vec3 seen = in_domain(other, at);
  return walls_of(other).surely_farther(seen, reach) ? infinite : walls_of(other).distance(seen);
}

Vec3 BodyContacts::normal(std::size_t other, const Vec3& at) const {
  if (other < parts_) return walls_of(other).nearest(in_domain(other, at)).normal;
  Vec3 normal{};
  normal[(other - parts_) / 2] = (other - parts_) % 2 == 0 ? 1 : -1;
  return normal;
}

// What stands still is known in the domain.
Vec3 BodyContacts::in_domain(std::size_t other, Vec3 at) const {
  return other == 0 ? scene_.domain.inside(at) : at;
}

bool BodyContacts::may_touch(std::size_t part, std::size_t other) const {
  if (other >= parts_) {
    const auto axis = static_cast<int>((other - parts_) / 2), side = static_cast<int>((other - parts_) % 2);
    return floats(part) && axis < scene_.domain.dimensions && is_wall(scene_.domain.sides[axis][side].kind);
  }
  return other != part && !walls_of(other).empty() && (floats(part) || floats(other));
}

std::vector<BodyContact> BodyContacts::find(const Surroundings& surroundings, double dt) const {
  constexpr std::size_t block = 1024;
  const Domain& domain = scene_.domain;
  std::array<Vec3, 6> side_velocity{};
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto& velocity = domain.sides[axis][side].velocity;
      if (!velocity || velocity->component[static_cast<std::size_t>(axis)] == nullptr) continue;
      Vec3 centre = multiply(0.5, add(domain.lower, domain.upper));
      centre[axis] = surroundings.walls[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
      side_velocity[static_cast<std::size_t>(2 * axis + side)] = (*velocity)(centre, surroundings.ahead);
      if (axis == 0)
        side_velocity[static_cast<std::size_t>(side)][0] += surroundings.absorption[static_cast<std::size_t>(side)];
    }
  std::vector<double> speed(parts_);
  for (std::size_t part = 0; part < parts_; ++part) speed[part] = largest_speed_of(part);
  std::vector<std::vector<BodyContact>> of(block_count(points_.size(), block));
  parallel_blocks(points_.size(), block, [&](std::size_t b, std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const std::size_t part = points_[p].part;
      for (std::size_t other = 0; other < others_; ++other) {
        const double kept = clearance(part, other);
        if (kept == passes_through || !may_touch(part, other)) continue;
        const double other_speed = other < parts_ ? speed[other] : length(side_velocity[other - parts_]);
        const double reach = kept + resolution_.spacing + dt * (speed[part] + other_speed);
        BodyContact contact;
        contact.point = now(points_[p]);
        double away = distance(other, surroundings.walls, contact.point, reach);
        if (away >= reach) continue;
        contact.normal = normal(other, contact.point);
        if (part > 0) {
          const std::optional<Place> place =
              place_towards(points_[p], contact.point, multiply(-1, contact.normal), other);
          if (!place) continue;
          contact.point = place->at;
          away = distance(other, surroundings.walls, contact.point, infinite);
          contact.normal = normal(other, contact.point);
          contact.point = through_centre(points_[p], *place, contact.normal);
          if (place->turning) away += dt * dt / 2 * dot(contact.normal, turning_acceleration(part, contact.point));
        }
        contact.key = {static_cast<std::int64_t>(p), static_cast<std::int64_t>(other)};
        contact.clearance = kept;
        contact.room = away - kept;
        contact.restitution = restitution(part);
        const auto given = [&](std::size_t of_part) {
          return of_part == 0 ? 0.0 : dot(contact.normal, walls_of(of_part).velocity_ahead(contact.point));
        };
        if (floats(part))
          contact.of_point = part - 1;
        else
          contact.given_speed += given(part);
        if (other >= parts_) {
          contact.given_speed -= dot(contact.normal, side_velocity[other - parts_]);
        } else if (floats(other)) {
          contact.of_other = other - 1;
          contact.restitution = std::min(contact.restitution, restitution(other));
        } else {
          contact.given_speed -= given(other);
        }
        of[b].push_back(contact);
      }
    }
  });
  std::vector<BodyContact> found;
  for (const auto& own : of) found.insert(found.end(), own.begin(), own.end());
  return found;
}

}  // namespace spume
