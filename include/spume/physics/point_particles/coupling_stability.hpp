// SPDX-License-Identifier: MIT
// Stability of two-way coupling. The force on the fluid holds the acceleration of the fluid itself, of a time before
// (de Wit et al. 2024, (12)): what particles of volume fraction alpha give back is
//
//   alpha (du/dt - rho_p/rho_f dV/dt),   between alpha (beta - 1) / 2 du/dt (steps far below the response time)
//                                        and     alpha (1 - rho_p/rho_f) du/dt (far above it)
//
// The paper's condition alpha < 1 is that of bubbles. Heavy particles give back more, with the opposite sign, and
// extrapolation in time amplifies what alternates from step to step: Adams-Bashforth 2 bears a factor of -1/4.
#pragma once

#include "spume/physics/point_particles/motion.hpp"

namespace spume {

// How the flow takes the force: A_n = F + lead (F - F of the step before), in
// u' = u + dt ((1 + memory) A_n - memory A_{n-1}).
struct CouplingScheme {
  double lead = 0.5;
  double memory = 0.5;  // 1/2 with Adams-Bashforth 2, 0 for schemes that hold the force over the step
};

// Largest magnitude of the eigenvalues of a step of fluid and particles at rest but for each other, with uniform
// volume fraction `alpha` and steps of h response times; 1 is neutral (both may move as one).
double coupling_growth(const MotionModel& model, const CouplingScheme& scheme, double alpha, double h);

// The largest step, in response times, up to which no step lets the coupling grow; infinite when all are stable, 0 when
// none is. As volume fractions multiply the acceleration by a factor between their least and largest value, what is
// stable for the largest is stable for a field of them; smaller ones are stable with it.
double stable_coupling_step(const MotionModel& model, const CouplingScheme& scheme, double alpha);

// The largest volume fraction up to `most` that some step is stable with.
double stable_volume_fraction(const MotionModel& model, const CouplingScheme& scheme, double most);

}  // namespace spume
