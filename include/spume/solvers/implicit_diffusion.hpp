// SPDX-License-Identifier: MIT
// Diffusion of momentum over a step at the velocity that it leads to, by backward Euler. With M u = <mu lap u> / rho
// (operators/gfd_stress.hpp, (12)), u the velocity at the start of the step and b what the explicit step would add to
// it,
//
//   (1 - dt M) w = b,   u + w in place of u + b.
//
// What b holds beside dt M u, the part (grad u)^T . grad mu of the stress among it, is that of u: lagged. In the energy
// norm the quadratic form of that part, the integral of mu grad u : (grad u)^T, is bounded by that of M, the integral
// of mu |grad u|^2, so that a mode of b = dt (M + E) u is multiplied by (1 + dt E) / (1 - dt M), not above one. M takes
// velocities odd about no-slip bodies, which b has as cubics: their bound is not linear, as BiCGStab needs it, and the
// stiffest mode of b is 1.4 times that of M (-9.2 / h^2 for -6.6 / h^2), less than the 2 that is stable.
#pragma once

#include "spume/core/scratch_pool.hpp"
#include "spume/operators/gfd_stress.hpp"
#include "spume/solvers/krylov.hpp"

namespace spume {

struct DiffusionStep {
  const SweepContext& context;
  PackedNeighbours& packed;
  const VelocityImageRule& rule;  // of velocities under friction; the motion of walls is left out: it is part of b
  GfdStencils stencils;
  DiffusionProperties properties;  // the gradient of the viscosity is not read
  double dt = 0;
};

class ImplicitDiffusion {
 public:
  // b, one component after the other, each with an entry a particle.
  Array<float>& change() { return change_; }
  // b becomes w - b = dt M w. BiCGStab in float with the diagonal as preconditioner. What did not converge is said in
  // the report.
  void solve(const DiffusionStep& step, ScratchPool& scratch);

  const KrylovResult& report() const { return report_; }
  double bytes() const { return work_.bytes() + change_.bytes() + solution_.bytes() + diagonal_.bytes(); }

 private:
  struct Operator;
  KrylovResult report_;
  VelocityImageRule homogeneous_;
  // Three entries a particle in 3-D, one in most other leases: memory of its own.
  KrylovWorkspace<float> work_;
  Array<float> change_, solution_, diagonal_;
};

}  // namespace spume
