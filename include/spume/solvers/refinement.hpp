// SPDX-License-Identifier: MIT
// Iterative refinement of A x = b: the residual r = b - A x in double, corrections A e = r by a Krylov solve, mostly in
// float, x += e, until the residual meets the tolerance. Float vectors alone cannot: rounding x to float changes A x by
// about diag(A) |x| 6e-8, which for n particles across the domain is of order 6e-8 n^2 of b.
// The scheme: N. Higham, Accuracy and Stability of Numerical Algorithms (2002), chapter 12.
#pragma once

#include <cstddef>
#include <span>

#include "spume/core/array.hpp"
#include "spume/solvers/krylov.hpp"
#include "spume/solvers/linear_operator.hpp"

namespace spume {

enum class KrylovMethod { bicgstab, conjugate_gradients };

// What is asked of a correction e.
struct CorrectionTask {
  double size = 0;         // norm of r
  double target = 0;       // norm of r - A e
  int max_iterations = 0;  // of the Krylov solver
  bool remove_mean = false;
  const PartConstants* parts = nullptr;  // KrylovOptions::parts
};

// A system that keeps its unknowns x.
class RefinedSystem {
 public:
  virtual ~RefinedSystem() = default;
  // r = b - A x.
  virtual void residual(std::span<double> r) = 0;
  // x += e with A e close to r.
  virtual KrylovResult correct(std::span<const double> r, const CorrectionTask& task) = 0;
  // r -= A e, e being what correct() has added last; or r = b - A x again.
  virtual void subtract_product(std::span<double> r) = 0;
};

struct RefinementOptions {
  double tolerance = 1e-6;               // on ||b - A x|| / reference_norm
  double reference_norm = 0;             // of the right-hand side, as the caller measures it
  int max_iterations = 500;              // of the Krylov solver, all corrections together
  bool remove_mean = false;              // of residuals: the null space of A is the constant
  bool measure = false;                  // the residual of the last correction too; x is the same
  const PartConstants* parts = nullptr;  // the null space of A; null: `remove_mean` says
};

struct RefinementResult {
  int iterations = 0;            // of the Krylov solver, at least one a correction
  int applications = 0;          // of A, in either precision
  double tolerance = 0;          // that was asked for
  double relative_residual = 0;  // that of the last correction's recurrence where that may be trusted, else measured
  bool converged = false;
};

// size / reference; of nothing to refer to, infinity, unless the size is 0 as well.
double relative_size(double size, double reference);

// The residual that subtract_product() keeps does not see the rounding of x itself, some 1e-13 of the terms of a row:
// smaller tolerances mean nothing where it does not measure anew.
//
// r: work space of the size of x; the residual on return, up to the last correction where that was trusted. Ends
// without convergence when iterations have run out, at a non-finite residual and after 21 corrections: at three digits
// each, six reach the rounding of a double.
RefinementResult solve_refined(RefinedSystem& system, const RefinementOptions& options, std::span<double> r);

template <class Real>
struct CorrectionWorkspace {
  Array<Real> right_hand_side, correction;  // e, in float as a multiple of the task's size
  KrylovWorkspace<Real> krylov;

  double bytes() const { return right_hand_side.bytes() + correction.bytes() + krylov.bytes(); }
};

// RefinedSystem::correct() by a Krylov solver in float or double from e = 0: x += e. In float r is scaled to order one,
// which keeps the range for any units.
template <class Real>
KrylovResult correct_by_krylov(KrylovMethod method, LinearOperator<Real>& a, Preconditioner<Real>& m,
                               std::span<const double> r, const CorrectionTask& task, std::span<double> x,
                               CorrectionWorkspace<Real>& work);

}  // namespace spume
