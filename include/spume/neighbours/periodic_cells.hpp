// SPDX-License-Identifier: MIT
// Cells of a triply periodic box and the order of points in them.
#pragma once

#include <array>
#include <cstdint>

#include "spume/core/array.hpp"

namespace spume {

// Cell (i, j, k) covers lower + ([i, i+1) side_x, ...) and has the number (i ny + j) nz + k.
struct PeriodicCells {
  std::array<double, 3> lower{}, length{};
  std::array<int, 3> count{1, 1, 1};

  double side(int axis) const { return length[axis] / count[axis]; }
  std::size_t size() const { return std::size_t(count[0]) * std::size_t(count[1]) * std::size_t(count[2]); }
  std::size_t plane() const { return std::size_t(count[1]) * std::size_t(count[2]); }

  // Sides of at least `least_side`, at most `most_cells` cells in all (one per axis where a side does not fit).
  static PeriodicCells with_side(const std::array<double, 3>& lower, const std::array<double, 3>& length,
                                 double least_side, double most_cells);
};

// The stable order of points by cell: order()[k] is the index of the k-th point, points of cell c are
// first()[c] .. first()[c+1], and within a cell indices ascend. The same for any number of threads.
//
// Points must lie in the box (a coordinate that rounds onto the upper end, or is not a number, counts in a border
// cell). Cost: three streaming passes when the points are nearly in order already; the first pass sorts into planes of
// constant x by fixed blocks of points, the second sorts every plane in cache.
class CellOrder {
 public:
  void build(const PeriodicCells& cells, const double* x, const double* y, const double* z, std::size_t size);

  const Array<std::int32_t>& order() const { return order_; }
  const std::int32_t* first() const { return first_.data(); }
  bool already_sorted() const { return already_sorted_; }
  // An array of a number per point that only build() uses: anyone's in between.
  Array<std::int32_t>& scratch() { return plane_cell_; }
  double bytes() const;

 private:
  Array<std::int32_t> cell_, order_, first_, plane_cell_, plane_order_, block_start_;
  Array<std::uint16_t> plane_;
  bool already_sorted_ = false;
};

}  // namespace spume
