// SPDX-License-Identifier: MIT
// Symmetric matrices of a few rows, as fits and rigid bodies need them. Eigen does the work in one source: its
// factorisations take seconds to compile wherever they are named.
//
// Matrices are stored by columns without gaps, all of the entries given. They may be of any size; nothing is allocated
// up to 20 rows.
#pragma once

namespace spume {

// A = L L^T in place: L below and on the diagonal, the rest unspecified. False where A is not positive definite.
bool factor_cholesky(double* matrix, int size);

// Solves L L^T x = b in place, L as factor_cholesky leaves it.
void solve_cholesky(const double* factor, int size, double* vector);

// An estimate of 1 / (|A| |A^-1|) in the 1-norm, from a pivoted L D L^T (N. J. Higham, ACM Trans. Math. Softw. 14
// (1988)); 0 where A is singular.
double reciprocal_condition(const double* matrix, int size);

}  // namespace spume
