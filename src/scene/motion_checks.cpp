// SPDX-License-Identifier: MIT
#include "motion_checks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "bodies.hpp"
#include "checks.hpp"
#include "spume/core/vectors.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

constexpr int times = 33;                 // at which a run is looked at, with its start and its end
constexpr std::size_t most_places = 200;  // of a surface
constexpr double of_sound_speed = 0.5;    // what a weakly compressible liquid may reach at all
constexpr double pressed = 1e-3;          // of the volume: more than rounding, less than a particle of a thousand
const char* const why_too_fast = ", more than half the sound speed ";

double time_of(const Draft& draft, int n) {
  return draft.options.time.end * n / (times - 1);
}

// Some points of the surface of a body where it stands at the start, within the domain and half of its size around it.
std::vector<Vec3> places_on(const Body& body, const Scene& scene) {
  Bounds window{scene.domain.lower, scene.domain.upper};
  for (int axis = 0; axis < scene.domain.dimensions; ++axis) {
    const double margin = (window.upper[axis] - window.lower[axis]) / 2;
    window.lower[axis] -= margin;
    window.upper[axis] += margin;
  }
  const ShapePointer& solid = body.alone ? body.alone : body.solid;
  const std::vector<Vec3> all = solid->surface(window, scene.spacing).points;
  std::vector<Vec3> some;
  const std::size_t stride = 1 + all.size() / most_places;
  for (std::size_t i = 0; i < all.size(); i += stride) {
    // Where the window cuts the solid there is no surface.
    if (std::abs(solid->distance(all[i])) < 0.1 * scene.spacing) some.push_back(all[i]);
  }
  return some;
}

class Speeds {
 public:
  Speeds(const Draft& draft, const Scene& scene, Problems& problems)
      : draft_(draft), scene_(scene), problems_(problems), most_(of_sound_speed * scene.fluid.sound_speed) {}

  void check() {
    for (std::size_t k = 0; k < draft_.bodies.size(); ++k) body(k);
    for (int axis = 0; axis < scene_.domain.dimensions; ++axis)
      for (int end = 0; end < 2; ++end) side(axis, end);
    for (const Opening& opening : scene_.openings)
      if (opening.inflow && opening.velocity) inflow(opening);
  }

 private:
  // True once there is one that is too fast.
  bool too_fast(const Node& node, const std::string& what, double speed, double t, const std::string& how) {
    if (speed <= most_) return false;
    problems_.add(node, what + " with " + brief(speed) + " at t = " + brief(t) + why_too_fast +
                            brief(scene_.fluid.sound_speed) + "; " + how + ", or raise the sound speed");
    return true;
  }

  void body(std::size_t k) {
    const Body& body = scene_.bodies[k];
    const bool slides = body.velocity && body.wall == BoundaryKind::no_slip;
    const bool moves = body.motion && !scene_.motions[*body.motion].floats;
    if (body.wall == BoundaryKind::open || (!slides && !moves)) return;
    const std::vector<Vec3> places = places_on(body, scene_);
    const Node& node = *draft_.node("body." + std::to_string(k));
    for (int n = 0; n < times; ++n) {
      const double t = time_of(draft_, n);
      const RigidPlace place = moves ? given_place(scene_.motions[*body.motion], t) : RigidPlace{};
      double speed = 0;
      for (const Vec3& at : places)
        speed = std::max(speed, length(moves ? place.velocity_at(place.now(at)) : (*body.velocity)(at, t)));
      if (too_fast(node, "the surface of the body '" + body.name + "' moves", speed, t, "slow it down")) return;
    }
  }

  void side(int axis, int end) {
    const Side& side = scene_.domain.sides[axis][end];
    const std::string name = side_names(axis, scene_.domain.dimensions)[static_cast<std::size_t>(end)];
    const Node* node =
        draft_.node("domain.wall_velocity." + name);  // else a wavemaker moves it, which has its own check
    if (!side.velocity || node == nullptr) return;
    Vec3 middle = multiply(0.5, add(scene_.domain.lower, scene_.domain.upper));
    middle[static_cast<std::size_t>(axis)] = (end == 0 ? scene_.domain.lower : scene_.domain.upper)[axis];
    for (int n = 0; n < times; ++n) {
      Vec3 velocity = (*side.velocity)(middle, time_of(draft_, n));
      if (side.kind != BoundaryKind::no_slip)
        for (int other = 0; other < 3; ++other)
          if (other != axis) velocity[static_cast<std::size_t>(other)] = 0;
      if (too_fast(*node, "domain.wall_velocity." + name + " moves the middle of its wall", length(velocity),
                   time_of(draft_, n), "slow it down"))
        return;
    }
  }

