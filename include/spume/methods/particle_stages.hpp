// SPDX-License-Identifier: MIT
// Stages of a particle method as its plan takes them: work is a member of the flow (without arguments, or of the step's
// length) or a function of StageRun; what packed neighbour records stream is counted on top of the arrays that it
// names.
#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <utility>

#include "spume/methods/stage.hpp"

namespace spume {

// `Flow` has the member `arrangement` (particles/arrangement.hpp) and outlives the plan.
template <class Flow>
class ParticleStages {
 public:
  using Due = std::function<bool()>;

  ParticleStages(Plan& plan, Flow& flow) : plan_(plan), flow_(flow) {}

  template <class Work>
  void add(StagePart part, const char* name, bool on, std::string reason, Work work, Arrays reads, Arrays writes,
           Due due = {}) const {
    const auto counted = [&f = flow_, work](StageRun& run) {
      f.arrangement.packed.take_traffic();
      call(f, work, run);
      run.bytes += f.arrangement.packed.take_traffic();
    };
    plan_.add({name, std::move(reason), on, counted, std::move(reads), std::move(writes), part, std::move(due)});
  }

  // A stage that passes once over the pairs.
  template <class Work>
  void sweep(StagePart part, const char* name, bool on, std::string reason, Work work, Arrays reads, Arrays writes,
             Due due = {}) const {
    const auto paired = [&f = flow_, work](StageRun& run) {
      call(f, work, run);
      run.pairs = f.arrangement.pair_count();
    };
    add(part, name, on, std::move(reason), paired, std::move(reads), std::move(writes), std::move(due));
  }

 private:
  template <class Work>
  static void call(Flow& flow, const Work& work, StageRun& run) {
    if constexpr (std::is_invocable_v<Work, Flow&, double>)
      (flow.*work)(run.dt);
    else if constexpr (std::is_invocable_v<Work, Flow&>)
      (flow.*work)();
    else
      work(run);
  }

  Plan& plan_;
  Flow& flow_;
};

}  // namespace spume
