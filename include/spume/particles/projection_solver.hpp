// SPDX-License-Identifier: MIT
// Solves the pressure equation of a projection, whatever its rows are: the method gives the right-hand side and the
// matrix, either a ProjectionMatrix of its own or what stands beyond the pair sums of operators/pressure_operator.hpp:
//
//   V [ row_i sum_j 2 g_ij weight_j (q_i - q_j) + diagonal_shift_i q_i ] = right_hand_side_i
//
// Iterative refinement: residuals in double, corrections by a Krylov method in float; or all in double. Preconditioner:
// Jacobi, with `multigrid` plus one V-cycle on Cartesian cells. Or by factors of the matrix, exact to rounding.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "spume/operators/pressure_operator.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/direct_pressure.hpp"
#include "spume/particles/enclosed_parts.hpp"
#include "spume/particles/options.hpp"
#include "spume/solvers/cell_multigrid.hpp"
#include "spume/solvers/part_constants.hpp"
#include "spume/solvers/refinement.hpp"

namespace spume {

// One row per particle; arrays are leased for a solve.
struct PressureRows {
  Array<float> diagonal_shift;                          // empty: none
  Array<float> diagonal;                                // of the matrix, 0 where the pressure is fixed
  const Array<std::uint8_t>* pressure_fixed = nullptr;  // null: nowhere
  Array<float> weight, row;                             // of a variable coefficient; empty: constant
  Array<double> right_hand_side;
  double reference_norm = 0;  // of the right-hand side, to which residuals are relative
  // Of what it has of the divergence that the projection removes; 0: a residual is held against the whole side alone.
  double source_norm = 0;
  // Of the residual that rounding of the guess leaves, below which none is asked for. 0: the guess is exact.
  double rounding_norm = 0;
  double helmholtz = 0;                                // diagonal shift of a full row over V, for the preconditioner
  std::function<double(std::size_t)> helmholtz_scale;  // of each row, what that is multiplied by; empty: 1
  bool closed_off = false;                             // bodies may have closed off some liquid since the last solve
  bool singular = false;         // constants are in the null space: the mean is taken out of residuals
  bool mean_is_removed = false;  // from the solution, by the method, also where sound makes it known
  // The matrix is not symmetric: its residuals sum to anything. The mean is taken out of products as well, which makes
  // a singular system solvable: what is left over is a uniform source.
  bool unsymmetric = false;
  bool measured = false;  // the residual that is reported is measured also where a recurrence may be trusted
  // Of a coefficient 1 / rho in the equation, for the preconditioner: per particle, positive. Null: constant, and then
  // folded into the rows.
  const float* coefficient = nullptr;

  void release(ScratchPool& scratch);
};

// Every so many steps the residual is measured, which costs a sixteenth of a sweep; what the verdict on it may reach,
// over the tolerance: a float leaves 1e-3 of a residual, of which up to 100 tolerances are trusted to a recurrence.
inline constexpr int steps_between_measured = 16;
inline constexpr double largest_measured_residual = 1.5;

// The residual relative to PressureRows::source_norm that is small enough beside one of the tolerance relative to the
// reference norm: a thousand times the tolerance, at most a hundredth. So liquid at rest is held to a millionth of its
// weight, while of the divergence that a step has to remove a thousandth is left to the next step, which finds it in
// its own source. The errors with 1e-4, 1e-3 and 1e-2 of the divergence: methods/les_sph/README.md.
double divergence_tolerance(double tolerance);

class ProjectionSolver {
 public:
  struct Options {
    KrylovMethod method = KrylovMethod::bicgstab;
    bool multigrid = true;
    bool mixed = true;        // residuals in double, corrections in float
    double tolerance = 1e-6;  // residual over the reference norm
    int max_iterations = 500;
    double cell_size = 0;  // of the multigrid
    bool direct = false;   // by factorisation instead
  };
  // `boundary` outlives the solver.
  ProjectionSolver(const Boundary& boundary, const Options& options);

  // Cells for the particles at `at`. Without multigrid nothing.
  void prepare(const PressureRows& rows, ParticleStore& particles, const VectorField& at, const Boundary& boundary);
  // The matrix of these rows. Pressures given behind walls, in the context, are part of its residuals.
  PressureOperator& bind(const PressureRows& rows, const SweepContext& context, PackedNeighbours& packed);
  // The factors of a matrix bound to these rows, for a direct solver.
  void factorise(const PressureRows& rows, ProjectionMatrix& matrix, ParticleStore& particles);
  // Improves `q`, which holds the guess and where the pressure is fixed the value, with a matrix bound to these rows.
  // What did not converge is said in the report: the caller decides. A direct solver has the factors of that matrix.
  // Liquid that solids enclose apart from the rest (particles/enclosed_parts.hpp) is looked for at the first solve and
  // after one that did not converge, and then at each, as long as there is some; by a direct solver with each matrix.
  // `q` has a mean of zero in it. With sound a constant is known, every solve converges, and the errors of the
  // divergence add up in it, to 200 times the pressure around in 30 steps: where no side of the domain moves, and
  // beside bodies that do not, it is taken out as well, and looked for where residuals are measured and where
  // rows.closed_off.
  void solve(const PressureRows& rows, ProjectionMatrix& matrix, ParticleStore& particles, Array<double>& q);

  const DirectPressure* direct() const { return direct_.get(); }  // null: iterative
  double factor_bytes() const { return direct_ == nullptr ? 0 : direct_->factor_bytes(); }
  bool has_multigrid() const { return multigrid_ != nullptr; }
  const RefinementResult& report() const { return report_; }
  double looks_for_enclosed = 1;  // 0: the next solve does not; state between steps
  // Of enclosed liquid, once, after the solve that found it; empty: nothing new.
  std::string take_remark() { return std::exchange(remark_, {}); }
  double bytes() const;  // beside what is leased

 private:
  struct Operator;
  struct DoubleOperator;
  class MixedSystem;
  class DoubleSystem;
  void solve_directly(const PressureRows& rows, const RefinementOptions& refinement, std::span<double> r,
                      std::span<double> q);
  void solve_iteratively(const PressureRows& rows, const RefinementOptions& refinement, ParticleStore& particles,
                         Array<double>& q);
  void find_enclosed(const PressureRows& rows, ParticleStore& particles);
  PartConstants constants_of(EnclosedParts found, bool mean_is_removed);
  template <class Real>
  Preconditioner<Real>& preconditioner(JacobiPreconditioner<Real>& jacobi);

  Options options_;
  const Boundary& boundary_;
  PressureOperator operator_;
  ProjectionMatrix* matrix_ = nullptr;  // of the present solve
  std::unique_ptr<CellMultigrid> multigrid_;
  CorrectionWorkspace<double> double_work_;  // empty in mixed precision, as are the next
  Array<double> double_diagonal_, zero_;
  std::unique_ptr<DirectPressure> direct_;
  bool may_enclose_;       // there are solids
  bool singular_ = false;  // PressureRows::singular, unless bodies that float know the constant
  PartConstants enclosed_;
  std::string remark_;
  bool remarked_ = false;
  RefinementResult report_;
};

// Those of the section [pressure].
ProjectionSolver::Options projection_options(const PressureOptions& pressure, double spacing);

// Of what pressures given behind walls bring to the right-hand side.
double given_norm(ProjectionMatrix& matrix, ParticleStore& particles);

// Throws StepFailure that names `solve` when the report says that it did not converge.
void demand_convergence(const RefinementResult& report, const std::string& solve);

}  // namespace spume
