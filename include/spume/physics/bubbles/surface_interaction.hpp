// SPDX-License-Identifier: MIT
// Bubbles below a free surface: approach, rest, bursting (King et al. 2022, section 3.4.3).
#pragma once

#include "spume/physics/bubbles/forces.hpp"
#include "spume/scene/scene.hpp"

namespace spume::bubbles {

struct SurfaceModel {
  double spacing = 0;           // dr of the threshold age T_c = dr / |u_rel . n|
  double persistence_unit = 0;  // T_p = persistence_unit sqrt(a)
};

// tension^(-3/4) nu |g|^(-1/4) Sc: King (3.34), Poulain et al. 2018, with all units; Sc to the first power. Zero
// without gravity or tension, where nothing drains the film or nothing holds it.
double persistence_unit(double tension, double viscosity, double gravity, double schmidt);

struct SurfaceContact {
  Braking braking;
  double merge_time = 0;  // t_m, or not_merging
  bool bursts = false;
};

// proximity: psi = |n_b| / |n0|, near 1 at a plane surface. `normal` is the unit normal, `relative_velocity` u_l - u_b.
SurfaceContact approach_surface(const SurfaceModel& model, double proximity, const Vec3& normal,
                                const Vec3& relative_velocity, double radius, double age, double merge_time, double t,
                                double dt);

}  // namespace spume::bubbles
