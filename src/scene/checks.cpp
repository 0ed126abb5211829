// SPDX-License-Identifier: MIT
#include "checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "spume/scene/option.hpp"

namespace spume {
namespace {

const std::string axis_names[3] = {"x", "y", "z"};
// Slack of lengths and times that case files give in decimals: far above what a few operations in double round (1e-15),
// far below a spacing or a step.
constexpr double rounding = 1e-9;

// A list with one entry per direction; absent lists pass.
bool has_size(const Draft& draft, const std::string& name, std::size_t size, std::size_t wanted, Problems& problems) {
  const Node* node = draft.node(name);
  if (!node || !draft.usable(name) || size == wanted) return draft.usable(name);
  problems.add(*node, name + " must have " + std::to_string(wanted) + " entries in a " + std::to_string(wanted) +
                          "-D domain, found " + std::to_string(size));
  return false;
}

bool ordered(const Draft& draft, const std::string& name, const std::vector<double>& lower,
             const std::vector<double>& upper, Problems& problems) {
  for (std::size_t a = 0; a < lower.size() && a < upper.size(); ++a) {
    if (lower[a] < upper[a]) continue;
    problems.add(*draft.node(name + ".upper"), name + ".upper must lie above " + name + ".lower: " + axis_names[a] +
                                                   " runs from " + brief(lower[a]) + " to " + brief(upper[a]));
    return false;
  }
  return true;
}

bool domain_known(const Draft& draft) {
  return draft.dimensions > 0;
}

// The largest spacing, rounded down to three digits, that satisfies `length >= factor * spacing`.
std::string largest_spacing(double length, double factor) {
  const double spacing = length / factor;
  const double unit = std::pow(10.0, std::floor(std::log10(spacing)) - 2);
  return brief(std::floor(spacing / unit) * unit);
}

bool is_wall(const Draft& draft, const std::string& side) {
  const auto found = draft.sides.find(side);
  return found != draft.sides.end() && found->second != BoundaryKind::open;
}

void check_sides(const Draft& draft, Problems& problems) {
  const int dimensions = draft.dimensions;
  std::set<std::string> valid;
  for (int axis = 0; axis < dimensions; ++axis) {
    for (const std::string& side : side_names(axis, dimensions)) {
      valid.insert(side);
      if (draft.periodic[static_cast<std::size_t>(axis)] && draft.sides.count(side)) {
        problems.add_key(*draft.node("domain." + side), "domain." + side + " is a side of the periodic direction " +
                                                            axis_names[axis] + "; remove one of the two");
      }
    }
  }
  if (draft.periodic[2] && dimensions == 2) {
    problems.add_key(*draft.node("domain.z"), "domain.z names a direction that a 2-D domain does not have");
  }
  for (const auto& entry : draft.sides) {
    if (valid.count(entry.first)) continue;
    problems.add_key(*draft.node("domain." + entry.first),
                     "domain." + entry.first + " is a side of a 3-D domain; a 2-D one has left, right, bottom, top");
  }
  for (const auto& [side, velocity] : draft.wall_velocity) {
    const std::string name = "domain.wall_velocity." + side;
    if (!valid.count(side)) {
      problems.add_key(*draft.node(name), name + ": a 2-D domain has left, right, bottom, top");
    } else if (!is_wall(draft, side) && draft.usable("domain." + side)) {
      problems.add_key(*draft.node(name),
                       name + " moves a side that is not a wall; add  " + side + " = \"no-slip\"  to [domain]");
    }
    has_size(draft, name, velocity.size(), static_cast<std::size_t>(dimensions), problems);
  }
}

// The part of a message that places an interval outside another.
std::string span_in_words(std::size_t axis, double low, double high) {
  return axis_names[axis] + " from " + brief(low) + " to " + brief(high);
}

// The headings of a probe in probes.csv must be its own.
void claim_columns(const Draft& draft, const std::string& probe, const ProbeOptions& options,
                   const std::vector<ProbeScalar>& scalars, std::map<std::string, std::string>& columns,
                   Problems& problems) {
  std::vector<std::string> headings{options.name};
  if (options.kind == ProbeKind::line) return;
  if (options.kind == ProbeKind::point || options.kind == ProbeKind::plane) {
    headings.clear();
    for (const ProbeScalar& scalar : scalars) headings.push_back(options.name + "_" + scalar.name);
    if (options.kind == ProbeKind::plane) headings.push_back(options.name + "_area");
    for (std::size_t a = 0; a < draft.lower.size(); ++a)
      headings.push_back(options.name + "_velocity_" + axis_names[a]);
  }
  for (const std::string& heading : headings) {
    const auto [owner, free] = columns.emplace(heading, "probe '" + options.name + "'");
    if (free) continue;
    problems.add(*draft.node(probe + ".name"), "its column '" + heading + "' of probes.csv is that of " +
                                                   owner->second + " already; choose another name");
    return;
  }
}

void check_shape(const Draft& draft, const char* header, const std::string& name, const LiquidDraft& liquid,
                 Problems& problems) {
  const std::size_t dimensions = draft.lower.size();
  const Node& node = *draft.node(name);
  bool sized = true;
  const auto check_size = [&](const char* key, std::size_t size) {
    sized = has_size(draft, name + "." + key, size, dimensions, problems) && sized;
  };
  check_size("lower", liquid.lower.size());
  check_size("upper", liquid.upper.size());
  check_size("centre", liquid.centre.size());
  check_size("velocity", liquid.velocity.size());
  if (draft.node(name + ".centre") && !draft.node(name + ".radius")) {
    problems.add(node, std::string("missing key 'radius' in ") + header +
                           ", which has a centre; add  radius = <number>  # length, > 0");
  }
  if (draft.node(name + ".radius") && !draft.node(name + ".centre")) {
    problems.add(node, std::string("missing key 'centre' in ") + header +
                           ", which has a radius; add  centre = [<number>, <number>]  # length");
  }
  if (liquid.conform && !draft.node(name + ".where")) {
    problems.add(*draft.node(name + ".conform"),
                 name + ".conform needs the surface; add  where = \"<expression>\"  # positive below it");
  }
  if (liquid.conform && draft.node(name + ".centre")) {
    problems.add(*draft.node(name + ".conform"),
                 name + ".conform ends columns on the surface where = 0; remove centre and radius");
  }
  if (!sized) return;
  if (!liquid.lower.empty() && !liquid.upper.empty() && !ordered(draft, name, liquid.lower, liquid.upper, problems)) {
    return;
  }
  const bool ball = !liquid.centre.empty() && liquid.radius;
  for (std::size_t a = 0; a < dimensions; ++a) {
    const double slack = rounding * (draft.upper[a] - draft.lower[a]);
    double low = liquid.lower.empty() ? draft.lower[a] : liquid.lower[a];
    double high = liquid.upper.empty() ? draft.upper[a] : liquid.upper[a];
    if (ball && liquid.lower.empty() && liquid.upper.empty()) {
      low = liquid.centre[a] - *liquid.radius;
      high = liquid.centre[a] + *liquid.radius;
      // Half of a ball about a place on a side: the other half is its image.
      if (!draft.periodic[a] && std::abs(liquid.centre[a] - draft.lower[a]) <= slack) low = draft.lower[a];
      if (!draft.periodic[a] && std::abs(liquid.centre[a] - draft.upper[a]) <= slack) high = draft.upper[a];
    }
    if (low >= draft.lower[a] - slack && high <= draft.upper[a] + slack) continue;
    problems.add(node, name + " reaches outside the domain: " + span_in_words(a, low, high) + ", the domain's " +
                           span_in_words(a, draft.lower[a], draft.upper[a]) +
                           (ball ? "; a ball lies inside, or its centre on a side that is not periodic" : ""));
    break;
  }
}

}  // namespace

std::array<std::string, 2> side_names(int axis, int dimensions) {
  if (axis == dimensions - 1) return {"bottom", "top"};
  return axis == 0 ? std::array<std::string, 2>{"left", "right"} : std::array<std::string, 2>{"front", "back"};
}

std::pair<int, int> side_place(const std::string& side, int dimensions) {
  for (int axis = 0; axis < dimensions; ++axis)
    for (int end = 0; end < 2; ++end)
      if (side_names(axis, dimensions)[static_cast<std::size_t>(end)] == side) return {axis, end};
  return {-1, -1};
}

// The title stands in the first line of every table, which its readers count by lines.
void check_title(const Draft& draft, Problems& problems) {
  const std::string& title = draft.options.title;
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::none_of(title.begin(), title.end(), control)) return;
  const std::string rule = " has a line break or another control character; a title is one line of text";
  if (const Node* node = draft.node("title"))
    problems.add(*node, "title" + rule);
  else
    problems.add(Place{1, 1}, "the name of the case" + rule + "; add  title = \"<text>\"");
}

