// SPDX-License-Identifier: MIT
// Options of the semi-implicit scheme alone. Those of its parts: particles/options.hpp, physics/turbulence/options.hpp,
// physics/bubbles/options.hpp.
#pragma once

#include "spume/particles/options.hpp"

namespace spume {

// What the scheme adds to [time].
struct SchemeOptions {
  bool centred = true;  // velocities free of divergence half a step ahead: second order in time
  double viscous = 0.2;
};

Section scheme_section();

}  // namespace spume