  void inflow(const Opening& opening) {
    const Node* given = draft_.node(opening.name + ".velocity");
    const Node& node = given != nullptr ? *given : *draft_.node(opening.name);
    Vec3 middle = multiply(0.5, add(opening.lower, opening.upper));
    middle[static_cast<std::size_t>(opening.axis)] =
        (opening.side == 0 ? scene_.domain.lower : scene_.domain.upper)[opening.axis];
    for (int n = 0; n < times; ++n)
      if (too_fast(node, opening.name + " lets liquid enter", length((*opening.velocity)(middle, time_of(draft_, n))),
                   time_of(draft_, n), "let it enter more slowly"))
        return;
  }

  const Draft& draft_;
  const Scene& scene_;
  Problems& problems_;
  double most_;
};

// By Simpson's rule between the times of a run: what sides that move along their normals make of the domain.
void check_pressing(const Draft& draft, const Scene& scene, Problems& problems) {
  const Domain& domain = scene.domain;
  Vec3 lower = domain.lower, upper = domain.upper;
  const Vec3 middle = multiply(0.5, add(lower, upper));
  std::string moved;
  const auto volume = [&] {
    double product = 1;
    for (int axis = 0; axis < domain.dimensions; ++axis) product *= upper[axis] - lower[axis];
    return product;
  };
  const double whole = volume();
  for (int n = 0; n + 1 < times; ++n) {
    const double t = time_of(draft, n), dt = time_of(draft, n + 1) - t;
    for (int axis = 0; axis < domain.dimensions; ++axis)
      for (int end = 0; end < 2; ++end) {
        const auto& velocity = domain.sides[axis][end].velocity;
        if (!velocity || velocity->component[static_cast<std::size_t>(axis)] == nullptr) continue;
        const auto speed = [&](double at) { return (*velocity)(middle, at)[axis]; };
        const double way = dt / 6 * (speed(t) + 4 * speed(t + dt / 2) + speed(t + dt));
        if (way != 0 && moved.empty()) moved = side_names(axis, domain.dimensions)[static_cast<std::size_t>(end)];
        (end == 0 ? lower : upper)[axis] += way;
      }
    const double change = volume() / whole - 1;
    if (std::abs(change) <= pressed) continue;
    const Node* node = draft.node("domain.wall_velocity." + moved);
    for (std::size_t k = 0; k < draft.wavemakers.size() && node == nullptr; ++k)
      node = draft.node("wavemaker." + std::to_string(k));
    if (node == nullptr) return;
    problems.add(*node, "the " + moved + " wall changes the volume of a tank that is full and closed by " +
                            brief(100 * change) + " % until t = " + brief(t + dt) +
                            ", and its liquid is incompressible; leave room above the liquid, open a side, move "
                            "walls that keep the volume, or give the liquid a sound speed");
    return;
  }
}

// How far outwards a side of the domain comes, by Simpson's rule between the times of a run.
double way_outwards(const Draft& draft, const Domain& domain, int axis, int end) {
  const auto& velocity = domain.sides[axis][end].velocity;
  if (!velocity || velocity->component[static_cast<std::size_t>(axis)] == nullptr) return 0;
  const Vec3 middle = multiply(0.5, add(domain.lower, domain.upper));
  const auto speed = [&](double at) { return (end == 0 ? -1 : 1) * (*velocity)(middle, at)[axis]; };
  double way = 0, farthest = 0;
  constexpr int steps = 4096;  // of which a period takes many
  const double dt = draft.options.time.end / steps;
  for (int n = 0; n < steps; ++n) {
    const double t = n * dt;
    way += dt / 6 * (speed(t) + 4 * speed(t + dt / 2) + speed(t + dt));
    farthest = std::max(farthest, way);
  }
  return farthest;
}

