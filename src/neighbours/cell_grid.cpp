// SPDX-License-Identifier: MIT
#include "spume/neighbours/cell_grid.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <vector>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | v << 16) & 0x0000ffff0000ffffULL;
  v = (v | v << 8) & 0x00ff00ff00ff00ffULL;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fULL;
  v = (v | v << 2) & 0x3333333333333333ULL;
  return (v | v << 1) & 0x5555555555555555ULL;
}

// Exclusive prefix sum of counts[0..n), in blocks; counts[n] becomes the total.
void exclusive_scan(std::int32_t* counts, std::size_t n) {
  std::array<std::int64_t, max_reduction_blocks + 1> start{};
  const std::size_t block = std::max<std::size_t>(4096, (n + max_reduction_blocks - 1) / max_reduction_blocks);
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    start[b + 1] = std::accumulate(counts + first, counts + last, std::int64_t{0});
  });
  for (std::size_t b = 0; b < block_count(n, block); ++b) start[b + 1] += start[b];
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::int64_t running = start[b];
    for (std::size_t i = first; i < last; ++i) {
      const std::int32_t here = counts[i];
      counts[i] = static_cast<std::int32_t>(running);
      running += here;
    }
  });
  counts[n] = static_cast<std::int32_t>(start[block_count(n, block)]);
}

}  // namespace

CellGrid::CellGrid(int dimensions, const std::array<double, 3>& lower, const std::array<double, 3>& upper,
                   double support_radius, std::size_t expected_particles)
    : dimensions_(dimensions), support_radius_(support_radius), lower_(lower) {
  const double cell_limit = 4.0 * static_cast<double>(expected_particles) + 1048576.0;
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

void CellTable::build(const CellGrid& grid, const double* x, const double* y, const double* z, std::size_t size) {
  const auto cells = static_cast<std::size_t>(grid.cell_count());
  dimensions_ = grid.dimensions();
  cell_.resize(size);
  order_.resize(size);
  first_.resize(cells + 1);
  cursor_.resize(cells + 1);

  std::int32_t* cell = cell_.data();
  std::int32_t* first = first_.data();
  std::int32_t* cursor = cursor_.data();
  std::int32_t* order = order_.data();

  parallel_for(cells + 1, [=](std::size_t c) { first[c] = 0; });
  parallel_for(size, [&, cell, first](std::size_t i) {
    cell[i] = static_cast<std::int32_t>(grid.cell(x[i], y[i], z == nullptr ? 0.0 : z[i]));
    std::atomic_ref(first[cell[i]]).fetch_add(1, std::memory_order_relaxed);
  });
  exclusive_scan(first, cells);
  parallel_for(cells, [=](std::size_t c) { cursor[c] = first[c]; });
  parallel_for(size, [=](std::size_t i) {
    order[std::atomic_ref(cursor[cell[i]]).fetch_add(1, std::memory_order_relaxed)] = static_cast<std::int32_t>(i);
  });
  // Threads arrive in any order; sorting the few points of each cell by their old index makes the order stable.
  parallel_for(cells, [=](std::size_t c) {
    if (first[c + 1] - first[c] > 1) std::sort(order + first[c], order + first[c + 1]);
  });
  already_sorted_ = parallel_reduce(
      size, true,
      [=](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
          if (order[k] != static_cast<std::int32_t>(k)) return false;
        return true;
      },
      [](bool a, bool b) { return a && b; });
}

// Points: positions and cells, cells and order, the order twice more. Cells: zeroed, counted, scanned, copied, taken by
// the points, read.
double CellTable::build_traffic() const {
  return (8.0 * dimensions_ + 20) * static_cast<double>(order_.size()) + 40.0 * static_cast<double>(cursor_.size());
}

double CellTable::bytes() const {
  return 4.0 * static_cast<double>(cell_.capacity() + order_.capacity() + first_.capacity() + cursor_.capacity());
}

}  // namespace spume
