// SPDX-License-Identifier: MIT
// The step, as the list of its stages: velocity Verlet with the density at the middle of the step (Adami et al. 2012),
// one evaluation of the forces. Numbers are those of the README of the method. The first accelerations are those of a
// step of length zero. The same list is what `spume check` prints and what the ledger times.
#include "spume/methods/solute_stages.hpp"
#include "spume/methods/wcsph/wcsph.hpp"

namespace spume::wcsph {

using enum StagePart;
Plan make_plan(Flow& f) {
  Plan plan;
  const Features& has = f.features;
  ParticleStore& p = f.particles;
  const ParticleStages stages(plan, f);
  const char* const several = has.several ? "several phases" : "one phase";

  stages.sweep(before, "settling", has.rest.settles, has.rest.reason, [&f](StageRun& run) { f.settle(run.go_on); },
               {p.position, *f.excess}, {p.position, *f.excess});
  const ArrayUse interfaces([&f] { return f.tension == nullptr ? 0 : f.tension->bytes(); });
  const auto keep_lists = [&f](StageRun& run) {
    const std::int64_t builds = f.list_builds;
    f.keep_lists(run.dt);
    if (f.list_builds == builds) return;
    run.bytes =
        f.arrangement.sort_traffic(f.particles) + f.arrangement.image_traffic() + f.arrangement.list_traffic(f.sizes);
  };
  const char* const openings = has.openings ? "particles enter and leave" : "no inflow, no outflow";
  stages.add(both, "openings", has.openings, openings, &Flow::move_layers, {p.position}, {p.velocity});
  stages.add(both, "lists", true, "made anew when two may have come nearer by lists.skin", keep_lists,
             {p.position, p.velocity, f.acceleration, f.listed}, {});
  const ArrayUse lack([&f] { return f.relaxation == nullptr ? 0 : f.relaxation->bytes(); });
  stages.sweep(
      step, "density relaxation", has.density_relaxation,
      has.density_relaxation
          ? "kernel sums of (12), every half of lists.skin that the fastest goes, or the largest speed of (3)"
      : f.scene.free_surface ? "compressibility.density_relaxation = 0"
                             : "no free surface",
      [&f](StageRun&) { f.measure_volume(); }, {p.position, *f.excess}, {lack}, [&f] { return f.has_moved; });
  const std::string no_tension = has.several ? "no interface.surface_tension" : several;
  stages.sweep(start, "first tension", has.tension, has.tension ? "pressures of whole phases" : no_tension,
               &Flow::start_tension, {*f.phase_number}, {*f.excess, interfaces});
  stages.add(both, "drift", true, "(5), (6): r and u at the middle of the step", &Flow::drift,
             {p.position, p.velocity, f.acceleration, f.shift}, {f.half_velocity, f.place});
  stages.sweep(both, "continuity", true,
               std::string(has.viscosity ? "(1) and the viscous part of (2)" : "(1), inviscid") +
                   (has.diffusion ? ", with diffusion of density" : "") +
                   (has.shifting ? ", and what shifting carries" : ""),
               &Flow::find_rates, {f.half_velocity, p.velocity, f.acceleration, *f.excess, *f.phase_number, f.shift},
               {f.rate, f.diffusion, f.force, f.carried, f.flux, f.volume, f.reduced_excess, f.density, f.viscosity});
  stages.add(both, "density", true, "(3): " + in_words(f.laws, f.scene, f.expected_speed, f.background),
             &Flow::advance_density,
             {f.rate, f.diffusion, f.carried, f.place, p.velocity, f.acceleration, f.shift, *f.excess, *f.phase_number},
             {f.next_excess, f.pressure, f.volume, f.place});
  const int interval = f.options.get<CompressibilityOptions>().filter_interval;
  stages.sweep(both, "density filter", has.shepard,
               has.shepard ? "average of the phase, every " + std::to_string(interval) + " steps"
                           : "compressibility.density_filter is not \"shepard\"",
               &Flow::filter_density, {f.volume, f.density}, {f.next_excess, f.pressure, f.volume},
               [&f, interval] { return f.steps % interval == interval - 1; });
  stages.add(both, "pressure at openings", has.openings, openings, &Flow::find_pressure_behind,
             {p.position, p.velocity, *f.phase_number}, {f.next_excess, f.pressure, f.volume});
  stages.sweep(both, "pressure force", true,
               std::string("(2)") + (has.several ? ", (4)" : "") + ": " + several +
                   (f.still ? ", (16): pressures over a still liquid of " + brief(f.still.density) + " kg/m3" : ""),
               &Flow::find_pressure_force, {f.pressure, f.volume, f.density, f.place}, {f.force, f.concentration});
  stages.sweep(both, "surface tension", has.tension,
               has.tension ? "(11): curvature of the interfaces, force of pairs across them" : no_tension,
               &Flow::add_tension, {f.volume, interfaces}, {f.force, interfaces});
  // Positions and excesses change their memory with f.place and f.next_excess.
  stages.add(both, "acceptance", true, "(6): the new state", &Flow::accept,
             {p.velocity, f.acceleration, f.next_excess, f.force, f.flux, f.concentration, *f.phase_number},
             {p.velocity, f.acceleration, f.shift});
  add_solute_stages(stages, f, has, oxygen::in_words(f.scene), []() -> const oxygen::Supply* { return nullptr; });
  return plan;
}

}  // namespace spume::wcsph
