// SPDX-License-Identifier: MIT
#include "spume/methods/wcsph/registration.hpp"

#include <algorithm>
#include <numbers>

#include "spume/methods/wcsph/wcsph.hpp"
#include "spume/particles/options.hpp"
#include "spume/physics/solutes/solutes.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/option.hpp"

namespace spume::wcsph {
namespace {

// Numbers of phases are bytes where interfaces are looked for.
constexpr std::size_t most_phases = 200;

void check(Draft& draft, Problems& problems) {
  if (draft.options.resolution.kernel != KernelKind::wendland_c2)
    problems.add(
        *draft.node("resolution.kernel"),
        "method \"wcsph\" takes resolution.kernel = \"wendland-c2\" alone, under which particles do not pair up; "
        "remove the key");
  if (draft.surface_tension > 0 && !draft.bodies.empty())
    problems.add(*draft.node("interface.surface_tension"),
                 "method \"wcsph\" has no surface tension beside walls of [[body]]; expected 0: remove the key, or use "
                 "method \"gfd\"");
  if (draft.surface_tension > 0 && draft.phases.size() > most_phases)
    problems.add(*draft.node("phase.0"), "the case has " + std::to_string(draft.phases.size()) +
                                             " phases; with surface tension at most " + std::to_string(most_phases) +
                                             " are possible");
  std::vector<std::string> fields;
  for (const OutputFieldInfo& field : field_infos(output_fields(), draft.options)) fields.push_back(field.name);
  check_solutes(draft, fields, problems);
  if (draft.phases.size() > 1 && SoluteFeatures(draft.options).scalars)
    for (const char* section : {"scalar.0", "oxygen", "biokinetics"})
      if (const Node* node = draft.node(section)) {
        problems.add(*node, "method \"wcsph\" carries scalars in a liquid that is the only phase, and the case has " +
                                std::to_string(draft.phases.size()) + "; leave the gas out, or remove the scalars");
        break;
      }
  if (!draft.solids.empty())
    problems.add(*draft.node("solid.0"),
                 "method \"wcsph\" knows walls of [[body]], not [[solid]]; write the box as [[body]] with shape = "
                 "\"box\"");
}

// Air and water beside openings: a tank with air through its floor, 833:1, ended after 0.18 s; with surface tension or
// shifting it goes on.
void warn_of_tearing(const Draft& draft, const Scene& scene, Problems& problems) {
  constexpr double large_ratio = 100;
  if (scene.phases.size() < 2 || scene.openings.empty() || scene.surface_tension > 0 ||
      draft.options.get<CompressibilityOptions>().shifting == Shifting::on)
    return;
  const auto [light, heavy] = std::minmax_element(scene.phases.begin(), scene.phases.end(),
                                                  [](const auto& a, const auto& b) { return a.density < b.density; });
  if (heavy->density <= large_ratio * light->density) return;
  problems.warn(*draft.node(scene.openings.front().name),
                "phases of " + brief(heavy->density / light->density) +
                    ":1 beside openings, without surface tension, tear, and the run may end with a density that is off "
                    "by half; set interface.surface_tension, or compressibility.shifting = \"on\"");
}

void check_scene(const Draft& draft, const Scene& scene, Problems& problems) {
  check_initial_scalars(draft, scene, problems);
  warn_of_tearing(draft, scene, problems);
  if (draft.options.get<CompressibilityOptions>().shifting == Shifting::on && scene.free_surface)
    problems.add(
        *draft.node("compressibility.shifting"),
        "particles would be shifted across a free surface; expected phases that fill the domain: remove the key");
}

// Fields, cells, sweep records, leased arrays and lists of neighbours: the arrays of `spume check` of runs of 3,000 to
// 100,000 particles. Left out is what falls with their size, images and the points of walls.
double bytes_per_particle(const Draft& draft) {
  const bool deep = draft.dimensions == 3, tension = draft.surface_tension > 0 && draft.phases.size() > 1;
  const bool bodies = std::any_of(draft.bodies.begin(), draft.bodies.end(),
                                  [](const auto& body) { return body.wall != BoundaryKind::open; });
  double bytes = (deep ? 181 : 138) + (draft.phases.size() > 1 ? 8 : 0);
  if (tension) bytes += deep ? 160 : 102;  // shifting, bands, colours, normals and curvatures
  if (bodies) bytes += deep ? 36 : 28;     // velocities of half a step, densities, viscosities
  const double reach = support_ratio(draft.options.resolution) + draft.options.get<ListOptions>().skin;
  const double neighbours = std::numbers::pi * reach * reach * (deep ? 4.0 / 3 * reach : 1);
  return bytes + (bodies ? 3.8 : 2.3) * neighbours;
}

// Of the smoothing length over the sum of sound speed and speed.
constexpr double standard_courant = 0.6;

}  // namespace

Registration registration() {
  Registration method;
  method.name = "wcsph";
  method.description = "flow of several phases by weakly compressible SPH, with repulsion between them";
  method.fills_phases = true;
  method.passes_openings = true;
  method.honours_bodies = true;
  method.honours_solids = false;
  method.honours_displaced_walls = false;
  method.sections = solute_sections();
  for (const auto& section : {compressibility_section, interface_section, list_section})
    method.sections.push_back(section());
  method.check = check;
  method.check_scene = check_scene;
  method.bytes_per_particle = bytes_per_particle;
  method.default_courant = [](const Case&, const Scene&) { return standard_courant; };
  method.default_courant_in_words = "of wcsph " + brief(standard_courant);
  method.output_fields = [](const Case& options) {
    std::vector<OutputFieldInfo> fields = field_infos(output_fields(), options);
    add_scalar_fields(options.get<ScalarOptions>(), fields);
    return fields;
  };
  method.probe_scalars = [](const Case&) { return std::vector<ProbeScalar>{{"pressure", "pressure"}}; };
  method.make = [](const LoadedCase& loaded) { return std::make_unique<Wcsph>(loaded); };
  return method;
}

}  // namespace spume::wcsph
