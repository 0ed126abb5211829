// SPDX-License-Identifier: MIT
// Options of the parts on the particles floor: a particle method names their sections in its registration.
#pragma once

namespace spume {

struct Section;

enum class PressureSolver { bicgstab, cg };
enum class PreconditionerKind { jacobi, multigrid };
enum class Precision { mixed, f64 };
enum class ShiftCorrection { none, first_order, second_order };

struct PressureOptions {
  PressureSolver solver = PressureSolver::bicgstab;
  PreconditionerKind preconditioner = PreconditionerKind::multigrid;
  Precision precision = Precision::mixed;
  double tolerance = 1e-6;  // residual relative to the right-hand side
  int max_iterations = 500;
  double cell_ratio = 1.5;  // multigrid cell side / spacing
  bool warm_start = true;
  double density_relaxation = 30;
};

struct ShiftingOptions {
  bool on = true;
  double coefficient = 0.25;                                           // displacement = -coefficient h^2 grad C
  double limit = 0.1;                                                  // largest displacement / h per step
  bool remove_drift = true;                                            // subtract what neighbours share of the shift
  ShiftCorrection velocity_correction = ShiftCorrection::first_order;  // Taylor terms of u at the new place
};

struct SurfaceOptions {
  double threshold = 0;  // div r below which a particle is a surface particle; 0: 2.3 in 3-D, 1.5 in 2-D
  double blend_width = 0.32;
};

Section pressure_section();
Section shifting_section();
Section surface_section();

}  // namespace spume
