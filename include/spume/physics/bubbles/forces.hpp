// SPDX-License-Identifier: MIT
// Motion of one bubble in a liquid known around it (King et al. 2022, section 2.2, with 3.4.3):
//
//   (1 + C_vm beta) V du_b/dt = F_d + F_l + C_vm beta V Du_l/Dt + F_g [+ beta V Du_l/Dt] + F_fs
//   F_d = 3/8 C_d / a beta V |w| w,  F_l = C_l beta V w x (curl u_l),  F_g = (1 - beta) V g,   w = u_l - u_b,
//
// forces over the density of the gas, beta the density of the liquid over it. The added term in brackets is the
// force of the accelerating liquid on the volume of the bubble without its hydrostatic part, which F_g holds.
#pragma once

#include "spume/physics/bubbles/options.hpp"

namespace spume::bubbles {

struct Gas {
  double density_ratio = BubbleOptions{}.density_ratio;  // beta
  double viscosity = 0;                                  // kinematic, of the liquid; > 0
  double lift = BubbleOptions{}.lift_coefficient;
  double virtual_mass = BubbleOptions{}.virtual_mass_coefficient;
  bool fluid_inertia = false;
  Vec3 gravity{};
};

// The liquid at the bubble; the velocity includes what is not resolved.
struct Surroundings {
  Vec3 velocity{}, vorticity{}, acceleration{};
};

// Braking below a free surface, King (3.32) with the signed u_rel . n: the part `share` of all force along `normal`
// gives way to a relaxation of the relative normal velocity over `time_left`, which ends at zero when it is linear.
struct Braking {
  double share = 0;  // (1 + erf(2 ln(5 psi))) / 2; 0: none
  Vec3 normal{};     // unit vector
  double time_left = 0;
};

// C_d of King (2.9), with its jump from 0.438 to 0.44 at Re_b = 1000.
double drag_coefficient(double bubble_reynolds);
// 3/8 C_d |w| / a: what multiplies beta w in the drag per volume. At w = 0 that of Stokes, 9 nu / (2 a^2).
double drag_rate(double speed, double radius, double viscosity);
// Time in which a slow bubble follows the liquid: (1/beta + C_vm) / drag_rate(0).
double relaxation_time(const Gas& gas, double radius);
// Root of the balance of drag and buoyancy: drag_rate(w) w = (1 - 1/beta) |g|.
double terminal_speed(const Gas& gas, double radius);

// Velocity after dt. Relaxation and rotation of w solved in closed form with one drag rate, which is the mean of the
// rates at the start and at the end for short steps and that at the end for long ones: second order in dt, the exact
// terminal velocity, and |w| bounded for any dt. Costs the same for every radius.
Vec3 advance_stable(const Gas& gas, double radius, const Surroundings& liquid, const Vec3& velocity, double dt,
                    const Braking& braking);

// Explicit Euler overshoots with one sub-step per relaxation time of the fastest motion and is unstable with a half.
inline constexpr double substeps_per_relaxation = 1.5;

// The same by explicit Euler in ceil(spacing / radius) sub-steps, more where these would be unstable.
Vec3 advance_substepped(const Gas& gas, double radius, const Surroundings& liquid, const Vec3& velocity, double dt,
                        double spacing, const Braking& braking);

// F_fs of King (3.32) per volume of the bubble, over the density of the liquid, at the end of a step dt that led to
// `velocity` from the relative normal velocity `slip_normal` = (u_l - u_b) . n.
Vec3 braking_force(const Gas& gas, double radius, const Surroundings& liquid, const Vec3& velocity, double slip_normal,
                   double dt, const Braking& braking);

// Mean force of the bubble on the liquid over the step, over the density of the liquid, for a velocity that changed by
// `change` in dt: V (-change / (dt beta) + (1 - beta)/beta g), whatever the integrator. `pressure_holds_inertia`: the
// liquid feels the reaction to the fluid inertia through its pressure term (momentum form two-fluid). It holds the
// reaction to F_fs, as King (3.33); add V braking_force where the surface bears that.
Vec3 reaction(const Gas& gas, double volume, const Surroundings& liquid, const Vec3& change, double dt,
              bool pressure_holds_inertia);

}  // namespace spume::bubbles
