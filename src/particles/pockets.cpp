// SPDX-License-Identifier: MIT
#include "spume/particles/pockets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "spume/core/vectors.hpp"
#include "spume/geometry/way_to_wall.hpp"
#include "spume/particles/boundary.hpp"

namespace spume {
namespace {

// Of half a spacing, what a ball that fits keeps from the walls: two push it to and fro.
constexpr double fits = 0.8;
// Spacings: along a normal, and from a particle, what it takes.
constexpr double probes[] = {0.5, 1, 1.5}, taken = 0.8;
constexpr double pushed = 0.25;    // spacings, by walls back from where it was looked for
constexpr double parallel = 0.1;   // of the sum of two normals
constexpr double longest = 0.3;    // spacings, of a way out
constexpr double thinnest = 0.05;  // spacings, of a plate across a layer
constexpr double caught = 0.9;     // of the narrowest wedge, for the rounding of how far out of it places are led
// Spacings, and from a place in a slot to its mouth at most so many of these steps, which are halved so often.
// Particles go 0.4 in a step, spray 1.2. In slots of half a spacing rows that the start has placed rest, turned by 0.2
// degrees too.
constexpr double to_mouth_step = 0.1, room_for_rows = 0.4;
constexpr int to_mouth = 20, to_mouth_of_rows = 5;
constexpr int mouth_halvings = 10;
constexpr double of_same_face = 0.9;  // of the cosine of two normals

std::optional<WallBehind> wall_before(const Boundary& boundary, const Vec3& place) {
  const Domain& domain = boundary.domain();
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (std::size_t end = 0; end < 2; ++end) {
      const double inwards = end == 0 ? 1 : -1, behind = -inwards * (place[axis] - boundary.walls[axis][end]);
      if (!is_wall(domain.sides[axis][end].kind) || behind < 0) continue;
      WallBehind across{.behind = behind};
      across.normal[axis] = inwards;
      return across;
    }
  const double distance = boundary.bodies()->distance(place);
  if (distance > 0) return std::nullopt;
  return WallBehind{boundary.bodies()->normal(place), -distance, true, place};
}

// The middle of a ball of half a spacing that fits between the walls around a place.
std::optional<Vec3> room_at(const Boundary& boundary, Vec3 place) {
  const Domain& domain = boundary.domain();
  const double radius = 0.5 * boundary.spacing();
  const auto leave_sides = [&] {
    for (int axis = 0; axis < domain.dimensions; ++axis)
      for (std::size_t end = 0; end < 2; ++end) {
        if (!is_wall(domain.sides[axis][end].kind)) continue;
        const double inwards = end == 0 ? 1 : -1;
        place[axis] += inwards * std::max(0.0, radius - inwards * (place[axis] - boundary.walls[axis][end]));
      }
  };
  for (int round = 0; round < 2; ++round) {
    leave_sides();
    const double lack = radius - boundary.bodies()->distance(place);
    if (lack > 0) place = add(place, multiply(lack, boundary.bodies()->normal(place)));
  }
  leave_sides();
  if (boundary.bodies()->distance(place) > fits * radius) return place;
  return std::nullopt;
}

bool is_wall_point(const Arrangement& arrangement, std::int32_t point) {
  const auto n = static_cast<std::int32_t>(arrangement.list.particles());
  const std::int32_t* wall_point = arrangement.images.wall_point();
  return point >= n && wall_point != nullptr && wall_point[point - n] >= 0;
}

// Whether a particle, i itself or another, or an image of one is nearer to a place off particle i than `reach`.
bool stands_in(const Arrangement& arrangement, std::size_t i, const Vec3& way, double reach) {
  if (dot(way, way) < reach * reach) return true;
  const NeighbourList& list = arrangement.list;
  for (const std::int32_t j : list.of(i)) {
    if (is_wall_point(arrangement, j)) continue;
    double distance2 = 0;
    for (int axis = 0; axis < arrangement.grid.dimensions(); ++axis) {
      const double away = double{list.coordinate(axis)[j]} - double{list.coordinate(axis)[i]} - way[axis];
      distance2 += away * away;
    }
    if (distance2 < reach * reach) return true;
  }
  return false;
}

}  // namespace

bool has_room(const Boundary& boundary, const Vec3& place) {
  return room_at(boundary, place).has_value();
}

bool in_one_layer(const Boundary& boundary, const Vec3& place) {
  const BodyWalls& bodies = *boundary.bodies();
  const double width = 2 * boundary.spacing();
  if (bodies.surely_farther(place, width)) return false;
  const double before = bodies.distance(place);
  if (!(before < width) || bodies.moves_at(place)) return false;
  const Vec3 face = bodies.normal(place);
  std::optional<WallBehind> across;
  way_to_wall(
      place, multiply(width - before, face), thinnest * boundary.spacing(),
      [&](const Vec3& there) { return bodies.distance(there); },
      [&](const Vec3& there) { return (across = wall_before(boundary, there)).has_value(); });
  return across && dot(face, across->normal) < 0;
}

namespace {

// Between faces from which nothing is led out, for they are parallel, and that are nearer to each other than a layer.
bool is_caught(const Boundary& boundary, const Vec3& place) {
  const double width = boundary.spacing();
  if (!boundary.bodies()->nearer_than(place, width)) return false;
  const std::optional<WallBehind> across = wall_across(boundary, place, width);
  if (!across) return false;
  const bool leads_nowhere = length(add(boundary.bodies()->normal(place), across->normal)) < parallel;
  return leads_nowhere || across->behind > width - caught * narrowest_wedge * boundary.spacing();
}

}  // namespace

Ahead ahead_of(const Boundary& boundary, const Arrangement& arrangement, std::size_t i, const Vec3& place,
               const Vec3& normal) {
  const BodyWalls* bodies = boundary.bodies();
  if (bodies == nullptr || !bodies->nearer_than(place, arrangement.grid.support_radius())) return Ahead::room;
  const double size = length(normal), near = taken * boundary.spacing();
  if (!(size > 0) || (bodies->moves_at(place) && is_caught(boundary, place))) return Ahead::room;
  Ahead found = Ahead::liquid;
  for (const double distance : probes) {
    const Vec3 way = multiply(distance * boundary.spacing() / size, normal);
    const std::optional<Vec3> room = room_at(boundary, add(place, way));
    if (!room) {
      found = Ahead::pocket;
      continue;
    }
    const Vec3 to_room = subtract(*room, place);
    if (!stands_in(arrangement, i, to_room, near)) return Ahead::room;
    const bool pushed_back = length(to_room) < near && length(subtract(to_room, way)) > pushed * boundary.spacing();
    if (found == Ahead::liquid && pushed_back) found = Ahead::wall;
  }
  return found;
}

std::optional<WallBehind> wall_across(const Boundary& boundary, const Vec3& place, double width) {
  const BodyWalls& bodies = *boundary.bodies();
  const Vec3 face = bodies.normal(place), way = multiply(width - bodies.distance(place), face);
  std::optional<WallBehind> across = wall_before(boundary, add(place, way));
  if (!across) return across;
  if (across->of_body && bodies.distance(place) > 0) {
    // Behind an edge the nearest face may be another than the one that the way enters by.
    double in = 1, out = 0;
    for (int n = 0; n < mouth_halvings; ++n) {
      const double middle = 0.5 * (in + out);
      (bodies.distance(add(place, multiply(middle, way))) > 0 ? out : in) = middle;
    }
    const Vec3 entered = bodies.normal(add(place, multiply(out, way)));
    if (dot(entered, across->normal) < of_same_face) {
      across->normal = entered;
      across->behind = -(1 - in) * dot(way, entered);
    }
  }
  if (!(dot(face, across->normal) < 0)) across.reset();
  return across;
}

namespace {

// Whether walls leave a place free, and it is in no wedge.
bool is_out(const Boundary& boundary, const Vec3& place) {
  const double least = narrowest_wedge * boundary.spacing();
  return !wall_before(boundary, place) &&
         (boundary.bodies()->surely_farther(place, least) || !(boundary.bodies()->distance(place) < least) ||
          !wall_across(boundary, place, least));
}

// Whether what is led out of a wedge has come into it from its narrow end, past an edge: from before the foot of the
// place on the face, where no wedge leads the same way.
// What a body that moves has come over since has not: bodies stand where the way ends.
bool comes_through(const Boundary& boundary, Vec3 from, const Vec3& foot, const Vec3& outwards) {
  if (!(dot(boundary.domain().shortest(subtract(from, foot)), outwards) < 0)) return false;
  from = boundary.domain().inside(from);
  const double least = narrowest_wedge * boundary.spacing();
  const BodyWalls& bodies = *boundary.bodies();
  const double before = bodies.distance(from);
  if (!(before > 0)) return false;
  if (!(before < least)) return true;
  const std::optional<WallBehind> across = wall_across(boundary, from, least);
  return !across || dot(add(bodies.normal(from), across->normal), outwards) < 0;
}

// From a place between parallel faces along them to where the slot ends, in the nearest of two (of eight) directions.
std::optional<Vec3> way_to_mouth(const Boundary& boundary, const Vec3& place, const Vec3& face, int farthest) {
  const bool deep = boundary.domain().dimensions == 3;
  const Vec3 least = std::abs(face[0]) < std::abs(face[1]) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 first = deep ? unit(cross(face, least)) : Vec3{-face[1], face[0], 0};
  const Vec3 second = deep ? cross(face, first) : Vec3{};
  const int directions = deep ? 8 : 2;
  const auto is_mouth = [&](const Vec3& way) { return is_out(boundary, boundary.domain().inside(add(place, way))); };
  for (int step = 1; step <= farthest; ++step)
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions;
      const Vec3 along = add(multiply(std::cos(angle), first), multiply(std::sin(angle), second));
      double out = step * to_mouth_step * boundary.spacing();
      if (!is_mouth(multiply(out, along))) continue;
      double in = out - to_mouth_step * boundary.spacing();
      for (int n = 0; n < mouth_halvings; ++n) {
        const double middle = 0.5 * (in + out);
        (is_mouth(multiply(middle, along)) ? out : in) = middle;
      }
      return multiply(out, along);
    }
  return std::nullopt;
}

}  // namespace

