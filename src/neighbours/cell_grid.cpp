// SPDX-License-Identifier: MIT
#include "spume/neighbours/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace spume {
namespace {

std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | v << 16) & 0x0000ffff0000ffffULL;
  v = (v | v << 8) & 0x00ff00ff00ff00ffULL;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fULL;
  v = (v | v << 2) & 0x3333333333333333ULL;
  return (v | v << 1) & 0x5555555555555555ULL;
}

}  // namespace

CellGrid::CellGrid(int dimensions, const std::array<double, 3>& lower, const std::array<double, 3>& upper,
                   double support_radius, std::size_t expected_particles)
    : dimensions_(dimensions), support_radius_(support_radius), lower_(lower) {
  const double cell_limit = 4.0 * static_cast<double>(expected_particles) + 1048576.0;
  // The first that fits: a factor of 1.25 for the sides halves the cells in three dimensions, so that the grid has at
  // least half of what it may have.
  double coarsening = 1;
  for (;;) {
    double cells = 1;
    for (int axis = 0; axis < dimensions; ++axis) {
      const double side = support_radius * coarsening * (axis == 0 ? column_fraction : row_fraction);
      const double wanted = std::max(1.0, std::ceil((upper[axis] - lower[axis]) / side));
      count_[axis] = static_cast<int>(std::min(wanted, 1e9));
      inverse_side_[axis] = 1 / side;
      cells *= wanted;
    }
    if (cells <= cell_limit) break;
    coarsening *= 1.25;
  }
  if (dimensions == 2) inverse_side_[2] = 1;

  const std::size_t rows = static_cast<std::size_t>(count_[1]) * count_[2];
  std::vector<std::pair<std::uint64_t, std::int32_t>> keys(rows);
  for (int iz = 0; iz < count_[2]; ++iz)
    for (int iy = 0; iy < count_[1]; ++iy) {
      const std::size_t r = static_cast<std::size_t>(iz) * count_[1] + iy;
      keys[r] = {dimensions == 2 ? r : spread_bits(iy) | spread_bits(iz) << 1, static_cast<std::int32_t>(r)};
    }
  std::sort(keys.begin(), keys.end());
  row_rank_.resize(rows + 8);
  for (std::size_t rank = 0; rank < rows; ++rank) row_rank_[keys[rank].second] = static_cast<std::int32_t>(rank);
}

}  // namespace spume
