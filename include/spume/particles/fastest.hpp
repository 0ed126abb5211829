// SPDX-License-Identifier: MIT
// The largest over the particles of what bounds the steps of a weakly compressible flow. Taken block by block, so that
// who writes a state takes them while it is in the cache.
#pragma once

#include <cstddef>

#include "spume/particles/phase_law.hpp"
#include "spume/particles/store.hpp"

namespace spume {

// Of a state that has a NaN the number that it concerns is NaN.
struct Fastest {
  double signal = 0;         // sound speed and |u|
  double speed2 = 0;         // |u|^2
  double transport2 = 0;     // |u + delta u|^2
  double acceleration2 = 0;  // |a|^2
  double strain = 0;         // change of density over PhaseLaw::largest_change()

  struct State {
    int dimensions = 0;
    ParticleLaws law;
    const double* excess = nullptr;
    std::array<const double*, 3> velocity{};
    std::array<const float*, 3> acceleration{};  // null: its number is not wanted
    std::array<const float*, 3> shift{};         // delta u; null: none
  };
  void take(const State& state, std::size_t first, std::size_t last);
  static Fastest of_both(const Fastest& a, const Fastest& b);
};

}  // namespace spume
