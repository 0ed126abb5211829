// SPDX-License-Identifier: MIT
// Mixed-precision solution of A x = b: the residual r = b - A x in double, corrections A e = r by a Krylov solve in
// float, x += e, until the double residual meets the tolerance. Float vectors alone cannot: rounding x to float changes
// A x by about diag(A) |x| 6e-8, which for n particles across the domain is of order 6e-8 n^2 of b.
// The scheme: N. Higham, Accuracy and Stability of Numerical Algorithms (2002), chapter 12.
#pragma once

#include <cstddef>
#include <span>

#include "spume/core/array.hpp"
#include "spume/solvers/krylov.hpp"
#include "spume/solvers/linear_operator.hpp"

namespace spume {

enum class KrylovMethod { bicgstab, conjugate_gradients };

struct RefinementOptions {
  KrylovMethod method = KrylovMethod::bicgstab;
  double tolerance = 1e-6;   // on ||b - A x|| / ||b|| in double
  int max_iterations = 500;  // of the inner solver, all corrections together
  // Largest reduction asked of one float solve. Measured on the SPH operator at 1e-6: 1e-3 takes two corrections and 10
  // to 16 float applications; 1e-2 takes three corrections; from 1e-5 on the float recurrence stalls in rounding.
  double inner_tolerance = 1e-3;
  bool zero_guess = false;
  bool remove_mean = false;  // as in KrylovOptions
  std::span<const double> weights;
};

struct RefinementResult {
  int iterations = 0;            // of the inner solver
  int applications = 0;          // of the float operator
  int double_applications = 0;   // of the double operator
  double relative_residual = 0;  // measured in double
  bool converged = false;
  bool breakdown = false;  // non-finite numbers, or a correction that did not halve the residual
};

struct RefinementWorkspace {
  Array<double> residual;
  Array<float> right_hand_side, correction, weights;
  KrylovWorkspace<float> krylov;
};

// `exact` and `fast` apply the same matrix in double and in float. x is the initial guess and receives the solution.
RefinementResult solve_refined(LinearOperator<double>& exact, LinearOperator<float>& fast, Preconditioner<float>& m,
                               std::span<const double> b, std::span<double> x, const RefinementOptions& options,
                               RefinementWorkspace& work);

}  // namespace spume