void check_domain(Draft& draft, Problems& problems) {
  if (!draft.usable("domain.lower") || !draft.usable("domain.upper") || !draft.usable("domain")) return;
  for (const char* name : {"domain.lower", "domain.upper"}) {
    const std::size_t size = name[7] == 'l' ? draft.lower.size() : draft.upper.size();
    if (size != 2 && size != 3) {
      problems.add(*draft.node(name),
                   std::string(name) + " must have 2 entries (2-D) or 3 (3-D), found " + std::to_string(size));
      return;
    }
  }
  if (!has_size(draft, "domain.upper", draft.upper.size(), draft.lower.size(), problems)) return;
  if (!ordered(draft, "domain", draft.lower, draft.upper, problems)) return;
  draft.dimensions = static_cast<int>(draft.lower.size());
  check_sides(draft, problems);
  if (!draft.body_force.empty() || draft.node("forces.body")) {
    has_size(draft, "forces.body", draft.body_force.size(), draft.lower.size(), problems);
  }
}

void check_resolution(const Draft& draft, Problems& problems) {
  if (!domain_known(draft) || !draft.usable("resolution.spacing")) return;
  const double spacing = draft.options.spacing;
  const Node& node = *draft.node("resolution.spacing");
  for (std::size_t a = 0; a < draft.lower.size(); ++a) {
    const double length = draft.upper[a] - draft.lower[a];
    if (spacing > length) {
      problems.add(node, "resolution.spacing = " + brief(spacing) + " is larger than the domain, which is " +
                             brief(length) + " long in " + axis_names[a] +
                             "; set spacing <= " + largest_spacing(length, 10));
      return;
    }
  }
  if (!draft.usable("resolution.smoothing_ratio") || !draft.usable("resolution.kernel")) return;
  // Below this length a particle meets two images of the same neighbour, or those of both walls.
  const double least = 2 * support_ratio(draft.options.resolution) + 1;
  for (std::size_t a = 0; a < draft.lower.size(); ++a) {
    const double length = draft.upper[a] - draft.lower[a];
    const auto sides = side_names(static_cast<int>(a), draft.dimensions);
    const bool walls = is_wall(draft, sides[0]) && is_wall(draft, sides[1]);
    if ((!draft.periodic[a] && !walls) || length >= least * spacing * (1 - rounding)) continue;
    problems.add(node, (draft.periodic[a] ? "the periodic length in " + axis_names[a]
                                          : "the distance between the walls " + sides[0] + " and " + sides[1]) +
                           ", " + brief(length) + ", is shorter than two kernel supports and a spacing, " +
                           brief(least * spacing) + "; set spacing <= " + largest_spacing(length, least) +
                           " or lengthen the domain to " + brief(least * spacing));
  }
}

