// SPDX-License-Identifier: MIT
// Cells of a triply periodic box.
#pragma once

#include <array>
#include <cstdint>

#include "spume/core/array.hpp"

namespace spume {

// Cell (i, j, k) covers lower + ([i, i+1) side_x, ...) and has the number (i ny + j) nz + k.
struct PeriodicCells {
  std::array<double, 3> lower{}, length{};
  std::array<int, 3> count{1, 1, 1};

  double side(int axis) const { return length[axis] / count[axis]; }
  std::size_t size() const { return std::size_t(count[0]) * std::size_t(count[1]) * std::size_t(count[2]); }
  std::size_t plane() const { return std::size_t(count[1]) * std::size_t(count[2]); }

  // Sides of at least `least_side`, at most `most_cells` cells in all (one per axis where a side does not fit).
  static PeriodicCells with_side(const std::array<double, 3>& lower, const std::array<double, 3>& length,
                                 double least_side, double most_cells);
};

}  // namespace spume
