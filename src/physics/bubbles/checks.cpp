// SPDX-License-Identifier: MIT
// What the bubbles of a case must satisfy: gas and liquid, radii against the spacing, sources inside the liquid.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "draft.hpp"
#include "spume/core/parallel.hpp"
#include "spume/physics/bubbles/forces.hpp"
#include "spume/physics/bubbles/options.hpp"
#include "spume/physics/bubbles/population.hpp"
#include "spume/physics/turbulence/options.hpp"
#include "spume/scene/expression.hpp"

namespace spume {
namespace {

constexpr double most_bubbles = most_bubbles_of_a_cloud;

// The largest spacing-based radius: a bubble must be smaller than the filter that surrounds it (King section 3.4.1).
void check_sizes(const Draft& draft, const std::string& name, BubbleSizes& sizes, Problems& problems) {
  const double spacing = draft.options.spacing;
  if (!draft.usable(name + ".bubble_radius") || !(spacing > 0)) return;
  const auto node_of = [&](const char* key) -> const Node& {
    const Node* node = draft.node(name + "." + key);
    return node ? *node : *draft.node(name);
  };
  const auto too_large = [&](const char* key, double radius) {
    problems.add(node_of(key), name + "." + key + " = " + brief(radius) + " is larger than the spacing, " +
                                   brief(spacing) +
                                   ": the liquid around such a bubble cannot be taken as uniform; set " +
                                   "resolution.spacing >= " + brief(radius) + " or smaller bubbles");
  };
  if (sizes.mean > spacing * (1 + 1e-12)) return too_large("bubble_radius", sizes.mean);
  if (sizes.law == SizeLaw::monodisperse) {
    sizes.minimum = sizes.maximum = sizes.mean;
    return;
  }
  if (!(sizes.deviation > 0) && draft.usable(name + ".deviation"))
    problems.add(node_of("deviation"),
                 name + ".deviation must be positive for this law of sizes; or set sizes = \"monodisperse\"");
  if (!draft.node(name + ".smallest")) sizes.minimum = sizes.mean / 10;
  if (!draft.node(name + ".largest")) sizes.maximum = spacing;
  if (sizes.maximum > spacing * (1 + 1e-12)) return too_large("largest", sizes.maximum);
  if (sizes.minimum >= sizes.maximum || sizes.minimum > sizes.mean || sizes.maximum < sizes.mean)
    problems.add(node_of("smallest"), name + ": the radii must satisfy smallest <= bubble_radius <= largest, found " +
                                          brief(sizes.minimum) + ", " + brief(sizes.mean) + ", " +
                                          brief(sizes.maximum));
}

bool three_entries(const Draft& draft, const std::string& name, const std::vector<double>& values, Problems& problems) {
  const Node* node = draft.node(name);
  if (!node || !draft.usable(name)) return false;
  if (values.size() == 3) return true;
  problems.add(*node, name + " must have 3 entries in a 3-D domain, found " + std::to_string(values.size()));
  return false;
}

// Of the gas that a source releases by the end, the least that is in the liquid at once: below a free surface that of
// the time in which its bubbles rise by themselves from the bottom to the top of the liquid.
double share_in_liquid(const Draft& draft, const Scene& scene, const Sparger& sparger) {
  const double end = draft.options.time.end;
  const bubbles::Gas gas{.density_ratio = draft.options.get<BubbleOptions>().density_ratio,
                         .viscosity = scene.fluid.kinematic_viscosity,
                         .gravity = scene.fluid.gravity};
  double gravity2 = 0;
  for (const double g : gas.gravity) gravity2 += g * g;
  if (!scene.free_surface || !(gravity2 > 0) || !(gas.viscosity > 0) || !(gas.density_ratio > 1)) return 1;
  const auto [lowest, highest] =
      std::minmax_element(scene.particles.position[2].begin(), scene.particles.position[2].end());
  if (lowest == scene.particles.position[2].end()) return 1;
  const double rise = (*highest - *lowest + scene.spacing) / bubbles::terminal_speed(gas, sparger.sizes.mean);
  return std::min(1.0, rise / end);
}

bool inside(const Draft& draft, const std::string& name, const std::vector<double>& values, Problems& problems) {
  if (!three_entries(draft, name, values, problems) || draft.dimensions != 3) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    const double slack = 1e-9 * (draft.upper[a] - draft.lower[a]);
    if (values[a] >= draft.lower[a] - slack && values[a] <= draft.upper[a] + slack) continue;
    problems.add(*draft.node(name), name + " lies outside the domain: " + "xyz"[a] + std::string(" = ") +
                                        brief(values[a]) + ", the domain runs from " + brief(draft.lower[a]) + " to " +
                                        brief(draft.upper[a]));
    return false;
  }
  return true;
}

void add_missing_tension(const Draft& draft, const std::string& decides, Problems& problems) {
  const std::string key = uses_si(draft.fluid) ? "surface_tension" : "weber";
  problems.add(*draft.node("bubbles"), "missing key '" + key + "' in [bubbles]: surface tension decides " + decides +
                                           "; add  " + key + " = <number>  # > 0");
}

void check_gas(Draft& draft, Problems& problems) {
  BubbleDraft& given = bubbles_of(draft);
  BubbleOptions& options = draft.options.get<BubbleOptions>();
  const bool si = uses_si(draft.fluid);
  const auto wrong_set = [&](const char* key, const char* instead) {
    if (const Node* node = draft.node(std::string("bubbles.") + key))
      problems.add_key(*node, std::string("bubbles.") + key +
                                  " belongs to the other set of units: [fluid] is given in " + (si ? "SI" : "groups") +
                                  "; give " + instead);
  };
  wrong_set(si ? "weber" : "surface_tension", si ? "surface_tension" : "weber");
  if (!si) wrong_set("gas_density", "density_ratio");
  const double density = draft.fluid.density.value_or(1);
  if (!si && given.weber) options.tension = 1 / *given.weber;
  if (si && given.surface_tension) options.tension = *given.surface_tension / density;
  options.density_ratio =
      given.density_ratio.value_or(si ? density / given.gas_density.value_or(air_density) : options.density_ratio);
  const Node* ratio = draft.node(given.density_ratio ? "bubbles.density_ratio" : "bubbles.gas_density");
  if (ratio != nullptr && options.density_ratio < 1)
    problems.add(*ratio, "the gas is " + brief(1 / options.density_ratio) +
                             " times as dense as the liquid; bubbles.density_ratio is the density of the liquid over "
                             "that of the gas, bubbles.gas_density that of the gas");
  options.hinze_radius = given.hinze_radius.value_or(std::pow(options.tension, 0.6) / 2);
  options.smallest_entrained_radius = given.smallest_entrained_radius.value_or(options.hinze_radius / 20);

  const char* key = si ? "surface_tension" : "weber";
  const double spacing = draft.options.spacing;
  if (options.entrainment && spacing > 0 && options.tension > 0 && !(options.smallest_entrained_radius < spacing)) {
    const Node* own = draft.node("bubbles.smallest_entrained_radius");
    const Node* cause =
        own ? own : draft.node(given.hinze_radius ? "bubbles.hinze_radius" : std::string("bubbles.") + key);
    problems.add(*cause, "bubbles.smallest_entrained_radius = " + brief(options.smallest_entrained_radius) +
                             (own ? "" : ", which follows from this,") + " is not below the spacing, " +
                             brief(spacing) + ", up to which bubbles are entrained: set resolution.spacing > " +
                             brief(options.smallest_entrained_radius) + " or a smaller smallest_entrained_radius");
  }
  const std::string needed = options.entrainment ? "entrainment" : options.breakup ? "breakup" : "";
  if (options.tension == 0 && draft.usable(std::string("bubbles.") + key) && !needed.empty())
    add_missing_tension(draft, needed, problems);
  const bool inviscid = si ? draft.fluid.viscosity.value_or(0) == 0 : !draft.fluid.reynolds;
  if (inviscid && draft.usable("fluid.reynolds") && draft.usable("fluid.viscosity"))
    problems.add(*draft.node("bubbles"), std::string("bubbles need a viscous liquid, their drag depends on it; add  ") +
                                             (si ? "fluid.viscosity" : "fluid.reynolds") + " = <number>");
  for (const char* model : {"entrainment", "breakup", "fluctuations"}) {
    const bool on = std::string(model) == "entrainment" ? options.entrainment
                    : std::string(model) == "breakup"   ? options.breakup
                                                        : options.fluctuations;
    if (on && draft.options.get<TurbulenceOptions>().model == TurbulenceModel::none &&
        draft.node("bubbles." + std::string(model)))
      problems.add(*draft.node("bubbles." + std::string(model)),
                   std::string("bubbles.") + model + " uses the unresolved turbulence of the liquid; set " +
                       "turbulence.model = \"mixed-scale\", or " + model + " = false");
  }
}

// Explicit sub-steps follow the fastest motion of the smallest bubble, so that small bubbles take hours a step.
void check_substeps(const Draft& draft, const Scene& scene, const std::string& name, const BubbleSizes& sizes,
                    Problems& problems) {
  const BubbleOptions& options = draft.options.get<BubbleOptions>();
  if (options.integrator != BubbleIntegrator::substep || !(sizes.minimum > 0)) return;
  // Some 50 ns each: 5 ms per bubble and step.
  constexpr double most_substeps = 1e5;
  double gravity2 = 0;
  for (const double g : scene.fluid.gravity) gravity2 += g * g;
  const double h = draft.options.resolution.smoothing_ratio * scene.spacing;
  const double dt = gravity2 > 0 ? draft.options.time.courant * std::sqrt(h / std::sqrt(gravity2)) : 0;
  const double drag = bubbles::drag_rate(0, sizes.minimum, scene.fluid.kinematic_viscosity);
  const double steps =
      std::max(scene.spacing / sizes.minimum, bubbles::substeps_per_relaxation * dt * drag /
                                                  (1 / options.density_ratio + options.virtual_mass_coefficient));
  if (steps <= most_substeps) return;
  problems.add(*draft.node(name), name + " has bubbles of radius " + brief(sizes.minimum) + ", which need " +
                                      brief(steps) + " explicit sub-steps a step; at most " + brief(most_substeps) +
                                      " are possible: set bubbles.integrator = \"stable\" or enlarge them");
}

// Places that tell how far a source reaches: around a disc, along a line, on the sides of a box and around a ball.
std::vector<Vec3> outline(const Sparger& sparger) {
  std::vector<Vec3> places;
  constexpr int points = 16;  // a disc of ten spacings is looked at every two
  for (int k = 0; k < points && sparger.shape != SpargerShape::point; ++k) {
    Vec3 r = sparger.position;
    const double share = (k + 0.5) / points, angle = 2 * std::numbers::pi * share;
    if (sparger.shape == SpargerShape::disc) {
      r[0] += sparger.radius * std::cos(angle);
      r[1] += sparger.radius * std::sin(angle);
    } else {
      for (std::size_t a = 0; a < 3; ++a) r[a] += share * (sparger.end[a] - sparger.position[a]);
    }
    places.push_back(r);
  }
  return places;
}

// The first place of a source that lies in a wall of a body. A disc is looked at on rings, a quarter of it apart.
std::optional<Vec3> first_in_solid(const Scene& scene, const Sparger& sparger) {
  if (scene.walls.empty()) return {};
  std::vector<Vec3> places = {sparger.position};
  if (sparger.shape == SpargerShape::line) places.push_back(sparger.end);
  constexpr int rings = 4;
  for (int ring = 1; ring <= rings; ++ring) {
    Sparger part = sparger;
    if (sparger.shape == SpargerShape::disc) part.radius *= static_cast<double>(ring) / rings;
    for (const Vec3& r : outline(part)) places.push_back(r);
  }
  const auto found = std::find_if(places.begin(), places.end(), [&](const Vec3& r) { return scene.walls.inside(r); });
  return found == places.end() ? std::optional<Vec3>() : std::optional<Vec3>(*found);
}

// In words, the wall that a place lies in.
std::string body_at(const Scene& scene, const Vec3& place) {
  for (const Body& body : scene.bodies)
    if (body.wall != BoundaryKind::open && !body.subtract && body.solid->inside(place))
      return body.name.empty() ? "the wall of a body, a " + body.kind : "the body \"" + body.name + "\"";
  return "a body";
}

std::vector<Vec3> outline(const BubbleCloud& cloud) {
  std::vector<Vec3> places;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int l = -1; l <= 1; ++l) {
        const std::array<int, 3> side{i, j, l};
        const double length = std::max(1.0, std::sqrt(i * i + j * j + l * l));
        Vec3 r;
        for (std::size_t a = 0; a < 3; ++a)
          r[a] = cloud.ball ? cloud.centre[a] + cloud.radius * side[a] / length
                            : 0.5 * (cloud.lower[a] + cloud.upper[a] + side[a] * (cloud.upper[a] - cloud.lower[a]));
        places.push_back(r);
      }
  return places;
}

}  // namespace