// Whether a body lies beyond a side where that comes to, between the other sides, and leaves some of it free: asked on
// planes across the way, at places a spacing apart.
bool is_bared(const Scene& scene, const Body& body, int axis, int end, double way) {
  const Domain& domain = scene.domain;
  std::array<std::size_t, 3> count{1, 1, 1};
  for (int other = 0; other < domain.dimensions; ++other)
    if (other != axis)
      count[static_cast<std::size_t>(other)] =
          static_cast<std::size_t>(std::ceil((domain.upper[other] - domain.lower[other]) / scene.spacing));
  bool solid = false, free = false;
  for (const double share : {0.1, 0.5, 1.0})
    for (std::size_t n = 0; n < count[0] * count[1] * count[2]; ++n) {
      const std::array<std::size_t, 3> at{n % count[0], n / count[0] % count[1], n / count[0] / count[1]};
      Vec3 place{};
      for (int other = 0; other < domain.dimensions; ++other)
        place[other] =
            domain.lower[other] + scene.spacing * (static_cast<double>(at[static_cast<std::size_t>(other)]) + 0.5);
      place[axis] = end == 0 ? domain.lower[axis] - share * way : domain.upper[axis] + share * way;
      (body.solid->inside(place) ? solid : free) = true;
    }
  return solid && free;
}

// Bodies at rest have wall points as far as the domain at the start, those that move have them all around.
void warn_of_bared_bodies(const Draft& draft, const Scene& scene, const std::string& file,
                          std::vector<Problem>& warnings) {
  const Domain& domain = scene.domain;
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (int end = 0; end < 2; ++end) {
      const double way = way_outwards(draft, domain, axis, end);
      if (!(way > scene.spacing / 2)) continue;
      for (std::size_t k = 0; k < draft.bodies.size(); ++k) {
        const Body& body = scene.bodies[k];
        if (body.motion || body.wall == BoundaryKind::open || body.subtract) continue;
        if (!is_bared(scene, body, axis, end, way)) continue;
        const Node& node = *draft.node("body." + std::to_string(k));
        warnings.push_back({file, node.place.line, node.place.column,
                            "the " + side_names(axis, domain.dimensions)[static_cast<std::size_t>(end)] +
                                " wall moves off by " + brief(way) + " and bares the body '" + body.name +
                                "', which as a body at rest holds the liquid in the domain of the start alone; add  "
                                "displacement = [\"0*t\", " +
                                (domain.dimensions == 3 ? "\"0\", " : "") + "\"0\"]  to it"});
      }
    }
}

bool full_and_closed(const Scene& scene) {
  if (scene.free_surface || !scene.openings.empty()) return false;
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    for (const Side& side : scene.domain.sides[axis])
      if (!side.bounds_liquid()) return false;
  return true;
}

}  // namespace

void check_motions(const Draft& draft, const Scene& scene, bool incompressible, Problems& problems) {
  if (scene.fluid.sound_speed > 0) {
    Speeds(draft, scene, problems).check();
    return;
  }
  if (!incompressible || !full_and_closed(scene)) return;
  check_pressing(draft, scene, problems);
  for (std::size_t k = 0; k < draft.wavemakers.size(); ++k)
    if (draft.wavemakers[k].kind == WavemakerKind::flap)
      problems.add(*draft.node("wavemaker." + std::to_string(k)),
                   "the flap would press a tank that is full and closed, and its liquid is incompressible; leave room "
                   "above the liquid, or open a side");
}

void check_sliding_walls(const Draft& draft, const Scene& scene, const std::string& method, Problems& problems) {
  const std::string takes = "; method \"" + method + "\" takes walls that slide along themselves: ";
  const Domain& domain = scene.domain;
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (std::size_t end = 0; end < 2; ++end) {
      const auto& velocity = domain.sides[axis][end].velocity;
      const Node* node = draft.node("domain.wall_velocity." + side_names(axis, domain.dimensions)[end]);
      if (node != nullptr && velocity && velocity->component[static_cast<std::size_t>(axis)] != nullptr)
        problems.add(*node, "the wall moves along its normal" + takes + "set that component to \"0\"");
    }
  for (std::size_t k = 0; k < draft.wavemakers.size(); ++k)
    if (draft.wavemakers[k].kind == WavemakerKind::piston)
      problems.add(*draft.node("wavemaker." + std::to_string(k)),
                   "a piston is a wall that moves along its normal" + takes + "write it as a [[body]] that moves");
}

