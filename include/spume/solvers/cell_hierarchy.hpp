// SPDX-License-Identifier: MIT
// Geometric multigrid for a diffusion operator on a box of Cartesian cells, one V-cycle from zero:
//
//   (A u)_c = sum over faces of c_f (u_c - u_n) + (dirichlet_c + mass_c) u_c,
//
// n being the cell across face f. Coefficients are integrated over the cell (face area over distance), so that A
// is symmetric. Red-black Gauss-Seidel once down and, in reverse colour order, once up; prolongation is linear
// between cell centres and restriction its transpose: the V-cycle is a symmetric operator.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "spume/core/array.hpp"

namespace spume {

// Cells of one level. Rows run along x with one wrapped ghost value at either end; (j, k) rows follow one another.
// A face coefficient belongs to the cell on its upper side; coefficients across the box boundary are zero unless
// the axis is periodic, so every neighbour index may be wrapped.
struct CellLevel {
  std::array<int, 3> cells{1, 1, 1};
  Array<float> face[3];           // x: entry i of a row lies between i - 1 and i, entry cells[0] closes the row
  Array<float> dirichlet;         // coefficient to zero-valued surroundings
  Array<float> mass;              // volume times Helmholtz coefficient
  Array<float> inverse_diagonal;  // zero where a cell takes no part
  Array<float> right_hand_side, solution, other, residual, scratch;
  Array<std::array<int, 2>> range;  // per row: first and one past the last cell that takes part

  std::size_t rows() const { return static_cast<std::size_t>(cells[1]) * static_cast<std::size_t>(cells[2]); }
  std::size_t pitch() const { return static_cast<std::size_t>(cells[0]) + 2; }
  std::size_t row_start(std::size_t row) const { return row * pitch() + 1; }
  // Of arrays with one entry more along each row and one row more along y, whose entries stand for the lowest of the
  // cells between whose centres a place lies.
  std::size_t corner_columns() const { return static_cast<std::size_t>(cells[0]) + 1; }
  std::size_t corner_rows() const {
    return (static_cast<std::size_t>(cells[1]) + 1) * static_cast<std::size_t>(cells[2]);
  }
  std::size_t corner_row(std::size_t row) const { return row + row / static_cast<std::size_t>(cells[1]); }
  std::size_t rows_per_block() const;  // rows that make a parallel block worth its dispatch
  void resize(const std::array<int, 3>& size, int axes_of_faces);
};

class CellHierarchy {
 public:
  // Sizes all levels for a finest box of `cells`. The caller then fills face, dirichlet and mass of `finest()`.
  void resize(const std::array<int, 3>& cells, const std::array<bool, 3>& periodic);
  // Derives diagonals, active ranges and all coarser levels from the finest coefficients.
  void build();

  CellLevel& finest() { return levels_.front(); }
  const CellLevel& finest() const { return levels_.front(); }
  int level_count() const { return used_; }
  double bytes() const;

  // solution = V-cycle(right_hand_side) on the finest level, from a zero guess. `right_hand_side` is kept.
  void v_cycle();

 private:
  void coarsen(const CellLevel& fine, CellLevel& coarse);
  void finish(CellLevel& level);
  void start(CellLevel& level);
  void sweep(CellLevel& level, int colour);
  void compute_residual(CellLevel& level);
  void restrict_residual(CellLevel& fine, CellLevel& coarse);
  void prolong(const CellLevel& coarse, CellLevel& fine);
  void cycle(int depth);

  std::vector<CellLevel> levels_;
  int used_ = 0;
  std::array<bool, 3> periodic_{};
};

}  // namespace spume