void check_bubbles(Draft& draft, Problems& problems) {
  const Node* section = draft.node("bubbles");
  draft.options.get<BubbleOptions>().on = section != nullptr;
  for (const char* source : {"sparger", "bubble_cloud"})
    if (const Node* node = draft.node(source); node && !section)
      problems.add_key(*node, std::string("[[") + source + "]] makes bubbles; add a section [bubbles]");
  if (!section) return;
  if (draft.dimensions == 2) {
    problems.add(*section,
                 "bubbles are spheres and need a 3-D domain; give lower and upper three entries, or remove "
                 "[bubbles]");
    return;
  }
  check_gas(draft, problems);

  for (std::size_t k = 0; k < bubbles_of(draft).spargers.size(); ++k) {
    SpargerDraft& sparger = bubbles_of(draft).spargers[k];
    const std::string name = "sparger." + std::to_string(k);
    inside(draft, name + ".position", sparger.position, problems);
    const auto missing = [&](const char* key, const char* shape) {
      if (!draft.node(name + "." + key))
        problems.add(*draft.node(name), std::string("missing key '") + key + "' in [[sparger]], which is a " + shape +
                                            "; add  " + key + (key[0] == 'e' ? " = [<x>, <y>, <z>]" : " = <number>") +
                                            "  # length");
    };
    if (sparger.sparger.shape == SpargerShape::disc) missing("radius", "disc");
    if (sparger.sparger.shape == SpargerShape::line) missing("end", "line");
    if (draft.node(name + ".end")) inside(draft, name + ".end", sparger.end, problems);
    check_sizes(draft, name, sparger.sparger.sizes, problems);
  }
  for (std::size_t k = 0; k < bubbles_of(draft).clouds.size(); ++k) {
    BubbleCloudDraft& cloud = bubbles_of(draft).clouds[k];
    const std::string name = "bubble_cloud." + std::to_string(k);
    for (const auto& [key, values] :
         {std::pair{"lower", &cloud.lower}, {"upper", &cloud.upper}, {"centre", &cloud.centre}})
      if (draft.node(name + "." + key)) inside(draft, name + "." + key, *values, problems);
    if (cloud.lower.size() == 3 && cloud.upper.size() == 3)
      for (std::size_t a = 0; a < 3; ++a)
        if (!(cloud.lower[a] <= cloud.upper[a])) {
          problems.add(*draft.node(name + ".upper"), name + ".upper must not lie below " + name + ".lower");
          break;
        }
    check_sizes(draft, name, cloud.cloud.sizes, problems);
  }
}

