// SPDX-License-Identifier: MIT
// Stands in for the header of the same name in spume_bench_minimal: the plan of bench/cases/periodic.toml as constants.
// The sources of the method, compiled against it, lose at compile time all that belongs to closures, surfaces, walls,
// body forces and bubbles: the build without that code that the full program is held against.
#pragma once

#include <vector>

#include "spume/methods/les_sph/options.hpp"
#include "spume/methods/method.hpp"
#include "spume/physics/bubbles/options.hpp"
#include "spume/physics/turbulence/options.hpp"
#include "spume/scene/case.hpp"

namespace spume::les_sph {

struct Plan {
  static constexpr bool images = true;
  static constexpr bool moving_walls = false;
  static constexpr bool displaced_walls = false;
  static constexpr bool no_slip = false;
  static constexpr bool free_surface = false;
  static constexpr bool shifting = true;
  static constexpr bool velocity_gradient = true;
  static constexpr bool stored_gradient = false;
  static constexpr bool drift_removal = true;
  static constexpr bool shift_correction = true;
  static constexpr bool shift_curvature = false;
  static constexpr bool eddy_viscosity = false;
  static constexpr bool test_filter = false;
  static constexpr bool viscosity = true;
  static constexpr bool viscous_stress = false;
  static constexpr bool gravity = false;
  static constexpr bool body_force = false;
  static constexpr bool compressible = true;
  static constexpr bool closed = true;
  static constexpr bool bubbles = false;
  static constexpr bool mixture_pressure = false;
  static constexpr bool density_relaxation = true;

  std::vector<Stage> stages(const LoadedCase&) const { return {}; }
};

inline Plan make_plan(const LoadedCase&) {
  return {};
}

}  // namespace spume::les_sph
