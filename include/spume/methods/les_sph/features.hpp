// SPDX-License-Identifier: MIT
// What a scene needs of les-sph. Stages and arrays exist by these alone.
#pragma once

#include "spume/methods/les_sph/options.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/physics/solutes/solutes.hpp"
#include "spume/physics/turbulence/options.hpp"
#include "spume/scene/case.hpp"

namespace spume::les_sph {

// What the options alone tell.
bool has_closure(const Case& options);
bool has_bubbles(const Case& options);
bool needs_velocity_gradient(const Case& options);  // of a closure, shift correction, centred steps or bubbles

struct Features : BoundaryFeatures, SoluteFeatures {
  explicit Features(const LoadedCase& loaded);

  bool free_surface = false;
  bool shifting = false;
  bool velocity_gradient = false;  // closure, shift correction, centred steps or bubbles
  bool stored_gradient = false;    // dynamic closures, second-order corrections and bubbles need its components
  bool shift_correction = false;   // velocity follows the shift to first or second order
  bool shift_curvature = false;    // to second order
  bool eddy_viscosity = false;
  bool test_filter = false;         // mixed-scale and dynamic closures, fluctuations of bubbles
  bool density_relaxation = false;  // of the number density, by the pressure
  bool viscosity = false;
  bool viscous_stress = false;  // div(2 nu S) in place of div(nu grad u)
  bool no_slip_bodies = false;
  bool wall_bends = false;  // friction at no-slip sides, of boundary layers that are resolved: no closure, no bubbles
  bool held_by_bodies = false;  // no-slip bodies, and a viscosity that is the same everywhere
  bool potential = false;       // gravity or a body force
  bool body_force = false;
  bool uniform_body_force = false;  // the same everywhere: part of the uniform acceleration
  bool working_forces = false;      // forces whose work the potential energy does not hold
  bool sponges = false;             // layers that damp the velocity
  bool closed = false;              // pressure known up to a constant
  bool moves_in_full_tank = false;  // a body, among liquid that fills its domain: full_tanks.hpp
  bool removes_drift = false;       // what neighbours share of the shift does not stay in it
  bool bubbles = false;
  bool starts_at_rest = false;  // liquid with a level surface beside solid boxes may
};

}  // namespace spume::les_sph
