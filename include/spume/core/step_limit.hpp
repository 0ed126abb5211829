// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace spume {

// The step a method would take next, and what limits it ("courant", "viscous", "capillary").
struct StepLimit {
  double dt = 0;
  std::string limited_by;
};

}  // namespace spume
