// SPDX-License-Identifier: MIT
// Stands in for the header of the same name in spume_bench_minimal: the features of bench/cases/periodic.toml as
// constants. The sources of the method, compiled against it, lose at compile time all that belongs to closures,
// surfaces, walls, body forces and bubbles: the build without that code that the full program is compared with.
#pragma once

#include "spume/methods/les_sph/options.hpp"
#include "spume/physics/turbulence/options.hpp"
#include "spume/scene/case.hpp"

namespace spume::les_sph {

constexpr double never_relaxed = 1e6;

struct Features {
  explicit Features(const LoadedCase&) {}

  static constexpr bool images = true;
  static constexpr bool moving_walls = false;
  static constexpr bool no_slip = false;
  static constexpr bool free_surface = false;
  static constexpr bool shifting = true;
  static constexpr bool velocity_gradient = true;
  static constexpr bool stored_gradient = false;
  static constexpr bool shift_correction = true;
  static constexpr bool shift_curvature = false;
  static constexpr bool eddy_viscosity = false;
  static constexpr bool test_filter = false;
  static constexpr bool density_relaxation = true;
  static constexpr bool viscosity = true;
  static constexpr bool viscous_stress = false;
  static constexpr bool potential = false;
  static constexpr bool body_force = false;
  static constexpr bool uniform_body_force = false;
  static constexpr bool closed = true;
  static constexpr bool bubbles = false;
  static constexpr bool scalars = false;
  static constexpr bool oxygen = false;
  static constexpr bool biokinetics = false;
};

}  // namespace spume::les_sph
