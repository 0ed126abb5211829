// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>

namespace spume {

// Names of the two sides of an axis: left/right, front/back (3-D), bottom/top.
std::array<std::string, 2> side_names(int axis, int dimensions);

}  // namespace spume
