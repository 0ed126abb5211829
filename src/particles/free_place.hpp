// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>

#include "spume/core/vectors.hpp"

namespace spume {

// A place near `point` for which `free` holds, on the smallest circle (sphere) around it that has one: radii of
// multiples of `step` up to 32, in 16 directions (2-D) or those to the 26 neighbours of a cell (3-D), the first in a
// fixed order. Nothing where none is found.
std::optional<Vec3> free_place_near(const Vec3& point, int dimensions, double step,
                                    const std::function<bool(const Vec3&)>& free);

}  // namespace spume