void check_solids(const Draft& draft, Problems& problems) {
  if (!domain_known(draft) || !draft.usable("solid")) return;
  const std::size_t dimensions = draft.lower.size();
  for (std::size_t k = 0; k < draft.solids.size(); ++k) {
    const SolidDraft& solid = draft.solids[k];
    const std::string name = "solid." + std::to_string(k);
    const bool sized = has_size(draft, name + ".lower", solid.lower.size(), dimensions, problems) &
                       has_size(draft, name + ".upper", solid.upper.size(), dimensions, problems);
    if (!sized || !ordered(draft, name, solid.lower, solid.upper, problems)) continue;
    for (std::size_t a = 0; a < dimensions; ++a) {
      if (solid.upper[a] <= draft.lower[a] || solid.lower[a] >= draft.upper[a]) {
        problems.add(*draft.node(name),
                     name + " lies outside the domain: " + span_in_words(a, solid.lower[a], solid.upper[a]) +
                         ", the domain's " + span_in_words(a, draft.lower[a], draft.upper[a]));
        break;
      }
      const bool usable = draft.usable("resolution.spacing") && draft.usable("resolution.smoothing_ratio") &&
                          draft.usable("resolution.kernel");
      const double support_radius = support_ratio(draft.options.resolution) * draft.options.spacing;
      const double gap = std::min(solid.lower[a] - draft.lower[a], draft.upper[a] - solid.upper[a]);
      const bool spans = solid.lower[a] <= draft.lower[a] && solid.upper[a] >= draft.upper[a];
      if (usable && draft.periodic[a] && !spans && gap < support_radius * (1 - rounding)) {
        problems.add(*draft.node(name), name + " is " + brief(std::max(gap, 0.0)) + " away from a periodic side in " +
                                            axis_names[a] + ", within the kernel support " + brief(support_radius) +
                                            ", and its mirror images would end there; move the sides of the domain, or "
                                            "let the box span it");
      }
    }
  }
}

