// SPDX-License-Identifier: MIT
// Numbers that fill the interval from 0 to 1 evenly however many there are, and that no period meets in one phase.
#pragma once

#include <cmath>

namespace spume {

// What n times the golden ratio is beyond a whole number, n >= 0: in [0, 1).
inline double golden_part(double n) {
  constexpr double ratio = 0.61803398874989485;
  return ratio * n - std::floor(ratio * n);
}

}  // namespace spume
