// SPDX-License-Identifier: MIT
// Which stages a scene needs. The step consults the plan alone; it is printed by `spume check`.
#pragma once

#include <vector>

#include "spume/methods/les_sph/options.hpp"
#include "spume/methods/method.hpp"
#include "spume/physics/bubbles/options.hpp"
#include "spume/physics/turbulence/options.hpp"
#include "spume/scene/case.hpp"

namespace spume::les_sph {

// Steps of pressure.density_relaxation that mean never.
constexpr double never_relaxed = 1e6;

struct Plan {
  bool images = false;           // some side is periodic or a wall, or there are solid boxes
  bool moving_walls = false;     // some wall has a velocity
  bool displaced_walls = false;  // some wall velocity has a normal component
  bool no_slip = false;          // some wall or solid holds the liquid
  bool free_surface = false;
  bool shifting = false;
  bool velocity_gradient = false;  // closure, shift correction, centred steps or bubbles
  bool stored_gradient = false;    // dynamic closures, second-order corrections and bubbles need its components
  bool drift_removal = false;      // of the shift
  bool shift_correction = false;   // velocity follows the shift to first or second order
  bool shift_curvature = false;    // to second order
  bool eddy_viscosity = false;
  bool test_filter = false;         // mixed-scale and dynamic closures
  bool density_relaxation = false;  // of the number density, by the pressure
  bool viscosity = false;
  bool viscous_stress = false;  // div(2 nu S) in place of div(nu grad u)
  bool gravity = false;         // any uniform acceleration
  bool body_force = false;      // varies in space
  bool compressible = false;    // Ma > 0
  bool closed = false;          // pressure known up to a constant
  bool bubbles = false;
  bool mixture_pressure = false;  // closure of the momentum exchange with bubbles

  std::vector<Stage> stages(const LoadedCase& loaded) const;
};

Plan make_plan(const LoadedCase& loaded);

}  // namespace spume::les_sph
