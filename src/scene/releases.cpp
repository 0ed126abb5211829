// SPDX-License-Identifier: MIT
#include "releases.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "checks.hpp"
#include "spume/core/vectors.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

constexpr std::size_t most_copies = 10000;

// Every copy is back when its turn comes again.
std::size_t copies_of(const BodyDraft& body) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(*body.release_duration / *body.release_interval - 1e-9)));
}

bool is_released(const BodyDraft& body) {
  return body.release_interval && body.release_duration;
}

// The least distance of the liquid at the start from a solid that stands beside its own place by `way`, as far as it is
// within `reach`; else `reach`.
double nearest_liquid(const Scene& scene, const Shape& solid, const Vec3& way, double reach) {
  const InitialParticles& particles = scene.particles;
  const Bounds box = solid.bounds();
  double least = reach;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Vec3 place{};
    bool near = true;
    for (std::size_t a = 0; a < static_cast<std::size_t>(scene.domain.dimensions) && near; ++a) {
      place[a] = particles.position[a][i] - way[a];
      if (scene.domain.periodic(static_cast<int>(a))) {
        // The copy of the particle that is nearest to the solid.
        const double period = scene.domain.upper[a] - scene.domain.lower[a];
        place[a] -= period * std::round((place[a] - (box.lower[a] + box.upper[a]) / 2) / period);
      }
      near = place[a] > box.lower[a] - reach && place[a] < box.upper[a] + reach;
    }
    if (near) least = std::min(least, solid.distance(place));
  }
  return least;
}

// Whether some particle is within `reach` of the surface of a body there.
bool meets_liquid(const Scene& scene, const Shape& shape, const RigidPlace& place, double reach) {
  const InitialParticles& particles = scene.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Vec3 r{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(scene.domain.dimensions); ++a) {
      r[a] = particles.position[a][i];
      if (scene.domain.periodic(static_cast<int>(a))) {
        const double period = scene.domain.upper[a] - scene.domain.lower[a];
        r[a] -= period * std::round((r[a] - place.position[a]) / period);
      }
    }
    if (place.scale * shape.distance(place.start(r)) < reach) return true;
  }
  return false;
}

double least_half_width(const Shape& solid, int dimensions) {
  const Bounds box = solid.bounds();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
    least = std::min(least, (box.upper[a] - box.lower[a]) / 2);
  return least;
}

}  // namespace

void check_release(const Draft& draft, std::size_t k, bool floats, Problems& problems) {
  const std::string name = "body." + std::to_string(k);
  const BodyDraft& body = draft.bodies[k];
  const Node* first = nullptr;
  for (const char* key :
       {"release_interval", "release_duration", "release_delay", "release_growth", "release_shrinkage"})
    if (const Node* node = draft.node(name + "." + key); node != nullptr && first == nullptr) first = node;
  if (first == nullptr) return;
  if (floats) {
    problems.add_key(*first, name +
                                 " floats, and bodies are released on a given way alone; give displacement in place "
                                 "of mass or density, or remove the release");
    return;
  }
  if (!draft.node(name + ".release_interval") || !draft.node(name + ".release_duration"))
    problems.add_key(*first, name +
                                 " is released and one key is missing; give  release_interval = <number>  and  "
                                 "release_duration = <number>  # time, > 0");
  for (const BodyDraft& other : draft.bodies)
    if (!body.name.empty() && other.moves_with == body.name) {
      problems.add_key(*first, name + " is released again and again, and '" + other.name +
                                   "' moves with it; bodies are released one by one: remove moves_with");
      return;
    }
  const double growth = body.release_growth.value_or(0), shrinkage = body.release_shrinkage.value_or(0);
  if (!body.inside && growth + shrinkage > 0)
    problems.add_key(*first, name + " is all that lies outside its shape, which cannot grow; remove " +
                                 (growth > 0 ? "release_growth" : "release_shrinkage") + ", or inside = false");
  if (!is_released(body) || !draft.usable(name + ".release_interval") || !draft.usable(name + ".release_duration"))
    return;
  if (growth + shrinkage > *body.release_duration)
    problems.add_key(*first, name + " grows for " + brief(growth) + " and shrinks for " + brief(shrinkage) +
                                 ", and is on its way for " + brief(*body.release_duration) +
                                 "; lengthen release_duration to their sum at least");
  if (const double copies = *body.release_duration / *body.release_interval; copies > most_copies)
    problems.add_key(*first, name + " has " + brief(copies) + " copies on their way at a time; at most " +
                                 std::to_string(most_copies) +
                                 " are possible: shorten release_duration or lengthen "
                                 "release_interval");
}

void add_released(const Draft& draft, std::vector<Body>& bodies, std::vector<BodyMotion>& motions, Problems& problems) {
  for (std::size_t k = 0; k < draft.bodies.size(); ++k) {
    const BodyDraft& given = draft.bodies[k];
    if (!bodies[k].motion || !is_released(given)) continue;
    const std::size_t copies = copies_of(given), own = *bodies[k].motion;
    if (copies > most_copies) return;
    const double delay = given.release_delay.value_or(0), cycle = static_cast<double>(copies) * *given.release_interval;
    motions[own].time_scale = *given.release_duration;
    motions[own].release = Release{.first = delay,
                                   .cycle = cycle,
                                   .duration = *given.release_duration,
                                   .growth = given.release_growth.value_or(0),
                                   .shrinkage = given.release_shrinkage.value_or(0),
                                   .copies = copies};
    for (std::size_t copy = 1; copy < copies; ++copy) {
      BodyMotion motion = motions[own];
      motion.bodies = {bodies.size()};
      motion.release->copy = copy;
      motion.release->first = delay + static_cast<double>(copy) * *given.release_interval;
      motions.push_back(std::move(motion));
      bodies.push_back({.name = bodies[k].name + "." + std::to_string(copy),
                        .kind = bodies[k].kind,
                        .shape = bodies[k].shape,
                        .solid = bodies[k].solid,
                        .inside = bodies[k].inside,
                        .subtract = false,
                        .wall = bodies[k].wall,
                        .velocity = std::nullopt,
                        .motion = motions.size() - 1,
                        .alone = bodies[k].alone});
    }
  }
  if (constexpr std::size_t most_bodies = 65535; bodies.size() > most_bodies)
    problems.add(*draft.node("body.0"), "the case has " + std::to_string(bodies.size()) +
                                            " bodies with the copies that are released; at most " +
                                            std::to_string(most_bodies) + " are possible");
}

