// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/registration.hpp"

#include <numbers>

#include "spume/methods/les_sph/les_sph.hpp"
#include "spume/methods/les_sph/options.hpp"
#include "spume/physics/bubbles/options.hpp"
#include "spume/physics/solutes/solutes.hpp"
#include "spume/physics/turbulence/options.hpp"
#include "spume/scene/document.hpp"

namespace spume::les_sph {
namespace {

std::vector<Section> sections() {
  std::vector<Section> all = bubble_sections();
  all.insert(all.end(),
             {turbulence_section(), pressure_section(), shifting_section(), surface_section(), scheme_section()});
  for (Section& section : solute_sections()) all.push_back(std::move(section));
  return all;
}

// Bubbles know nothing of openings, and the pressure of the points behind them is a fit, which makes the matrix
// unsymmetric.
void check_openings(Draft& draft, Problems& problems) {
  for (const char* section : {"inflow", "outflow"}) {
    const Node* opening = draft.node(std::string(section) + ".0");
    if (opening == nullptr) continue;
    const std::string name = std::string("[[") + section + "]]";
    if (draft.node("bubbles"))
      problems.add(*draft.node("bubbles"),
                   "[bubbles] does not go with " + name + ": bubbles do not enter or leave; remove one of them");
    if (draft.node("pressure.solver") && draft.options.get<PressureOptions>().solver == PressureSolver::cg)
      problems.add(*draft.node("pressure.solver"),
                   "pressure.solver = \"cg\" needs a symmetric matrix, which a liquid "
                   "with " +
                       name + " does not have; use \"bicgstab\"");
    return;
  }
}

void check(Draft& draft, Problems& problems) {
  check_openings(draft, problems);
  check_bubbles(draft, problems);
  std::vector<std::string> fields;
  for (const OutputFieldInfo& field : field_infos(output_fields(), draft.options)) fields.push_back(field.name);
  check_solutes(draft, fields, problems);
  if (draft.node("bubbles") && draft.dimensions != 2 && draft.node("pressure.solver") &&
      draft.options.get<PressureOptions>().solver == PressureSolver::cg)
    problems.add(*draft.node("pressure.solver"),
                 "pressure.solver = \"cg\" needs a symmetric matrix, which a liquid with bubbles does not have; use "
                 "\"bicgstab\"");
}

// Fields, neighbour lists with the particles of a full support, sweep records and the pressure system of a large case.
// Left out is what falls with its size (images beside walls) and what the scene adds (surfaces, bubbles).
double bytes_per_particle(const Draft& draft) {
  const Case& options = draft.options;
  const int dimensions = draft.dimensions;
  const double support_radius = support_ratio(options.resolution);
  const double neighbours =
      std::numbers::pi * support_radius * support_radius * (dimensions == 3 ? 4.0 / 3 * support_radius : 1);
  // `spume check` of 40 000 particles: 115.5 bytes per particle in the lists of 21 neighbours and 300 beside them and
  // the images in two dimensions, 358 in those of 74 and 375 in three.
  return (dimensions == 3 ? 390 : 318) + 4.63 * neighbours;
}

// King (3.18). Below a surface what the spacing leaves outweighs what longer steps add; in a full domain it does not.
constexpr double courant_in_full_domain = 0.2, courant_with_surface = 0.3;
double default_courant(const Case&, const Scene& scene) {
  return scene.free_surface ? courant_with_surface : courant_in_full_domain;
}

}  // namespace

Registration registration() {
  Registration method;
  method.name = "les-sph";
  method.description =
      "semi-implicit, weakly compressible SPH for a liquid with a free surface, with turbulence closures and bubbles";
  method.fills_regions = true;
  method.incompressible = true;
  method.damps_sponges = true;
  method.absorbs_waves = true;
  method.honours_bodies = true;
  method.honours_floating_bodies = true;
  method.solids_join_bodies = true;
  method.passes_openings = true;
  method.sections = sections();
  method.check = check;
  method.check_scene = [](const Draft& draft, const Scene& scene, Problems& problems) {
    check_direct_solver(draft, scene, problems);
    check_bubble_sources(draft, scene, problems);
    check_initial_scalars(draft, scene, problems);
  };
  method.bytes_per_particle = bytes_per_particle;
  method.default_courant = default_courant;
  method.default_courant_in_words =
      brief(courant_in_full_domain) + ", with a free surface " + brief(courant_with_surface);
  method.output_fields = [](const Case& options) {
    std::vector<OutputFieldInfo> fields = field_infos(output_fields(), options);
    add_scalar_fields(options.get<ScalarOptions>(), fields);
    return fields;
  };
  method.probe_scalars = [](const Case&) { return std::vector<ProbeScalar>{{"pressure", "pressure"}}; };
  method.make = [](const LoadedCase& loaded) { return std::make_unique<LesSph>(loaded); };
  return method;
}

}  // namespace spume::les_sph
