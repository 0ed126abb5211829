// SPDX-License-Identifier: MIT
// The step, as the list of its stages: velocity Verlet with the density at the middle of the step (Adami et al. 2012),
// one evaluation of the forces. Numbers are those of the README of the method. The first accelerations are those of a
// step of length zero. The same list is what `spume check` prints and what the ledger times.
#include "spume/methods/stage.hpp"
#include "spume/methods/wcsph/wcsph.hpp"

namespace spume::wcsph {
namespace {

using Arrays = std::vector<ArrayUse>;

}  // namespace

using enum StagePart;
Plan make_plan(Flow& f) {
  Plan plan;
  const Features& has = f.features;
  ParticleStore& p = f.particles;
  const auto add = [&](const char* name, bool on, std::string reason, auto work, Arrays reads, Arrays writes,
                       bool sweeps = false, std::function<bool()> due = {}) {
    plan.add({name, std::move(reason), on,
              [&f, work, sweeps](StageRun& run) {
                f.arrangement.packed.take_traffic();
                work(run);
                if (sweeps) run.pairs = f.arrangement.pair_count();
                run.bytes += f.arrangement.packed.take_traffic();
              },
              std::move(reads), std::move(writes), both, std::move(due)});
  };
  const char* const several = has.several ? "several phases" : "one phase";

  add("lists", true, "made anew when a particle has moved by half of lists.skin",
      [&f](StageRun& run) {
        const std::int64_t builds = f.list_builds;
        f.keep_lists(run.dt);
        if (f.list_builds == builds) return;
        run.bytes = f.arrangement.sort_traffic(f.particles) + f.arrangement.image_traffic() +
                    f.arrangement.list_traffic(f.sizes);
      },
      {p.position, p.velocity, f.acceleration, f.listed}, {});
  add("drift", true, "(5), (6): r and u at the middle of the step", [&](StageRun& run) { f.drift(run.dt); },
      {p.position, p.velocity, f.acceleration, f.shift}, {f.half_velocity, f.place});
  add(
      "continuity", true,
      std::string(has.viscosity ? "(1) and the viscous part of (2)" : "(1), inviscid") +
          (has.diffusion ? ", with diffusion of density" : "") + (has.shifting ? ", and what shifting carries" : ""),
      [&](StageRun&) { f.find_rates(); }, {f.half_velocity, *f.excess, *f.phase_number, f.shift},
      {f.rate, f.diffusion, f.viscous_force, f.carried, f.flux, f.way, f.volume, f.reduced_excess, f.density, f.phase,
       f.viscosity},
      true);
  add("density", true, f.laws_in_words(), [&](StageRun& run) { f.advance_density(run.dt); },
      {f.rate, f.diffusion, f.carried, f.way, f.half_velocity, f.place, *f.excess, *f.phase_number},
      {f.next_excess, f.pressure, f.volume, f.half_velocity, f.place});
  const int interval = f.options.get<CompressibilityOptions>().filter_interval;
  add(
      "density filter", has.shepard,
      has.shepard ? "average of the phase, every " + std::to_string(interval) + " steps"
                  : "compressibility.density_filter is not \"shepard\"",
      [&](StageRun&) { f.filter_density(); }, {f.volume, f.phase}, {f.next_excess, f.pressure, f.volume}, true,
      [&f, interval] { return f.steps % interval == interval - 1; });
  add(
      "pressure force", true, std::string("(2)") + (has.several ? ", (4)" : "") + ": " + several,
      [&](StageRun&) { f.find_pressure_force(); }, {f.pressure, f.volume, f.density},
      {f.pressure_force, f.concentration}, true);
  add("acceptance", true, "(6): the new state", [&](StageRun& run) { f.accept(run.dt); },
      {f.half_velocity, f.place, f.next_excess, f.pressure_force, f.viscous_force, f.flux, f.concentration},
      {p.position, p.velocity, f.acceleration, f.shift, *f.excess});
  return plan;
}

}  // namespace spume::wcsph
