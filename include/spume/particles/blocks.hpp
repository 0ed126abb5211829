// SPDX-License-Identifier: MIT
// Blocks of particles that a pass takes through the nearest cache, several particles at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "spume/core/parallel.hpp"
#include "spume/core/size_bits.hpp"

namespace spume {

using ParticleBlock = std::array<double, default_block>;
using VectorBlock = std::array<ParticleBlock, 3>;

// The largest of what term(axis)(i) gives for particles first .. last - 1, at most a block of them, squared and summed
// along the axes in order; NaN where one is. The sums are left in `sum`, that of particle first in front.
template <class Term>
[[gnu::always_inline]] inline double largest_square(int dimensions, std::size_t first, std::size_t last,
                                                    ParticleBlock& sum, Term&& term) {
  double* const sums = sum.data();
  const std::size_t n = last - first;
  for (int axis = 0; axis < dimensions; ++axis) {
    const auto of = term(axis);
    if (axis == 0) {
      for (std::size_t k = 0; k < n; ++k) sums[k] = of(first + k) * of(first + k);
    } else {
      for (std::size_t k = 0; k < n; ++k) sums[k] += of(first + k) * of(first + k);
    }
  }
  return largest_size(sums, 0, n);
}

// Calls use(from, to) for the blocks of first .. last - 1.
template <class Use>
void each_block(std::size_t first, std::size_t last, Use&& use) {
  for (std::size_t to = first; first < last; first = to) {
    to = std::min(last, first + default_block);
    use(first, to);
  }
}

}  // namespace spume
