// SPDX-License-Identifier: MIT
// The stages of what a liquid carries (physics/solutes), behind those that accept a step; and the one that takes the
// place of all others while a recorded flow carries it.
#pragma once

#include "spume/methods/particle_stages.hpp"
#include "spume/physics/solutes/solutes.hpp"

namespace spume {

// `Flow` has, beside what ParticleStages asks for, `solutes`, `scene`, `particles`, `time`, `steps`, and the work
// transport_scalars(dt), which returns its sweeps, and transfer_oxygen(dt). `bubbles`: asked for discrete ones, null
// without.
template <class Flow>
void add_solute_stages(const ParticleStages<Flow>& stages, Flow& f, const SoluteFeatures& has,
                       const std::string& oxygen_from, const std::function<const oxygen::Supply*()>& bubbles) {
  using enum StagePart;
  // Values, rates and changes of so many scalars.
  const auto values = [&f](std::size_t count) {
    return Arrays{ArrayUse([&f, count] { return 16.0 * static_cast<double>(f.particles.size() * count); })};
  };
  const Arrays scalars = values(f.solutes.count()), oxygen = values(has.oxygen ? 1 : 0),
               sludge = values(has.biokinetics ? std::size_t{biokinetics::asm1::components} : 0);
  stages.add(
      step, "scalars", has.scalars, has.scalars ? "diffusion, their change by the shift, and sources" : "no [[scalar]]",
      [&f](StageRun& run) {
        run.pairs = f.arrangement.pair_count() * static_cast<double>(f.transport_scalars(run.dt));
      },
      scalars, scalars);
  stages.add(step, "oxygen", has.oxygen, has.oxygen ? oxygen_from : "no section [oxygen]", &Flow::transfer_oxygen,
             oxygen, oxygen);
  stages.add(
      step, "reactions", has.biokinetics, has.biokinetics ? "Activated Sludge Model No. 1" : "no section [biokinetics]",
      [&f](StageRun& run) { f.solutes.sludge->react(run.dt); }, sludge, sludge);
  const bool records = has.recorded_flow;
  const std::string none = "no section [recorded_flow]";
  const ArrayUse record([&f, records] { return records ? f.solutes.recorded->bytes() : 0.0; });
  stages.add(
      step, "record of the flow", records, records ? f.solutes.recorded->in_words() : none,
      [&f, bubbles](StageRun& run) { f.solutes.record(f.time, run.dt, bubbles()); }, {f.particles.position}, {record},
      [&f] { return f.solutes.recorded->records(f.time); });
  stages.add(
      recorded, "recorded flow", records, records ? "in place of all others behind the record" : none,
      [&f](StageRun& run) {
        f.solutes.recorded->advance(f.time, run.dt);
        f.time += run.dt;
        ++f.steps;
      },
      {record}, scalars);
}

}  // namespace spume