void check_fluid(const Draft& draft, Problems& problems) {
  const FluidDraft& fluid = draft.fluid;
  const std::vector<std::string> groups{"reynolds", "froude", "mach"};
  const std::vector<std::string> si{"density", "viscosity", "gravity", "sound_speed"};
  std::string first_group;
  for (const std::string& key : groups) {
    if (first_group.empty() && draft.node("fluid." + key)) first_group = key;
  }
  bool any_si = false;
  for (const std::string& key : si) {
    const Node* node = draft.node("fluid." + key);
    any_si = any_si || node;
    if (node && !first_group.empty()) {
      problems.add_key(*node, "fluid." + key + " is an SI value and fluid." + first_group +
                                  " a group; give either reynolds, froude, mach or density, viscosity, gravity, "
                                  "sound_speed");
    }
  }
  if (any_si && first_group.empty() && !draft.node("fluid.density") && !fluid.density) {
    problems.add(*draft.node("fluid"), "missing key 'density' in [fluid]; add  density = <number>  # kg/m3, > 0");
  }
}

void check_liquids(const Draft& draft, Problems& problems) {
  if (draft.liquids.empty() && draft.usable("liquid")) {
    problems.add(Place{1, 1}, "no liquid: add a region, for example  [[liquid]]  with  lower, upper  or  where");
    return;
  }
  if (!domain_known(draft) || !draft.usable("liquid")) return;
  for (std::size_t k = 0; k < draft.liquids.size(); ++k)
    check_shape(draft, "[[liquid]]", "liquid." + std::to_string(k), draft.liquids[k], problems);
}

void check_phases(const Draft& draft, Problems& problems) {
  const Node *gravity = draft.node("fluid.gravity"), *froude = draft.node("fluid.froude");
  if (gravity != nullptr && froude != nullptr)
    problems.add_key(*gravity,
                     "fluid.gravity is an SI value and fluid.froude a group, gravity 1/Fr^2; give one of them");
  if (draft.phases.empty() && draft.usable("phase"))
    problems.add(Place{1, 1}, "no phase: add a fluid,  [[phase]]  with  name, density, viscosity");
  std::vector<std::string> names;
  for (std::size_t k = 0; k < draft.phases.size(); ++k) {
    const std::string place = "phase." + std::to_string(k) + ".name";
    const std::string& name = draft.phases[k].name;
    if (!draft.usable(place)) continue;
    if (name.empty())
      problems.add(*draft.node(place), place + " must not be empty");
    else if (std::find(names.begin(), names.end(), name) != names.end())
      problems.add(*draft.node(place), "another phase has the name '" + name + "' already");
    else
      names.push_back(name);
  }
  if (const Node* drawn = draft.node("output.interface");
      drawn && draft.options.output.interface && draft.phases.size() == 1)
    problems.add(
        *drawn,
        "the case has one phase and no interface that output.interface could write; remove it, or add a [[phase]]");
  if (const Node* tension = draft.node("interface.surface_tension"); tension && draft.phases.size() == 1)
    problems.add(*tension, "interface.surface_tension needs two phases, found one; add a [[phase]], or remove it");

  if (draft.regions.empty() && draft.usable("region"))
    problems.add(Place{1, 1}, "no region: say what a phase fills,  [[region]]  with  phase = \"<name>\"");
  if (!draft.usable("region")) return;
  for (std::size_t k = 0; k < draft.regions.size(); ++k) {
    const std::string place = "region." + std::to_string(k);
    const std::string& phase = draft.regions[k].phase;
    const bool known = std::find(names.begin(), names.end(), phase) != names.end();
    // Where a phase has no name of its own, the region may mean that one.
    if (!known && draft.usable(place + ".phase") && names.size() == draft.phases.size() && !names.empty()) {
      const std::string best = nearest(phase, names);
      problems.add(*draft.node(place + ".phase"), place + ".phase must be the name of a phase, " +
                                                      words_in_words(names) + ", found " + to_toml_string(phase) +
                                                      (best.empty() ? "" : "; did you mean \"" + best + "\"?"));
    }
    if (domain_known(draft)) check_shape(draft, "[[region]]", place, draft.regions[k], problems);
  }
}