namespace {

// On the way of a body that is released, at one of fifty places.
bool meets_liquid_on_its_way(const Scene& scene, const Body& body, double reach) {
  const BodyMotion& motion = scene.motions[*body.motion];
  constexpr int places = 50;
  for (int n = 0; n < places; ++n) {
    const double share = (n + 0.5) / places;
    const RigidPlace place = given_place(motion, motion.release->first + share * motion.release->duration);
    if (place.scale > 0 && meets_liquid(scene, *body.alone, place, reach)) return true;
  }
  return false;
}

// What enters may come to bodies that meet nothing of what is there at the start.
bool has_inflow(const Scene& scene) {
  return std::any_of(scene.openings.begin(), scene.openings.end(), [](const Opening& each) { return each.inflow; });
}

}  // namespace

void check_released_ways(const Draft& draft, const Scene& scene, Problems& problems) {
  const double reach = support_ratio(draft.options.resolution) * scene.spacing;
  if (has_inflow(scene)) return;
  for (std::size_t k = 0; k < draft.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    if (!body.motion || !scene.motions[*body.motion].release || meets_liquid_on_its_way(scene, body, reach)) continue;
    problems.add_key(*draft.node("body." + std::to_string(k) + ".release_interval"),
                     "the body '" + body.name +
                         "' is released, and nowhere on its way is liquid within the kernel support " + brief(reach) +
                         " of it; set its position below the surface, or remove it");
  }
}

std::vector<Problem> release_warnings(const Draft& draft, const Scene& scene, const std::string& file) {
  std::vector<Problem> warnings;
  // What is said of several bodies is said once: an array of orifices has many that are alike.
  std::map<std::string, std::pair<std::size_t, std::string>> said;
  const double reach = support_ratio(draft.options.resolution) * scene.spacing;
  for (std::size_t k = 0; k < draft.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    if (!body.motion || !scene.motions[*body.motion].release) continue;
    const BodyMotion& motion = scene.motions[*body.motion];
    const Node& node = *draft.node("body." + std::to_string(k) + ".release_interval");
    const auto warn = [&](const std::string& text) {
      const auto [before, is_new] = said.try_emplace(text, warnings.size(), "");
      if (is_new)
        warnings.push_back({file, node.key_place.line, node.key_place.column, "the body '" + body.name + "' " + text});
      else
        before->second.second += ", '" + body.name + "'";
    };
    if (has_inflow(scene) && !meets_liquid_on_its_way(scene, body, reach))
      warn("meets no liquid on its way as that stands at t = 0: it does nothing until what enters has come within " +
           brief(reach) + " of it");
    if (motion.release->grows() && !scene.free_surface && scene.openings.empty())
      warn(
          "grows, and nothing takes what it displaces: the domain is full and closed; leave a free surface, or remove "
          "release_growth");
    // With less than 6 spacings from the middle to the nearest face, liquids lost between 2 % of what a body displaces
    // (ellipses, 2-D, explicit) and half of it with each release (an egg of 2 spacings, 3-D, projection).
    constexpr double few = 6;
    if (const double half = least_half_width(*body.alone, scene.domain.dimensions) / scene.spacing;
        motion.release->grows() && half < few)
      warn("is " + brief(half) +
           " spacings from its middle to its nearest face: one that grows may displace less than half of its volume "
           "below " +
           brief(few) +
           ", and the liquid may lose volume with each; lower resolution.spacing, or watch the level of the liquid");
    if (const RigidPlace at = given_place(motion, motion.release->first);
        motion.release->growth > 0 &&
        nearest_liquid(scene, *body.alone, subtract(at.position, at.pivot), reach) == reach)
      warn("grows where no liquid is within the kernel support " + brief(reach) +
           " of it at t = 0, and displaces nothing as it does; set its position below the surface, or remove "
           "release_growth");
    const double start = motion.release->growth > 0 ? reach : nearest_liquid(scene, *body.alone, Vec3{}, reach);
    if (start < reach)
      warn("appears " + (start < 0 ? "in the liquid" : brief(start) + " from the liquid") +
           ", which it then pushes away at once; let it grow, by release_growth, or start farther away than the kernel "
           "support " +
           brief(reach) + ", as behind a wall");
    const RigidPlace end = given_place(motion, motion.release->first + (1 - 1e-9) * motion.release->duration);
    const double last = nearest_liquid(scene, *body.alone, subtract(end.position, end.pivot), reach);
    if (last < reach && motion.release->shrinkage == 0)
      warn("is taken away " + (last < 0 ? "in the liquid" : brief(last) + " from the liquid") +
           " as that stands at t = 0, "
           "and leaves a hole; let it shrink, by release_shrinkage, or its way end farther away than the kernel "
           "support " +
           brief(reach) + ", as above the surface, by release_duration");
  }
  for (const auto& [text, others] : said)
    if (!others.second.empty()) warnings[others.first].text += "; the same holds for " + others.second.substr(2);
  return warnings;
}

}  // namespace spume
