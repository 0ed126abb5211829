// SPDX-License-Identifier: MIT
// Rows of a pressure matrix whose unknown follows from others: particles behind openings, with values as of the points
// of operators/wall_stencils.hpp.
#pragma once

#include <span>

#include "spume/core/parallel.hpp"
#include "spume/operators/wall_stencils.hpp"

namespace spume {

struct TiedRows {
  std::span<const std::int32_t> rows;   // the particle of each point of the stencils; no source is among them
  std::span<const std::int32_t> point;  // of each particle, -1: not tied
  const WallStencils* stencils = nullptr;

  // Sets the values of the rows; `given` false leaves out what is given, as for a change of the pressure.
  template <class T>
  void extend(T* values, bool given) const {
    parallel_for(rows.size(), [&](std::size_t g) {
      values[rows[g]] = static_cast<T>(stencils->pressure(g, static_cast<const T*>(values), given));
    });
  }
};

}  // namespace spume