void check_phases_filled(const Draft& draft, const Scene& scene, Problems& problems) {
  std::vector<bool> filled(scene.phases.size());
  for (const std::int32_t phase : scene.particles.phase) filled[static_cast<std::size_t>(phase)] = true;
  for (const Opening& opening : scene.openings)
    if (opening.inflow) filled[opening.phase] = true;
  for (std::size_t n = 0; n < filled.size(); ++n)
    if (!filled[n])
      problems.add(
          *draft.node("phase." + std::to_string(n)),
          "phase '" + scene.phases[n].name +
              "' fills nothing: no [[region]] of it is left; add a region behind the others, let it enter by an "
              "[[inflow]], or remove it");
}

// In SI units, which gravity tells: mercury has 1.1e-7 m2/s, liquid carbon dioxide 8e-8, and an oil of 4.5e-5
// m2/s 4.5e-8 where that is given for Pa s.
void warn_of_kinematic_viscosity(const Draft& draft, Problems& problems) {
  const double gravity = draft.fluid.gravity.value_or(0);
  const auto look = [&](const std::string& key, double density, double viscosity) {
    const Node* given = draft.node(key);
    if (given == nullptr || !draft.usable(key) || !(density >= 500 && viscosity > 0)) return;
    if (viscosity / density >= 5e-8) return;
    problems.warn(*given, key + " = " + brief(viscosity) + " Pa s is " + brief(viscosity / density) + " m2/s at " +
                              brief(density) +
                              " kg/m3, thinner than mercury; expected the dynamic viscosity, of water " +
                              "1e-3 Pa s: is it the kinematic one, in m2/s?");
  };
  if (!(gravity > 9.7 && gravity < 9.9)) return;
  look("fluid.viscosity", draft.fluid.density.value_or(0), draft.fluid.viscosity.value_or(0));
  for (std::size_t n = 0; n < draft.phases.size(); ++n)
    look("phase." + std::to_string(n) + ".viscosity", draft.phases[n].density, draft.phases[n].viscosity);
}

// A step ends at each of these times: an interval far below the steps is a slip of the pen, which would fill the disk
// or take for ever. The cases ask for at most 1,000 of a kind; a million rows of series.csv have 200 to 440 MB.
void check_output(const Draft& draft, Problems& problems) {
  constexpr double most = 1e6;
  if (!draft.usable("time.end")) return;
  const double end = draft.options.time.end;
  const OutputOptions& output = draft.options.output;
  const std::tuple<const char*, double, const char*> intervals[] = {
      {"output.every", output.every, "snapshots"},
      {"output.series_every", output.series_every, "rows of series.csv"},
      {"output.spectrum_every", output.spectrum_every, "spectra"}};
  for (const auto& [name, interval, what] : intervals) {
    if (!(interval > 0) || !draft.usable(name) || end / interval <= most * (1 + rounding)) continue;
    problems.add(*draft.node(name), name + (" = " + brief(interval)) + " would make " + brief(end / interval) + " " +
                                        what + " until time.end = " + brief(end) + "; expected at most " + brief(most) +
                                        "; set it to " + brief(end / most) + " or more, or to 0");
  }
}

void check_output_fields(const Draft& draft, const std::vector<OutputFieldInfo>& known, Problems& problems) {
  std::string list;
  for (const OutputFieldInfo& field : known)
    if (field.lacks.empty()) list += (list.empty() ? "" : ", ") + field.name;
  for (const std::string& name : draft.options.output.fields) {
    const auto field =
        std::find_if(known.begin(), known.end(), [&](const OutputFieldInfo& one) { return one.name == name; });
    if (field != known.end() && field->lacks.empty()) continue;
    problems.add(*draft.node("output.fields"),
                 "output.fields names '" + name + "', which " +
                     (field != known.end() ? "needs " + field->lacks + "; without it the case has " + list
                                           : "method \"" + draft.options.method + "\" does not have; it has " + list));
  }
}

