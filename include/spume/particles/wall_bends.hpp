// SPDX-License-Identifier: MIT
// Velocities behind the no-slip sides of the domain, where friction is meant.
//
// The image of a particle at a distance s from a side has 2 u_w - u, a velocity odd about the wall, whose curvature
// there is zero. The liquid's is not: with u = u_w + a s + c s^2 + b s^3 before the wall its continuation behind it is
//
//   u_g = 2 u_w - u + e,   e = 2 c s^2.
//
// c is that of the velocities around the particle, by a fit through the velocity of the wall all along it,
//
//   u_j - u_w(foot_j) = s_j p(r_j - foot),   p a polynomial of order 2, or 1 where the particles bear no more,
//
// which is the moving-least-squares fit of (u_j - u_w) / s_j with the weights s_j^2 W_j. Without e friction on a side
// is too low where the first rows of particles resolve a boundary layer: plane Poiseuille flow of 20 spacings errs by
// 0.66 % in place of 0.29 %, and a cavity at Re = 3200 on 80 x 80 has 9 % less kinetic energy. Images in several
// sides take the bend of each, reflected in the others. Solid boxes have none; walls of bodies have bends of their own
// (operators/wall_stencils.hpp).
#pragma once

#include "spume/particles/boundary.hpp"

namespace spume {

// Whether a side of the domain is no-slip.
bool has_no_slip_sides(const Domain& domain);

class WallBends {
 public:
  // Both outlive it.
  WallBends(const Boundary& boundary, const Resolution& resolution) : boundary_(boundary), resolution_(resolution) {}

  // For the images as they are, of particles at `at` with this velocity; `t` is its time.
  // Precondition: `arrangement` is sorted by `at`, its lists are those there.
  void find(const Arrangement& arrangement, const VectorField& at, const std::array<const double*, 3>& velocity,
            double t, ScratchPool& scratch);

  // Boundary::velocity_rule() with e.
  const VelocityImageRule& rule() const { return rule_; }
  double bytes() const;

 private:
  // Per axis and component, of each particle: e at the side of that axis that it is near, 0 elsewhere.
  using Bends = std::array<FloatVectorScratch, 3>;
  template <int dimensions>
  void fit_bends(const Arrangement& arrangement, const VectorField& at, const std::array<const double*, 3>& velocity,
                 Bends& bends) const;
  void add(const Images& images, const Bends& bends);
  void find_wall_velocities(std::size_t count, const VectorField& at, double t);

  const Boundary& boundary_;
  const Resolution& resolution_;
  VelocityImageRule rule_;
  std::array<std::array<Array<Vec3>, 2>, 3> wall_velocity_;  // of no-slip sides that move, per particle near them
};

}  // namespace spume
