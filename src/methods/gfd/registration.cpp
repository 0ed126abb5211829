// SPDX-License-Identifier: MIT
#include "spume/methods/gfd/registration.hpp"

#include <numbers>

#include "spume/methods/gfd/gfd.hpp"
#include "spume/particles/direct_pressure.hpp"
#include "spume/particles/thin_regions.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/option.hpp"

namespace spume::gfd {
namespace {

// Numbers of phases are bytes.
constexpr std::size_t most_phases = 200;

void check(Draft& draft, Problems& problems) {
  if (draft.node("pressure.solver") && draft.options.get<PressureOptions>().solver == PressureSolver::cg)
    problems.add(*draft.node("pressure.solver"),
                 "pressure.solver = \"cg\" needs a symmetric matrix, which generalised finite differences do not have; "
                 "use \"bicgstab\"");
  if (draft.phases.size() > most_phases)
    problems.add(*draft.node("phase.0"), "the case has " + std::to_string(draft.phases.size()) + " phases; at most " +
                                             std::to_string(most_phases) + " are possible");
  for (std::size_t k = 0; k < draft.phases.size(); ++k) {
    const auto refuse = [&](const char* key) {
      problems.add(
          *draft.node("phase." + std::to_string(k) + "." + key),
          "method \"gfd\" is incompressible; remove " + std::string(key) + ", or use a weakly compressible method");
    };
    if (draft.phases[k].sound_speed > 0) refuse("sound_speed");
    if (draft.phases[k].exponent > 0) refuse("exponent");
  }
}

// Layers behind openings know flat sides that stand still and slide, and explicit diffusion.
void check_openings(const Draft& draft, const Scene& scene, Problems& problems) {
  if (scene.openings.empty()) return;
  const Node& opening = *draft.node(scene.openings.front().name);
  if (draft.options.get<LimitOptions>().viscosity == ViscousSteps::implicit)
    problems.add(*draft.node("time.viscosity"),
                 "time.viscosity = \"implicit\" beside openings: the steps of method \"gfd\" are explicit there; "
                 "remove the key");
  for (const Opening& each : scene.openings) {
    if (!each.inflow || each.level == nullptr) continue;
    const Node* const node = draft.node(each.name + ".level");
    problems.add(node != nullptr ? *node : *draft.node(each.name),
                 each.name +
                     ".level leaves a part of the side dry, and method \"gfd\" fills its domain: nothing would "
                     "stand behind that part; give the height of the opening by upper or where, beside a wall");
  }
  if (!draft.solids.empty())
    problems.add(*draft.node("solid.0"),
                 "method \"gfd\" knows no [[solid]] beside openings; write the box as [[body]] with shape = \"box\"");
  if (BoundaryFeatures(scene.domain).displaced_walls)
    problems.add(opening, scene.openings.front().name +
                              " stands beside a side that moves along its normal, which method \"gfd\" does not "
                              "join; let sides slide along themselves alone, or move a [[body]]");
}

void check_scene(const Draft& draft, const Scene& scene, Problems& problems) {
  check_direct_solver(draft, scene, problems);
  check_openings(draft, scene, problems);
  const double support = support_ratio(draft.options.resolution) * scene.spacing;
  for (const ThinRegion& thin : thin_regions(scene, support)) {
    const std::string name = "region." + std::to_string(thin.region);
    problems.add(*draft.node(name),
                 name + " is " + brief(thin.width) + " wide; its interfaces need the kernel support, " +
                     brief(support) +
                     ": widen it, or set resolution.spacing <= " + brief(scene.spacing * thin.width / support));
  }
  if (scene.free_surface)
    problems.add(
        *draft.node("region.0"),
        "the phases leave a part of the domain empty or a side open; method \"gfd\" has no free surface: begin "
        "with a [[region]] that fills the domain, between walls, periodic sides and openings ([[inflow]], "
        "[[outflow]])");
}

// Fields, lists of neighbours, sweep records and the pressure system of a large case: `spume check` and the arrays of a
// run of 40 000 particles give what is left beside the lists.
double bytes_per_particle(const Draft& draft) {
  const Case& options = draft.options;
  const int dimensions = draft.dimensions;
  const double support = support_ratio(options.resolution);
  const double neighbours = std::numbers::pi * support * support * (dimensions == 3 ? 4.0 / 3 * support : 1);
  return (dimensions == 3 ? 426 : 356) + 4.63 * neighbours;
}

constexpr double standard_courant = 0.2;

}  // namespace

Registration registration() {
  Registration method;
  method.name = "gfd";
  method.description =
      "incompressible flow of several phases by generalised finite differences, with tension and the full stress";
  method.fills_phases = true;
  method.incompressible = true;
  method.passes_openings = true;
  method.honours_bodies = true;
  method.sections = {pressure_section(), shifting_section(false), momentum_section(), interface_section(),
                     limits_section()};
  method.check = check;
  method.check_scene = check_scene;
  method.bytes_per_particle = bytes_per_particle;
  method.default_courant = [](const Case&, const Scene&) { return standard_courant; };
  method.default_courant_in_words = "of gfd " + brief(standard_courant);
  method.output_fields = [](const Case& options) { return field_infos(output_fields(), options); };
  method.probe_scalars = [](const Case&) { return std::vector<ProbeScalar>{{"pressure", "pressure"}}; };
  method.make = [](const LoadedCase& loaded) { return std::make_unique<Gfd>(loaded); };
  return method;
}

}  // namespace spume::gfd
