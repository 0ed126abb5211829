// SPDX-License-Identifier: MIT
// A pressure equation solved by factorisation: UMFPACK of SuiteSparse (T. Davis, ACM Trans. Math. Softw. 30 (2004)
// 165). For small scenes, and to hold the iterative solvers against.
//
// The matrix is assembled from products with vectors that are 1 at the particles of one colour: no row meets two of
// them, so that each entry is read off a product in double (A. Curtis, M. Powell and J. Reid, IMA J. Appl. Math. 13
// (1974) 117). It has then the weights of the operator that the iterative solvers apply, whatever its sums. Which
// particles a row meets follows from the lists, from the sources of images and from the fits at wall points and of tied
// rows.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "spume/operators/pair_sweep.hpp"
#include "spume/operators/projection_matrix.hpp"
#include "spume/operators/tied_rows.hpp"
#include "spume/solvers/part_constants.hpp"

namespace spume {

struct Draft;
struct Scene;
class Problems;

// Scenes with more are refused.
std::size_t most_particles_of_direct_solver(int dimensions);

class DirectPressure {
 public:
  DirectPressure();
  DirectPressure(const DirectPressure&) = delete;
  DirectPressure& operator=(const DirectPressure&) = delete;
  ~DirectPressure();

  // The factors of `matrix`, whose rows with a diagonal of zero keep what they have. `singular`: constants are in its
  // null space; a uniform source takes up what is left over, and the sum of the unknowns is zero. `enclosed`: so they
  // are on each of these parts, without combinations; empty: on all unknowns. Throws StepFailure for a matrix that is
  // singular in another way, std::logic_error for one that has no context.
  void factorise(ProjectionMatrix& matrix, std::span<const float> diagonal, bool singular,
                 const PartConstants& enclosed = {});
  // x of A x = r, for the size of the matrix.
  void solve(std::span<const double> r, std::span<double> x);

  int products() const { return colours_; }  // with the matrix, that the last factorisation took
  double bytes() const;                      // while it factorises: the most that it takes
  double factor_bytes() const;               // of the factors alone
  double reciprocal_condition() const { return reciprocal_condition_; }  // rough: pivots, the least over the largest

 private:
  struct Factors;
  void find_pattern(const SweepContext& context, const TiedRows* tied, std::span<const float> diagonal);
  void find_colours();
  void find_entries(ProjectionMatrix& matrix);
  void factorise_entries();

  std::size_t size_ = 0;
  std::vector<std::vector<std::int32_t>> borders_;  // the unknowns whose sum each makes zero
  // Columns: the rows of each, and their entries. With borders as many more of both.
  std::vector<int> first_, row_;
  std::vector<double> entry_;
  std::vector<int> row_first_, column_;  // the same by rows, without the border
  std::vector<int> colour_;              // of a column; negative: none
  int colours_ = 0;
  std::vector<double> right_, solution_;
  double peak_bytes_ = 0, reciprocal_condition_ = 0;
  std::unique_ptr<Factors> factors_;
};

// Refuses pressure.solver = "direct" where the scene is too large for it or has bodies that float.
void check_direct_solver(const Draft& draft, const Scene& scene, Problems& problems);

}  // namespace spume
