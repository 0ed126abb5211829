// SPDX-License-Identifier: MIT
// Liquid that leaves through open sides for good: it is removed and counted.
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "spume/core/saved_state.hpp"
#include "spume/particles/store.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

class Spill {
 public:
  using Walls = std::array<std::array<double, 2>, 3>;
  // `walls`: sides of the domain at [axis][end], as they move. All that is given outlives it.
  Spill(const Scene& scene, const Walls& walls);

  // Whether some side but the top is open beside its openings.
  bool possible() const { return possible_; }

  struct Liquid {
    ParticleStore& particles;
    double reach = 0;                               // of particles on each other
    const Array<std::int64_t>* phase = nullptr;     // of each; null: one phase
    const Array<std::int64_t>* left_out = nullptr;  // >= 0: of an opening, which keeps them; null: none
  };
  // Removes who cannot come back: who has fallen below an open bottom by more than the reach, or is farther beyond
  // another open side than the domain is wide. Above an open top liquid under gravity falls back. Returns how many.
  std::size_t remove(const Liquid& liquid, double time);

  // Particles removed since the start, of a phase and of all.
  std::int64_t count(std::size_t phase) const { return count_[phase]; }
  std::int64_t count() const { return std::accumulate(count_.begin(), count_.end(), std::int64_t{0}); }
  // Once, after the first has been removed; empty: nothing to say.
  std::string take_remark();

  void save(StateWriter& writer) const { writer.i64("spill", count_); }
  void load(StateReader& reader);

 private:
  bool has_left(const Liquid& liquid, std::size_t i) const;

  const Scene& scene_;
  const Walls& walls_;
  bool possible_ = false;
  std::vector<std::int64_t> count_;
  std::string remark_;
};

}  // namespace spume