std::vector<Problem> collision_warnings(const Draft& draft, const Scene& scene, const std::string& file) {
  std::vector<Problem> warnings;
  warn_of_bared_bodies(draft, scene, file, warnings);
  const double deep = scene.spacing / 2;
  const Domain& domain = scene.domain;
  std::vector<std::optional<std::vector<Vec3>>> found_places(scene.bodies.size());
  const auto places_of = [&](std::size_t k) -> const std::vector<Vec3>& {
    if (!found_places[k]) found_places[k] = places_on(scene.bodies[k], scene);
    return *found_places[k];
  };
  for (std::size_t k = 0; k < draft.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    if (!body.motion || body.wall == BoundaryKind::open) continue;
    const BodyMotion& motion = scene.motions[*body.motion];
    if (motion.floats || motion.release || !body.inside) continue;
    const std::vector<Vec3>& places = places_of(k);
    // What it goes into at time t: 2 axis + end of a side, 6 + j of body j. What it is in at the start is meant.
    const auto in_at = [&](double t) {
      std::vector<std::size_t> found;
      const RigidPlace place = given_place(motion, t);
      for (int axis = 0; axis < domain.dimensions; ++axis)
        for (int end = 0; end < 2; ++end) {
          if (domain.sides[axis][end].kind == BoundaryKind::periodic || !domain.sides[axis][end].bounds_liquid() ||
              domain.sides[axis][end].velocity)
            continue;
          const double plane = (end == 0 ? domain.lower : domain.upper)[axis];
          if (std::any_of(places.begin(), places.end(), [&](const Vec3& at) {
                const double x = place.now(at)[axis];
                return end == 0 ? x < plane - deep : x > plane + deep;
              }))
            found.push_back(static_cast<std::size_t>(2 * axis + end));
        }
      for (std::size_t j = 0; j < scene.bodies.size(); ++j) {
        const Body& other = scene.bodies[j];
        if (j == k || node_of_body(draft, scene, j) == nullptr || other.wall == BoundaryKind::open || other.subtract ||
            other.motion == body.motion)
          continue;
        if (other.motion && (scene.motions[*other.motion].floats || scene.motions[*other.motion].release)) continue;
        const RigidPlace theirs = other.motion ? given_place(scene.motions[*other.motion], t) : RigidPlace{};
        // A small body may go into the middle of a face: places of both are looked at.
        const Shape& own = *(body.alone ? body.alone : body.solid);
        const std::vector<Vec3>& their_places = places_of(j);
        if (std::any_of(places.begin(), places.end(),
                        [&](const Vec3& at) { return other.solid->distance(theirs.start(place.now(at))) < -deep; }) ||
            std::any_of(their_places.begin(), their_places.end(),
                        [&](const Vec3& at) { return own.distance(place.start(theirs.now(at))) < -deep; }))
          found.push_back(6 + j);
      }
      return found;
    };
    std::vector<std::size_t> known = in_at(0);
    for (int n = 1; n < times; ++n)
      for (const std::size_t what : in_at(time_of(draft, n))) {
        if (std::find(known.begin(), known.end(), what) != known.end()) continue;
        known.push_back(what);
        const Node& node = *draft.node("body." + std::to_string(k));
        const std::string whom =
            what >= 6 ? "into the body '" + scene.bodies[what - 6].name + "'"
                      : "through the " + side_names(static_cast<int>(what / 2), domain.dimensions)[what % 2] + " wall";
        warnings.push_back({file, node.place.line, node.place.column,
                            "the body '" + body.name + "' moves " + whom + " before t = " + brief(time_of(draft, n)) +
                                "; given motions know no contact, and liquid between the two is pressed out: shorten "
                                "the way, end the run before, or let the body float"});
      }
  }
  return warnings;
}

}  // namespace spume