void lead_out_of_wedges(const Boundary& boundary, Vec3& place, Vec3* velocity, const Vec3* from) {
  const BodyWalls& bodies = *boundary.bodies();
  const double least = narrowest_wedge * boundary.spacing();
  if (bodies.surely_farther(place, least)) return;
  const double before = bodies.distance(place);
  if (!(before < least)) return;
  const Vec3 face = bodies.normal(place);
  const std::optional<WallBehind> across = wall_across(boundary, place, least);
  if (!across) return;
  Vec3 outwards = add(face, across->normal);
  double size = length(outwards);
  Vec3 way{};
  if (size < parallel) {
    const bool holds_rows = least - across->behind > room_for_rows * boundary.spacing();
    const std::optional<Vec3> out = way_to_mouth(boundary, place, face, holds_rows ? to_mouth_of_rows : to_mouth);
    if (!out) return;
    way = outwards = *out;
    size = length(outwards);
  } else if (from != nullptr && comes_through(boundary, *from, subtract(place, multiply(before, face)), outwards)) {
    way = outwards = boundary.domain().shortest(subtract(*from, place));
    size = length(outwards);
    if (!(size > 0)) return;
  } else {
    // The distances from the two grow by |outwards| together along their bisector.
    way = multiply(std::min(across->behind / size, longest * boundary.spacing()) / size, outwards);
  }
  Vec3 of_walls{};
  if (velocity != nullptr) {
    of_walls = bodies.wall_within(place, least)->velocity;
    if (across->of_body) of_walls = add(of_walls, bodies.wall_within(across->place, 0)->velocity);
    of_walls = multiply(0.5, of_walls);
  }
  place = add(place, way);
  if (velocity == nullptr) return;
  const double inwards = dot(subtract(*velocity, of_walls), outwards) / (size * size);
  if (inwards < 0) *velocity = subtract(*velocity, multiply(inwards, outwards));
}

}  // namespace spume
