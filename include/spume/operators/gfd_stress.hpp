// SPDX-License-Identifier: MIT
// Diffusion of momentum by generalised finite differences (operators/gfd_moments.hpp), Joubert et al., equations (9),
// (12) and (19), and the form that converges at sharp interfaces. With d = r_j - r_i,
//
//   <lap u>    = f sum_j (u_j - u_i) W (1 + d . o)                                                     (9)
//   <mu lap u> = f sum_j mu_ij (u_j - u_i) W (1 + d . o),  mu_ij = 2 mu_i mu_j / (mu_i + mu_j)          (12)
//
// (12) is printed with u_i - u_j, the negative of this. It stands for div(mu grad u), and what it lacks of the shear
// divergence div(2 mu T), T = (grad u + (grad u)^T) / 2, is (grad u)^T . grad mu, which vanishes in plane shear and not
// on a curved interface:
//
//   split         <mu lap u> + (grad u)^T . <grad mu>,  component a: sum_b d u_b / d x_a  d mu / d x_b
//   rotation_free <mu lap u> + (grad u)^T . f sum_j mu_ij d W (1 + d . o)
//   printed       <grad mu> . 2 T + mu <lap u>                                                         (19)
//   mu_laplacian  <mu lap u>
//   laplacian     mu <lap u>
//
// The velocity gradient of rotation_free weighs neighbours by the means of (12),
//
//   grad u = (sum_j mu_ij W d (x) d)^-1 sum_j mu_ij (u_j - u_i) W d,  isotropic where neighbours with viscosity are
//   few.
//
// What multiplies grad mu is continuous across an interface, but over a support the shear of the thinner fluid enters
// it with its curvature, times the larger viscosity. Weighted so, it is that of the thicker fluid: with equal weights a
// drop 100 times as viscous as its surroundings sinks 9.3 and 5.7 % too fast with 8 and 12 spacings a diameter, with
// these 2.3 and 0.1 % (viscous_drop). The split takes equal weights: with these it is within 1.5 % there, but unstable
// in implicit steps of 1000 times the explicit limit (poiseuille_two_phase, 100:1).
//
// At a sharp interface grad mu is a delta and the normal derivative of u jumps: (19) multiplies them, and flows
// computed with it do not converge. The split multiplies the delta by derivatives of the normal velocity alone, which
// are continuous. In a liquid that turns as a rigid body its two terms cancel as far as <grad mu> and the means mu_ij
// agree; what is left grows with the jump. The rotation-free form takes grad mu from the weights of its first term: its
// two terms cancel to rounding.
//
// All of them are divided by the density rho_i of the particle: the result is an acceleration. Without a density it is
// a force per volume. Viscosities (not negative) and densities (positive) are filtered.
#pragma once

#include "spume/operators/gfd_moments.hpp"
#include "spume/operators/image_values.hpp"

namespace spume {

enum class MomentumDiffusion { split, printed, mu_laplacian, laplacian, rotation_free };

struct DiffusionProperties {
  PhaseProperty viscosity;
  const float* density = nullptr;
  // <grad mu / rho> (18), or grad mu without a density: for split and printed where the viscosity varies, and read only
  // there.
  std::array<const float*, 3> viscosity_gradient{};
};

void gfd_stress_sweep(const SweepContext& context, PackedNeighbours& packed,
                      const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                      const GfdStencils& stencils, MomentumDiffusion form, const DiffusionProperties& properties,
                      const std::array<float*, 3>& out);

// f / rho sum_j mu_ij W (1 + d . o): what multiplies -u_i in (12), images counted as particles of their own.
void gfd_diffusion_diagonal(const SweepContext& context, PackedNeighbours& packed, const GfdStencils& stencils,
                            const DiffusionProperties& properties, float* out);

}  // namespace spume
