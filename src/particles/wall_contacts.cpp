// SPDX-License-Identifier: MIT
#include "spume/particles/wall_contacts.hpp"

#include <cmath>
#include <optional>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/pockets.hpp"

namespace spume {
namespace {

// Of a way to a contact: 2^-16 of a tenth of a spacing is below the gap of 1e-3 spacings that walls keep.
constexpr int halvings = 16;
// Of a place that walls have led out of a wedge to where they are the narrowest apart, for the rounding of that.
constexpr double across = 1.05 * narrowest_wedge;

// By how much walls put a place back; round periodic sides it stays.
Vec3 put_back(const Boundary& boundary, const Vec3& place) {
  const Vec3 inside = boundary.domain().inside(place);
  Vec3 held = inside;
  boundary.hold_liquid(boundary.walls, held, nullptr);
  return boundary.domain().shortest(subtract(held, inside));
}

// Whether a body may hold what is there: by its wall, or out of a wedge beside it.
bool beside_body_at_rest(const Boundary& boundary, const Vec3& place) {
  const BodyWalls& bodies = *boundary.bodies();
  return bodies.nearer_than(place, narrowest_wedge * boundary.spacing()) &&
         !(boundary.features.displaced_bodies && bodies.moves_at(place));
}

// The wall that holds a particle together with the nearest wall of a body: across a wedge, or the side that it lies on.
std::optional<WallBehind> other_wall(const Boundary& boundary, const Vec3& place, const Vec3& outwards) {
  if (std::optional<WallBehind> found = wall_across(boundary, place, across * boundary.spacing())) return found;
  const Domain& domain = boundary.domain();
  WallBehind side;
  double most = 0;
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (std::size_t end = 0; end < 2; ++end) {
      const double inwards = end == 0 ? 1 : -1;
      const double before = inwards * (place[axis] - boundary.walls[axis][end]), along = inwards * outwards[axis];
      if (!is_wall(domain.sides[axis][end].kind) || before > across * boundary.spacing() || !(along > most)) continue;
      most = along;
      side.normal = {};
      side.normal[axis] = inwards;
    }
  return most > 0 ? std::optional(side) : std::nullopt;
}

}  // namespace

Vec3 direction_of_contact(const Boundary& boundary, const Vec3& place, const Vec3& way) {
  const Vec3 end = boundary.domain().inside(add(place, way));
  if (!beside_body_at_rest(boundary, end)) return {};
  const Vec3 back = put_back(boundary, end);
  const double size = length(back);
  return size > 0 ? multiply(1 / size, back) : Vec3{};
}

WayToContact go_to_contact(const Boundary& boundary, const Vec3& place, const Vec3& way) {
  WayToContact found;
  const Vec3 free = add(place, way), back = put_back(boundary, free);
  found.end = add(free, back);
  if (back == Vec3{} || boundary.bodies() == nullptr || !beside_body_at_rest(boundary, boundary.domain().inside(free)))
    return found;
  Vec3 blocked = free;
  for (int n = 0; n < halvings; ++n) {
    const Vec3 middle = multiply(0.5, add(found.end, blocked));
    (put_back(boundary, middle) == Vec3{} ? found.end : blocked) = middle;
  }
  const Vec3 last = put_back(boundary, blocked);
  found.outwards = multiply(1 / length(last), last);
  return found;
}

// Of a force along `outwards` on the particle, which the walls hold at `place`: each of two walls pushes along its
// normal, and together they make the force.
void WallContacts::share(const Vec3& place, const Vec3& outwards, double force, std::vector<Borne>& borne) const {
  const BodyWalls& bodies = *boundary_.bodies();
  const auto push = [&](const BodyWalls::NearestWall& wall, const Vec3& away) {
    borne.push_back({wall.body, bodies.whole_place(wall.body, wall.point), away});
  };
  const BodyWalls::NearestWall near = bodies.nearest_wall(place);
  const double along = dot(outwards, near.normal);
  const std::optional<WallBehind> other = other_wall(boundary_, place, outwards);
  double own = along, others = 0;
  if (other) {
    const double both = dot(near.normal, other->normal), along_other = dot(outwards, other->normal);
    own = (along - both * along_other) / (1 - both * both);
    others = (along_other - both * along) / (1 - both * both);
    if (!(own > 0)) own = 0, others = along_other;
    if (!(others > 0)) own = along, others = 0;
  }
  if (own > 0) push(near, multiply(-force * own, near.normal));
  if (others > 0 && other->of_body) push(bodies.nearest_wall(other->place), multiply(-force * others, other->normal));
}

void WallContacts::bear(const std::vector<std::int32_t>& near, const Liquid& liquid) {
  const ParticleStore& particles = liquid.particles;
  const int d = particles.dimensions;
  found_.assign(block_count(near.size(), default_block), {});
  parallel_blocks(near.size(), default_block, [&](std::size_t block, std::size_t first, std::size_t last) {
    for (std::size_t m = first; m < last; ++m) {
      const auto i = static_cast<std::size_t>(near[m]);
      const Vec3 place = vector_at(particles.position, d, i), a = vector_at(liquid.acceleration, d, i),
                 u = vector_at(particles.velocity, d, i);
      const Vec3 way = multiply(liquid.dt, add(u, multiply(liquid.dt / 2, a)));
      const Vec3 outwards = direction_of_contact(boundary_, place, way);
      const double into = dot(a, outwards);
      if (!(into < 0)) continue;
      for (int axis = 0; axis < d; ++axis) {
        (*liquid.acceleration[axis])[i] = static_cast<float>(a[axis] - into * outwards[axis]);
        (*particles.velocity[axis])[i] -= liquid.dt / 2 * into * outwards[axis];
      }
      const Vec3 end = boundary_.domain().inside(add(place, way));
      share(boundary_.domain().inside(add(end, put_back(boundary_, end))), outwards,
            -into * particles.volume * liquid.law(i).density, found_[block]);
    }
  });
}

void WallContacts::add_to_bodies(std::vector<SurfaceForce>& forces) const {
  for (const auto& block : found_)
    for (const Borne& borne : block) forces[borne.body].press(borne.foot, borne.force);
}

}  // namespace spume
