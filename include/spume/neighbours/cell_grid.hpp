// SPDX-License-Identifier: MIT
// A Cartesian grid of cells over the domain.
//
// Cells are thin along x and grouped in x-rows, so that all candidates of one row around a particle lie in
// one contiguous range of the sorted arrays. In 3-D the rows follow the Morton order of (y, z): the rows
// that a sweep needs at a time stay in cache. Points outside the grid are counted in its border cells;
// clamping never moves two points apart by more than their distance, so no neighbour is lost.
#pragma once

#include <array>
#include <cstdint>

#include "spume/core/array.hpp"

namespace spume {

class CellGrid {
 public:
  // Least cell sides as fractions of the support radius, across rows and along them: rows half or three quarters of it
  // across made the list build 1.3 times slower, as runs get short and groups long and thin.
  static constexpr double row_fraction = 1;
  static constexpr double column_fraction = 0.25;

  CellGrid() = default;
  // `support_radius`: the largest distance at which neighbours are sought. `expected_particles` bounds the number of
  // cells (at most 4 per particle plus 2^20): a mostly empty large box gets coarser cells.
  CellGrid(int dimensions, const std::array<double, 3>& lower, const std::array<double, 3>& upper,
           double support_radius, std::size_t expected_particles);

  int dimensions() const { return dimensions_; }
  std::int64_t cell_count() const { return std::int64_t{count_[0]} * count_[1] * count_[2]; }
  int columns() const { return count_[0]; }  // cells per row
  int rows_y() const { return count_[1]; }
  int rows_z() const { return count_[2]; }

  int index(int axis, double x) const {
    const double cell = (x - lower_[axis]) * inverse_side_[axis];
    if (!(cell > 0)) return 0;  // a NaN position too: the step reports it
    return cell < count_[axis] - 1 ? static_cast<int>(cell) : count_[axis] - 1;
  }
  // Rank of row (iy, iz) in the order of rows.
  std::int32_t row(int iy, int iz) const { return row_rank_[static_cast<std::size_t>(iz) * count_[1] + iy]; }
  // Ranks of the rows of iz, by iy; eight readable elements follow the last.
  const std::int32_t* row_ranks(int iz) const { return row_rank_.data() + static_cast<std::size_t>(iz) * count_[1]; }
  std::int64_t cell(double x, double y, double z) const {
    return std::int64_t{row(index(1, y), dimensions_ == 3 ? index(2, z) : 0)} * count_[0] + index(0, x);
  }
  double lower(int axis) const { return lower_[axis]; }
  double side(int axis) const { return 1 / inverse_side_[axis]; }
  double support_radius() const { return support_radius_; }

 private:
  int dimensions_ = 3;
  double support_radius_ = 0;
  std::array<double, 3> lower_{}, inverse_side_{};
  std::array<int, 3> count_{1, 1, 1};
  Array<std::int32_t> row_rank_;
};

}  // namespace spume
