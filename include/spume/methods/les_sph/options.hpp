// SPDX-License-Identifier: MIT
// Options of the semi-implicit scheme alone. Those of its parts: particles/options.hpp, physics/turbulence/options.hpp,
// physics/bubbles/options.hpp.
#pragma once

#include "spume/particles/options.hpp"

namespace spume {

// nu dt / h^2 at which the explicit diffusion becomes unstable: 0.29 on a lattice in 3-D, 0.31 in 2-D.
inline constexpr double largest_stable_viscous = 0.3;

// What the scheme adds to [time].
struct SchemeOptions {
  bool centred = true;   // velocities free of divergence half a step ahead: second order in time
  double viscous = 0.2;  // of h^2 / nu, King (3.18)
};

Section scheme_section();

}  // namespace spume
