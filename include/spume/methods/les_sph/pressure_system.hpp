// SPDX-License-Identifier: MIT
// The pressure equation of a step, King (3.17) with alpha = 1, for q = p + potential:
//
//   -lap q + M p = -div u* / dt + M p^n,   M = 1 / (c dt)^2  (zero when incompressible),
//
// rho = 1 here; p is divided by the density on the way in and multiplied on the way out. Rows are divided by
// d / div r, which makes the Laplacian exact for quadratic fields up to the anisotropy of the arrangement, and
// multiplied by the particle volume, which makes the matrix symmetric. p = 0 on the free surface enters by mirrored
// liquid (free_surface.hpp); particles with too few neighbours for that hold p = 0 themselves.
#pragma once

#include <memory>
#include <string>

#include "spume/core/ledger.hpp"
#include "spume/methods/les_sph/liquid.hpp"
#include "spume/operators/pressure_operator.hpp"
#include "spume/solvers/cell_multigrid.hpp"
#include "spume/solvers/refinement.hpp"

namespace spume::les_sph {

class PressureSystem {
 public:
  explicit PressureSystem(const Liquid& liquid);

  // Velocity at r* of a step dt -> liquid.reduced_pressure. Throws StepFailure when the solve does not converge.
  void solve_step(Liquid& liquid, double dt, Ledger& ledger);

  // The pressure that the present velocity field needs: lap p = -tr(grad u . grad u), incompressible.
  void solve_initial(Liquid& liquid, Ledger& ledger);

  const RefinementResult& report() const { return report_; }
  double bytes() const;

 private:
  struct Operator;
  struct DoubleOperator;
  class Refined;

  void set_matrix(const Liquid& liquid, double helmholtz);
  void add_gradient_trace(Liquid& liquid, double factor);
  void set_right_hand_side(const Liquid& liquid, double helmholtz, double source_scale);
  // Preconditioner setup and solve, timed apart: the solve under the name `stage`.
  void solve(Liquid& liquid, double helmholtz, const char* stage, Ledger& ledger);
  void demand_convergence(const std::string& solve) const;
  void remove_constant(Liquid& liquid) const;
  void set_weights(const Liquid& liquid);

  Array<double> right_hand_side_, residual_;  // the first holds the divergence while that is found
  Array<double> surface_source_;              // per edge particle
  Array<float> potential_laplacian_, diagonal_shift_, diagonal_, row_scale_;
  Array<float> weight_, row_;  // with bubbles: PressureMatrix
  double reference_norm_ = 0;  // norm of the right-hand side in terms of p
  PressureOperator operator_;
  std::unique_ptr<CellMultigrid> multigrid_;
  CorrectionWorkspace<float> work_;
  CorrectionWorkspace<double> double_work_;  // empty in mixed precision, as are the next
  Array<double> double_diagonal_, zero_;
  RefinementResult report_;
};

}  // namespace spume::les_sph
