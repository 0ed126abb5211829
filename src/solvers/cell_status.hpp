// SPDX-License-Identifier: MIT
// What a cell of the preconditioner holds.
#pragma once

#include <cstdint>

namespace spume {

enum CellStatus : std::uint8_t { no_liquid = 0, interior_cell = 1, solid_cell = 2, hole = 3 };

inline bool holds_liquid(std::uint8_t status) {
  return status == interior_cell || status == hole;
}

}  // namespace spume
