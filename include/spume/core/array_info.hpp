// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace spume {

// One array of the state, for `spume check`: exists only because an active stage names it.
struct ArrayInfo {
  std::string name;
  double bytes = 0;
  std::size_t suspended = 0;  // number of point particles that it belongs to; 0: it belongs to the liquid or grid
};

}  // namespace spume
