// SPDX-License-Identifier: MIT
#include "spume/particles/options.hpp"

#include "spume/particles/direct_pressure.hpp"
#include "spume/particles/number_density.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/option.hpp"

namespace spume {

Section pressure_section() {
  using P = PressureOptions;
  const std::string relaxation_text =
      "relaxation time of the number density in steps of courant " + brief(full_displacement) +
      "; with a free surface " + brief(more_steps_below_surface) + " times as long where the liquid is too dense; " +
      shortest(never_relaxed) + ": off";
  const std::string solver_text =
      "of the pressure equation: BiCGStab; conjugate gradients, where its matrix is symmetric; a factorisation, for up "
      "to " +
      std::to_string(most_particles_of_direct_solver(2)) + " particles in 2-D, " +
      std::to_string(most_particles_of_direct_solver(3)) + " in 3-D";
  return section<P>("pressure")
      .word("solver", &P::solver,
            {{"bicgstab", PressureSolver::bicgstab}, {"cg", PressureSolver::cg}, {"direct", PressureSolver::direct}},
            solver_text.c_str())
      .word("preconditioner", &P::preconditioner,
            {{"jacobi", PreconditionerKind::jacobi}, {"multigrid", PreconditionerKind::multigrid}},
            "multigrid: Jacobi plus one V-cycle on cells")
      .when("solver", {"bicgstab", "cg"})
      .word("precision", &P::precision, {{"mixed", Precision::mixed}, {"double", Precision::f64}},
            "mixed: residuals in double, corrections in float")
      .when("solver", {"bicgstab", "cg"})
      .option("tolerance", &P::tolerance, "1", above_up_to(0, 0.1),
              "residual relative to the right-hand side; relative to the divergence removed 1000 times as much will do")
      .option("max_iterations", &P::max_iterations, "", between(1, 1e6), "largest number of iterations per solve")
      .when("solver", {"bicgstab", "cg"})
      .option("cell_ratio", &P::cell_ratio, "spacing", between(1, 8), "side of the multigrid cells")
      .when("preconditioner", {"multigrid"})
      .option("warm_start", &P::warm_start, "initial guess: the last pressure, carried by the particles")
      .when("solver", {"bicgstab", "cg"})
      .option("density_relaxation", &P::density_relaxation, "steps", between(1, never_relaxed),
              relaxation_text.c_str());
}

Section shifting_section(bool removes_drift) {
  using S = ShiftingOptions;
  const std::string limit_text = "largest displacement per step up to courant " + brief(full_displacement) +
                                 "; above it in proportion to the step";
  SectionOf<S> made = section<S>("shifting");
  made.option("on", &S::on, "particle shifting towards a uniform distribution")
      .option("coefficient", &S::coefficient, "1", between(0, 1), "displacement = -coefficient h^2 grad C")
      .when("on", {"true"})
      .option("limit", &S::limit, "h", above_up_to(0, 0.5), limit_text.c_str())
      .when("on", {"true"});
  if (removes_drift)
    made.option("remove_drift", &S::remove_drift,
                "subtract the Shepard mean of the shift: no net transport; not where a body moves in a full tank")
        .when("on", {"true"});
  made.word("velocity_correction", &S::velocity_correction,
            {{"none", ShiftCorrection::none},
             {"first-order", ShiftCorrection::first_order},
             {"second-order", ShiftCorrection::second_order}},
            "Taylor terms of the velocity at the shifted position; the first is bounded by what neighbours ahead and "
            "behind show")
      .when("on", {"true"});
  return made;
}

Section surface_section() {
  using S = SurfaceOptions;
  const std::string threshold_text =
      "div r below which a particle is on the surface; 0: " + brief(surface_threshold_3d) + " in 3-D, " +
      brief(surface_threshold_2d) + " in 2-D";
  return section<S>("surface")
      .option("threshold", &S::threshold, "1", between(0, 3), threshold_text.c_str())
      .option("blend_width", &S::blend_width, "1", between(0, 1), "span of div r over which pressure rows blend");
}

Section interface_section() {
  return section<InterfaceOptions>("interface")
      .behind("surface_tension")
      .option("smoothing", &InterfaceOptions::smoothing, "", between(3, 20),
              "averages of the curvature along the interface");
}

}  // namespace spume