void check_probes(Draft& draft, const std::vector<ProbeScalar>& scalars, Problems& problems) {
  if (!domain_known(draft) || !draft.usable("probe")) return;
  const std::size_t dimensions = draft.lower.size();
  std::set<std::string> names;
  std::map<std::string, std::string> columns{{"t", "the time"}};  // of probes.csv, and whose they are
  for (std::size_t k = 0; k < draft.probes.size(); ++k) {
    ProbeDraft& probe = draft.probes[k];
    ProbeOptions& options = probe.options;
    const std::string name = "probe." + std::to_string(k);
    const Node& node = *draft.node(name);
    if (draft.usable(name + ".name")) {
      const bool plain = !options.name.empty() && options.name.find_first_of(",\"\n\r#") == std::string::npos;
      if (!plain)
        problems.add(*draft.node(name + ".name"),
                     name + ".name heads a column: no commas, quotes or line breaks, not empty");
      if (plain && !names.insert(options.name).second) {
        problems.add(*draft.node(name + ".name"), "another probe has the name '" + options.name + "' already");
      } else if (plain && draft.usable(name + ".kind")) {
        claim_columns(draft, name, options, scalars, columns, problems);
      }
    }
    if (!draft.usable(name + ".kind")) continue;

    // A column needs its foot only, a plane its place along the normal.
    const bool plane = options.kind == ProbeKind::plane;
    if (plane && options.axis >= static_cast<int>(dimensions)) {
      problems.add(*draft.node(name + ".axis"), name + ".axis is z and the domain has two dimensions: choose x or y");
      continue;
    }
    const bool column = options.kind == ProbeKind::elevation || options.kind == ProbeKind::wetted;
    const auto place = [&](const char* key, std::vector<double> values, Vec3& target) {
      const Node* given = draft.node(name + "." + key);
      if (!draft.usable(name + "." + key)) return;
      if (!given) {
        problems.add(node, std::string("missing key '") + key + "' in [[probe]]; add  " + key + " = [" +
                               (dimensions == 2 ? "<x>, <y>" : "<x>, <y>, <z>") + "]  # length");
        return;
      }
      if (column && values.size() + 1 == dimensions) values.push_back(draft.lower.back());
      if (plane && values.size() == 1) {
        std::vector<double> foot = draft.lower;
        foot[static_cast<std::size_t>(options.axis)] = values[0];
        values = foot;
      }
      if (!has_size(draft, name + "." + key, values.size(), dimensions, problems)) return;
      for (std::size_t a = 0; a < dimensions; ++a) {
        target[a] = values[a];
        const double slack = rounding * (draft.upper[a] - draft.lower[a]);
        if (values[a] >= draft.lower[a] - slack && values[a] <= draft.upper[a] + slack) continue;
        problems.add(*given, name + "." + key + " lies outside the domain: " + axis_names[a] + " = " +
                                 brief(values[a]) + ", the domain's " +
                                 span_in_words(a, draft.lower[a], draft.upper[a]));
        return;
      }
    };
    if (options.kind == ProbeKind::front) {
      if (options.axis + 1 >= static_cast<int>(dimensions)) {
        const Node* axis = draft.node(name + ".axis");
        problems.add(axis ? *axis : node, name + ".axis must be horizontal: x" + (dimensions == 3 ? " or y" : ""));
      }
      options.height = probe.height.value_or(draft.upper.back());
      if (options.height <= draft.lower.back()) {
        problems.add(*draft.node(name + ".height"),
                     name + ".height lies at or below the bottom of the domain, " + brief(draft.lower.back()));
      }
    } else {
      place("position", probe.position, options.position);
    }
    if (options.kind == ProbeKind::line) place("end", probe.end, options.end);
    const double rows = draft.options.output.series_every;
    if (options.average > 0 && options.average < rows && draft.usable(name + ".average"))
      problems.add(*draft.node(name + ".average"),
                   name + ".average is " + brief(options.average) + ", shorter than output.series_every, " +
                       brief(rows) + ": impacts between the rows would be lost; make it at least as long");
  }
  draft.options.probes.clear();
  for (const ProbeDraft& probe : draft.probes) draft.options.probes.push_back(probe.options);
}

}  // namespace spume
