// SPDX-License-Identifier: MIT
// Motion of small spheres by the Maxey-Riley equation with Stokes drag, added mass, pressure gradient and gravity
// (de Wit et al. 2024, (3) and (4)):
//
//   dV/dt = beta Du/Dt + (u - V) / tau + (1 - beta) g,   dX/dt = V,   beta = 3 / (1 + 2 rho_p / rho_f)
//
// Step from t to t + dt with the fields at both ends known. One gather at the place of half a step, X + V dt / 2, gives
// u and grad u there at mid-step and du/dt over it, hence Du/Dt = du/dt + u . grad u by (15). The velocity relaxes
// exactly towards u, which varies linearly in time along the path, with the rate du/dt + V . grad u:
//
//   V' = e V + (1 - e) u + dt phi1 G + dt h (phi2 - phi1/2) u_t,      G = beta Du/Dt + (1 - beta) g
//   X' = X + dt (phi1 V + (1 - phi1) u + dt phi2 G + dt (phi1/2 - phi2) u_t),
//   h = dt / tau,  e = exp(-h),  phi1 = (1 - e) / h,  phi2 = (1 - phi1) / h
//
// Second order for any tau, stable for any dt / tau; for tau -> 0 the particles become tracers,
// V = u + tau (beta Du/Dt - du/dt along the path).
#pragma once

#include <array>
#include <limits>

#include "spume/operators/spline_field.hpp"
#include "spume/physics/point_particles/kinds.hpp"
#include "spume/physics/point_particles/particles.hpp"
#include "spume/physics/point_particles/self_disturbance.hpp"

namespace spume {

struct MotionModel {
  double beta = 1;
  double response_time = 1;  // tau of the reference diameter; that of others is proportional to diameter squared
  double viscosity = 0;      // kinematic; read by the Schiller-Naumann law alone
  std::array<double, 3> gravity{};
  DragLaw drag = DragLaw::stokes;
  bool frozen = false;  // particles stay where they are, at rest; their force on the fluid is still found

  double density_ratio() const { return (3 / beta - 1) / 2; }  // rho_p / rho_f; infinite for beta = 0
};

// Averages over the particles, of the last step.
struct MotionStatistics {
  double mean_square_velocity = 0;
  double mean_square_acceleration = 0;  // of the particles, (V' - V) / dt
  double mean_square_slip = 0;          // |u - V|^2 at mid-step
  double max_speed = 0;                 // not a number when any velocity is not
};

// What removes the disturbance of each particle from what it sees: its constants, and the step of the flow before.
struct DisturbanceStep {
  const SelfDisturbance* disturbance = nullptr;  // null: particles see the flow as it is
  SelfDisturbance::Step step;
  double force_share = 0;  // of the force and its extrapolation, in the force that the flow had the step before
};

// What two-way coupling needs of a step. The force of a particle on the fluid, per density (8):
//   F = volume (Du/Dt - rho_p/rho_f (V' - V) / dt - (1 - rho_p/rho_f) g)
// is the mean over the step. `amounts` (three numbers a particle) receives F + extrapolation (F - F of the step
// before); extrapolation = 1/2 gives the force at the end of a step of the same length to second order. With a
// `self` they hold, before, the force that the flow had over the step.
struct ForceOutput {
  double* amounts = nullptr;  // null: no force is found
  double extrapolation = 0;
  DisturbanceStep self = {};
};

// Moves the particles from the time of the previous snapshot to that of the present one, dt later. Positions stay in
// the box.
template <class Real>
MotionStatistics move_particles(const MotionModel& model, const SplineField<Real>& field, double dt,
                                Particles& particles, const ForceOutput& output = {});

// Schiller and Naumann (1935): drag over Stokes drag.
double schiller_naumann_factor(double slip, double diameter, double viscosity);

// phi functions of the exponential step for h >= 0, to a few roundings.
struct RelaxationCoefficients {
  double decay;  // exp(-h)
  double phi1;   // (1 - exp(-h)) / h
  double phi2;   // (1 - phi1) / h
};
RelaxationCoefficients relaxation_coefficients(double h);

}  // namespace spume
