// SPDX-License-Identifier: MIT
#include "spume/methods/stage.hpp"

#include <stdexcept>

namespace spume {

void Plan::add(Stage stage) {
  for (const Stage& other : stages_)
    if (other.name == stage.name) throw std::logic_error("the plan has two stages named '" + stage.name + "'");
  if (stage.on && !stage.work) throw std::logic_error("stage '" + stage.name + "' is on and does nothing");
  stages_.push_back(std::move(stage));
}

void Plan::run(StagePart part, double dt, double particles, Ledger& ledger) const {
  for (const Stage& stage : stages_) {
    if (!stage.on || (stage.part != StagePart::both && stage.part != part)) continue;
    auto scope = ledger.time(stage.name, particles);
    StageRun run{.dt = dt};
    // What a stage reads last it may release, and what it writes it may lease.
    for (const ArrayUse& use : stage.reads) run.bytes += use.bytes();
    stage.work(run);
    for (const ArrayUse& use : stage.writes) run.bytes += use.bytes();
    scope.add_pairs(run.pairs);
    scope.add_bytes(run.bytes);
  }
}

}  // namespace spume