void check_bubble_sources(const Draft& draft, const Scene& scene, Problems& problems) {
  const BubbleOptions& gas_options = draft.options.get<BubbleOptions>();
  if (gas_options.on && gas_options.surface_interaction && scene.free_surface && gas_options.tension == 0)
    add_missing_tension(draft, "how long bubbles rest at the surface (surface_interaction)", problems);
  const InitialParticles& liquid = scene.particles;
  const double volume = liquid.volume * static_cast<double>(liquid.size());
  // Wet: some particle within the diagonal of a lattice cell, sqrt(3) spacings.
  const auto wet = [&](Vec3 r) {
    const double diagonal = 1.75 * scene.spacing;
    r = scene.domain.inside(r);
    return parallel_max(liquid.size(), 0.0, [&](std::size_t i) {
             double distance2 = 0;
             for (int a = 0; a < 3; ++a) {
               const double d = liquid.position[a][i] - r[a];
               distance2 += d * d;
             }
             return distance2 < diagonal * diagonal ? 1.0 : 0.0;
           }) > 0;
  };
  // The first of the places that lies in no liquid.
  const auto first_dry = [&](const std::vector<Vec3>& places) {
    const auto dry = std::find_if(places.begin(), places.end(), [&](const Vec3& r) { return !wet(r); });
    return dry == places.end() ? std::optional<Vec3>() : std::optional<Vec3>(*dry);
  };
  const auto reaches_out = [](const std::string& name, const Vec3& r) {
    return name + " reaches out of the liquid: there is none at (" + brief(r[0]) + ", " + brief(r[1]) + ", " +
           brief(r[2]) + "); keep all of it below the surface";
  };
  const BubbleSources& sources = draft.options.get<BubbleSources>();
  for (std::size_t k = 0; k < sources.spargers.size(); ++k) {
    const Sparger& sparger = sources.spargers[k];
    const std::string name = "sparger." + std::to_string(k);
    const auto solid = first_in_solid(scene, sparger);
    if (solid)
      problems.add(*draft.node(name), name + " reaches into a solid: (" + brief((*solid)[0]) + ", " +
                                          brief((*solid)[1]) + ", " + brief((*solid)[2]) + ") lies in " +
                                          body_at(scene, *solid) + "; keep all of it in the liquid");
    bool in_liquid = !solid;
    for (const char* key : {"position", "end"})
      if (const Node* node = draft.node(name + "." + key); node && !solid &&
                                                           (key[0] == 'p' || sparger.shape == SpargerShape::line) &&
                                                           !wet(key[0] == 'p' ? sparger.position : sparger.end)) {
        problems.add(*node, name + "." + key + " lies outside the liquid; move it below the surface");
        in_liquid = false;
      }
    if (in_liquid)
      if (const auto dry = first_dry(outline(sparger))) problems.add(*draft.node(name), reaches_out(name, *dry));
    if (!sparger.rate) continue;
    check_substeps(draft, scene, name, sparger.sizes, problems);
    const Node* node = draft.node(name + ".rate");
    const double end = draft.options.time.end;
    constexpr int samples = 400;  // what lasts shorter than 1/400 of the run may go unseen
    double gas = 0;
    bool good = true;
    for (int i = 0; i <= samples && good; ++i) {
      const double t = end * i / samples;
      const double rate = (*sparger.rate)(0, 0, 0, t);
      good = std::isfinite(rate) && rate >= 0;
      if (!good)
        problems.add(*node,
                     name + ".rate must be a number >= 0 at all times, found " + brief(rate) + " at t = " + brief(t));
      gas += rate * end / samples;
    }
    if (!good) continue;
    if (gas == 0)
      problems.warn(*node, name + ".rate is 0 at all times: no bubble is set out; give a rate, or remove [[sparger]]");
    const double smallest = bubbles::volume_of(sparger.sizes.mean);
    if (const double held = gas * share_in_liquid(draft, scene, sparger); held > volume)
      problems.add(*node, name + ".rate brings " + brief(held) +
                              " of gas into the liquid at once, more than the liquid holds, " + brief(volume) +
                              ": check its unit, length3/time");
    else if (gas / smallest > most_bubbles)
      problems.add(*node, name + ".rate releases " + brief(gas / smallest) + " bubbles by the end; at most " +
                              brief(most_bubbles) + " are possible: lower the rate or enlarge bubble_radius");
  }
  for (std::size_t k = 0; k < sources.clouds.size(); ++k) {
    const BubbleCloud& cloud = sources.clouds[k];
    const std::string name = "bubble_cloud." + std::to_string(k);
    check_substeps(draft, scene, name, cloud.sizes, problems);
    std::vector<Vec3> places = outline(cloud);  // of which those in solids get no bubbles
    const Vec3 some = places.back();
    if (!scene.walls.empty()) std::erase_if(places, [&](const Vec3& r) { return scene.walls.inside(r); });
    if (places.empty())
      problems.add(*draft.node(name), name + " lies in " + body_at(scene, some) + "; move it into the liquid");
    else if (const auto dry = first_dry(places))
      problems.add(*draft.node(name), reaches_out(name, *dry));
    const double gas = bubbles::volume_of(cloud.sizes.mean) * static_cast<double>(cloud.number);
    if (gas > volume)
      problems.add(*draft.node(name), name + " holds " + brief(gas) + " of gas, more than the liquid, " +
                                          brief(volume) + ": fewer or smaller bubbles");
  }
}

}  // namespace spume
