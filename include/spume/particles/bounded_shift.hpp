// SPDX-License-Identifier: MIT
// Velocities of shifting towards fewer particles (Sun et al. 2019).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace spume {

struct BoundedShift {
  int dimensions = 0;
  double strength = 0, bound = 0;               // delta u = -strength times the gradient, of `bound` at most
  std::array<const float*, 3> concentration{};  // its gradient
  const std::int64_t* left_out = nullptr;       // particles with 0 or more are not shifted; null: all are
  std::array<float*, 3> shift{};                // delta u

  void find(std::size_t first, std::size_t last) const;  // a block at most
};

}  // namespace spume
