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

void Plan::repeat(std::function<bool()> more, const std::function<void()>& body) {
  const std::size_t loop = loops_.size();
  loops_.push_back({stages_.size(), stages_.size(), std::move(more)});
  body();
  loops_[loop].last = stages_.size();
  if (loops_[loop].first == loops_[loop].last) throw std::logic_error("the plan repeats nothing");
}

void Plan::list(Ledger& ledger) const {
  for (const Stage& stage : stages_)
    if (stage.on) ledger.list(stage.name);
}

// Stages first to last (exclusive), where `loop` is the first loop that begins at `first` or later.
void Plan::run_range(const Run& run, std::size_t first, std::size_t last, std::size_t loop) const {
  for (std::size_t at = first; at < last;) {
    if (loop == loops_.size() || loops_[loop].first != at) {
      run_stage(run, stages_[at++]);
      continue;
    }
    const Loop& body = loops_[loop];
    while (body.more()) run_range(run, body.first, body.last, loop + 1);
    at = body.last;
    while (loop < loops_.size() && loops_[loop].first < at) ++loop;
  }
}

void Plan::run_stage(const Run& run, const Stage& stage) const {
  const bool of_the_flow = run.part == StagePart::step || run.part == StagePart::start;
  const bool belongs = stage.part == run.part || (stage.part == StagePart::both && of_the_flow);
  if (!stage.on || !belongs) return;
  if (stage.due && !stage.due()) return;
  auto scope = run.ledger.time(stage.name);
  StageRun counted{.dt = run.dt, .particles = run.particles, .go_on = run.go_on};
  // What a stage reads last it may release, and what it writes it may lease.
  double named = 0;
  for (const ArrayUse& use : stage.reads) named += use.bytes();
  stage.work(counted);
  for (const ArrayUse& use : stage.writes) named += use.bytes();
  counted.bytes += named;
  scope.add_particles(counted.particles);
  scope.add_pairs(counted.pairs);
  scope.add_bytes(counted.bytes);
}

}  // namespace spume
