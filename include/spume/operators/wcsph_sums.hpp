// SPDX-License-Identifier: MIT
// The two sums of multiphase weakly compressible SPH. With d = r_j - r_i and g = -V F(q) sigma / h^(d+2) >= 0, the
// particle volume times the kernel gradient is V grad_i W_ij = g d; v = V_j / V is the volume of a particle over that
// at rest, s = rho / rho_0 - 1 its density excess.
//
//   rate of density   (d ln rho / dt)_i = - sum_j v_j g (u_j - u_i) . d
//                     with a shift less the trace of (sum v_j g d (x) (u_j - u_i)) (sum v_j g d (x) d)^-1, exact for
//                     linear velocities: an arrangement that the flow has stretched shows no divergence of its own
//   its diffusion     sum_j 2 v_j g (s'_j - s'_i), j of the phase of i, s' the excess less its hydrostatic part
//   viscous force     V_i (rho du / dt)_i / V_i = sum_j 2 v_j g mu_ij (u_j - u_i), mu_ij the harmonic mean
//   carried by shift  (delta u . grad s')_i = sum_j v_j g (s'_j - s'_i) delta u_i . d, j of the phase of i
//   momentum flux     of one phase (div (u (x) delta u))_i = sum_j v_j g (u_i delta u_i . d + u_j delta u_j . d);
//                     of several (delta u . grad) u by the gradient of the rate, exact for linear velocities: particles
//                     carry no momentum across an interface
//   concentration     h (grad C)_i = h sum_j v_j g d, C = sum_j V_j W_ij over all phases
//   pressure force    (rho du / dt)_i = - sum_j v_j g (P_i + P_j + R_ij) d,
//                     R_ij = eps |kappa_ij| |P_i + P_j|   (Monaghan 2013)
//   weighted          of the densities of two phases, kappa_ij = (rho0_j - rho0_i) / (rho0_i + rho0_j):
//                     P_i + P_j + kappa_ij (P_i - P_j) in the force and in R_ij, (1 + kappa_ij) (u_j - u_i) in the
//                     rate, without shift
//   tension           (rho du / dt)_i = sum_j v_j g (phi_i + phi_j) / 2 (c_j - c_i) d, c_i 1 in one phase and 0
//                     elsewhere, phi = sigma kappa (particles/interface_potential.hpp)
//
// Where phi is uniform the tension is what the pressure phi c does to the neighbours of the other phase, term by term:
// with the pressure phi c the forces of a drop are -2 phi c_i sum_j v_j g d, those of a liquid under the pressure phi,
// whatever the densities. It is a force on the interface: to pairs it is not antisymmetric.
//
// Weighted, the pressure of a pair is that where the phases meet if the acceleration grad P / rho is continuous there
// (Hu and Adams 2007), and its velocity the mean by mass: force and rate are adjoint, as without. Unweighted, liquid at
// rest presses the gas beside it with an acceleration of some g times the ratio of densities.
//
// The diffusion is that of Molteni and Colagrossi (2009) without the hydrostatic part (Fourtakas et al. 2019); the
// viscous force that of Morris et al. (1997); the momentum flux of a transport velocity u + delta u that of Adami, Hu
// and Adams (2013). Forces and the flux of one phase times V_i are antisymmetric. Results do not depend on the thread
// count. Particles are of one size and the kernel is Wendland's C2; throws std::logic_error otherwise.
#pragma once

#include <array>

#include "spume/core/vec3.hpp"
#include "spume/operators/image_values.hpp"
#include "spume/operators/interface_bands.hpp"
#include "spume/operators/pair_sweep.hpp"

namespace spume {

// Wall points (SweepContext::walls) have the averages of the liquid around them. To each particle they are of its own
// phase: no repulsion, its viscosity. Density does not diffuse to them where a phase is given. In the rate they may
// move with their walls instead: the part that WallAverages::add_rates() then adds makes it adjoint to the pressure
// force.
//
// Per particle. Images have the values of their sources, and velocities by the rules.
struct ContinuityFields {
  std::array<const double*, 3> velocity{};
  // What the velocity has beside it, `ahead` times a; null: nothing. Not beside wall points.
  std::array<const float*, 3> acceleration{};
  double ahead = 0;
  const VelocityImageRule* mirror = nullptr;                      // of rates of volume
  bool walls_move = false;                                        // wall points with their walls, in the rate
  const VelocityImageRule* friction = nullptr;                    // of the viscous force; null: as in the rate
  const float* volume = nullptr;                                  // v
  const float* excess = nullptr;                                  // s'
  const float* phase = nullptr;                                   // what tells phases apart; null: one phase
  bool weighted = false;                                          // `phase` is rho_0, of no two phases alike
  const float* viscosity = nullptr;                               // mu; null: that of all
  float common_viscosity = 0;                                     // of one phase, beside walls too; 0: inviscid
  std::array<const float*, 3> shift{};                            // delta u; null: none
  const std::vector<std::array<float, 3>>* reflection = nullptr;  // of delta u
};
struct ContinuityOut {
  float* rate = nullptr;            // d ln rho / dt
  float* diffusion = nullptr;       // the sum above
  std::array<float*, 3> viscous{};  // the sum above; null without viscosity
  float* carried = nullptr;         // the sum above; this and the flux null without shift
  std::array<float*, 3> flux{};
};
void continuity_sweep(const SweepContext& context, PackedNeighbours& packed, const ContinuityFields& fields,
                      const ContinuityOut& out);

struct PressureFields {
  const float* pressure = nullptr;
  Vec3 left_out{};                 // gradient of a pressure, linear in space, that `pressure` is without
  const float* volume = nullptr;   // v
  const float* density = nullptr;  // rho_0; null: of one phase without gravity and walls of bodies
  bool several = false;            // phases: repulsion between them
  bool weighted = false;           // between phases
  float repulsion = 0;             // eps
  // Forces that `out` has beside that of pressure, `out` itself among them; null: none.
  std::array<const float*, 3> others{};
  // Images at mirrors continue the pressure of their source, a particle or a wall point, by
  // (density gravity - left_out) . (r_image - r_source), as Adami et al. (2012) do at walls.
  Vec3 gravity{};
  std::array<const double*, 3> position{};
  // Per wall point; null without.
  const double* wall_pressure = nullptr;
  const double* wall_density = nullptr;
  std::array<const double*, 3> wall_position{};
};
// out: (rho du/dt)_i by pressure. concentration: h grad C; null: not wanted.
void pressure_force_sweep(const SweepContext& context, PackedNeighbours& packed, const PressureFields& fields,
                          const std::array<float*, 3>& out, const std::array<float*, 3>& concentration = {});

struct TensionFields {
  const float* volume = nullptr;     // v
  const float* colour = nullptr;     // c
  const float* potential = nullptr;  // phi; read at the varying particles of the bands
};
// Adds the tension to out at the mixed particles of the bands. No wall points.
void tension_force_sweep(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                         const TensionFields& fields, const std::array<float*, 3>& out);

// The Shepard filter of the density over the particles of the same phase, itself included:
//   out = sum_j m_j W / sum_j V_j W / rho_0 - 1 = sum_j W (1 - v_j) / sum_j v_j W.
void density_filter_sweep(const SweepContext& context, PackedNeighbours& packed, const float* volume,
                          const float* phase, float* out);

}  // namespace spume
