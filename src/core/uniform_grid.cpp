// SPDX-License-Identifier: MIT
#include "spume/core/uniform_grid.hpp"

#include <cmath>
#include <string>

#include "spume/core/error.hpp"

namespace spume {

void require_valid(const UniformGrid& grid) {
  if (grid.dimensions != 2 && grid.dimensions != 3)
    throw InputError("the grid has " + std::to_string(grid.dimensions) + " dimensions; expected 2 or 3");
  for (int axis = 0; axis < grid.dimensions; ++axis) {
    const std::string name(1, "xyz"[axis]);
    if (grid.points[axis] == 0) throw InputError("the grid has no points along " + name + "; expected at least 1");
    if (!(grid.length(axis) > 0) || !std::isfinite(grid.length(axis)))
      throw InputError("the grid has length " + std::to_string(grid.length(axis)) + " along " + name +
                       "; expected upper > lower, both finite");
  }
  if (grid.dimensions == 2 && grid.points[2] != 1)
    throw InputError("a grid in two dimensions has " + std::to_string(grid.points[2]) + " points along z; expected 1");
}

}  // namespace spume
