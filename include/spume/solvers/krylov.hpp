// SPDX-License-Identifier: MIT
// Krylov solvers for A x = b with a matrix-free operator and a preconditioner, in float or double vectors with all
// inner products in double. Results are bit-identical for any thread count when operator and preconditioner are.
#pragma once

#include <cstddef>
#include <span>

#include "spume/core/array.hpp"
#include "spume/solvers/linear_operator.hpp"
#include "spume/solvers/part_constants.hpp"

namespace spume {

template <class Real>
struct KrylovOptions {
  double tolerance = 1e-6;  // on ||b - A x|| / ||b||, Euclidean norms
  int max_iterations = 500;
  bool zero_guess = false;  // x is taken as zero whatever it holds: saves the first application of A
  // Measures b - A x when the recurrence says that the tolerance is met, and goes on if it is not. One application.
  bool confirm = true;
  // For operators whose null space is the constant: the right-hand side is projected on sum_i r_i = 0 by
  // r_i -= w_i sum(r) / sum(w), and the solution shifted to sum_i w_i x_i = 0. Empty weights are all one; particle
  // volumes are right for a volume-weighted operator.
  bool remove_mean = false;
  std::span<const Real> weights;
  // A null space of more constants than one, taken out instead with weights of one; null: `remove_mean` says.
  const PartConstants* parts = nullptr;
};

struct KrylovResult {
  int iterations = 0;
  int applications = 0;          // of the operator
  double relative_residual = 0;  // measured when `confirm` is set or no iteration was made, else the recurrence's
  bool converged = false;
  bool breakdown = false;  // non-finite numbers, or no progress after restarts: x holds the last finite iterate
};

// Work vectors, kept by the caller between solves so that a steady state allocates nothing.
template <class Real>
struct KrylovWorkspace {
  Array<Real> residual, shadow, direction, preconditioned, image, second_image, second_preconditioned;

  double bytes() const {
    double total = 0;
    for (const auto* array :
         {&residual, &shadow, &direction, &preconditioned, &image, &second_image, &second_preconditioned})
      total += array->bytes();
    return total;
  }
};

// Conjugate gradients: A and M symmetric positive (semi-)definite. One application per iteration.
// M. Hestenes, E. Stiefel, J. Res. Nat. Bur. Stand. 49 (1952), preconditioned form.
template <class Real>
KrylovResult conjugate_gradients(LinearOperator<Real>& a, Preconditioner<Real>& m, std::span<const Real> b,
                                 std::span<Real> x, const KrylovOptions<Real>& options, KrylovWorkspace<Real>& work);

// BiCGStab, right-preconditioned, so that the recurrence carries the true residual. Two applications per iteration.
// H. van der Vorst, SIAM J. Sci. Stat. Comput. 13 (1992). Restarts from the current residual when an inner product
// vanishes.
template <class Real>
KrylovResult bicgstab(LinearOperator<Real>& a, Preconditioner<Real>& m, std::span<const Real> b, std::span<Real> x,
                      const KrylovOptions<Real>& options, KrylovWorkspace<Real>& work);

}  // namespace spume
