// SPDX-License-Identifier: MIT
// Options of the parts on the particles floor: a particle method names their sections in its registration.
#pragma once

namespace spume {

struct Section;

enum class PressureSolver { bicgstab, cg, direct };
enum class PreconditionerKind { jacobi, multigrid };
enum class Precision { mixed, f64 };
enum class ShiftCorrection { none, first_order, second_order };

// Steps of PressureOptions::density_relaxation that mean never.
inline constexpr double never_relaxed = 1e6;

struct PressureOptions {
  PressureSolver solver = PressureSolver::bicgstab;
  PreconditionerKind preconditioner = PreconditionerKind::multigrid;
  Precision precision = Precision::mixed;
  double tolerance = 1e-6;  // residual relative to the right-hand side
  // Per solve. Jacobi takes 101 for 256,000 particles at Ma = 0, and with the cube root of their number 400 for sixteen
  // million; multigrid takes 6 to 18. What needs more does not converge.
  int max_iterations = 500;
  // Multigrid cell side / spacing. 55,296 particles with a free surface, Ma = 0.05: 6 iterations with 1.5, 7 with 2.
  double cell_ratio = 1.5;
  bool warm_start = true;
  double density_relaxation = 30;  // cases/lid_driven_cavity/README.md has the errors with 10 to 100
};

struct ShiftingOptions {
  bool on = true;
  double coefficient = 0.25;  // displacement = -coefficient h^2 grad C: King (3.12)
  // Largest displacement / h per step. 0.05 to 0.2 change the kinetic energy of taylor_green_2d (1/50, t = 1) by 0.3 %,
  // of a collapsing column (1/40, t = 2) by 3 %; 0.025 costs the former 5 %, 0.5 the latter 6 %.
  double limit = 0.1;
  bool remove_drift = true;                                            // subtract what neighbours share of the shift
  ShiftCorrection velocity_correction = ShiftCorrection::first_order;  // Taylor terms of u at the new place
};

// Standard values of SurfaceOptions::threshold; particles/surface.cpp tells why.
inline constexpr double surface_threshold_3d = 2.3, surface_threshold_2d = 1.5;

struct SurfaceOptions {
  double threshold = 0;       // div r below which a particle is a surface particle; 0: the standard value
  double blend_width = 0.32;  // half of what lies between 2.3 and the 2.94 of the bulk in 3-D
};

// Of [interface], beside the tension: particles/interface_potential.hpp.
struct InterfaceOptions {
  // Passes of the average that continues the curvature across the band. What they take of long waves is given back,
  // which makes too much of waves of 10 spacings: 1.11 times with 4 passes, 1.16 with 3, 1.26 with 2. With 3 a
  // capillary wave of 64 spacings loses 15 % of its damping to such waves, with 4 none.
  int smoothing = 4;
};

Section pressure_section();
// Of a method without free surfaces, which shifts in full, remove_drift is no option.
Section shifting_section(bool removes_drift = true);
Section surface_section();
Section interface_section();

}  // namespace spume
