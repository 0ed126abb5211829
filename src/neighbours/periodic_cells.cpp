// SPDX-License-Identifier: MIT
#include "spume/neighbours/periodic_cells.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

// Points per block of the sort into planes: at most 128 blocks, so that their histograms stay small.
std::size_t sort_block(std::size_t size) {
  return std::max<std::size_t>(4096, (size + 127) / 128);
}

// Without branches, so that the loop over points runs in vectors; not-a-number goes to cell 0.
int clamped(double place, double last) {
  const double low = place > 0 ? place : 0.0;
  return static_cast<int>(low < last ? low : last);
}

}  // namespace

PeriodicCells PeriodicCells::with_side(const std::array<double, 3>& lower, const std::array<double, 3>& length,
                                       double least_side, double most_cells) {
  PeriodicCells cells{lower, length, {1, 1, 1}};
  // An axis shorter than the side has one cell whatever the side: the others share the cells out.
  double side = least_side;
  for (int pass = 0; pass < 3; ++pass) {
    double measure = 1;
    int divided = 0;
    for (const double l : length)
      if (l >= side) measure *= l, ++divided;
    const double share = measure / std::max(most_cells, 1.0);
    side = std::max(side, divided == 3 ? std::cbrt(share) : (divided == 2 ? std::sqrt(share) : share));
  }
  for (int axis = 0; axis < 3; ++axis)
    cells.count[axis] = static_cast<int>(std::clamp(std::floor(length[axis] / side), 1.0, 32768.0));
  return cells;
}

void CellOrder::build(const PeriodicCells& cells, const double* x, const double* y, const double* z, std::size_t size) {
  const auto planes = static_cast<std::size_t>(cells.count[0]);
  const std::size_t per_plane = cells.plane();
  const std::size_t block = sort_block(size);
  const std::size_t blocks = block_count(size, block);
  cell_.resize(size);
  plane_.resize(size);
  order_.resize(size);
  plane_cell_.resize(size);
  plane_order_.resize(size);
  first_.resize(cells.size() + 1);
  block_start_.resize((blocks + 1) * planes + 1);

  std::int32_t* cell = cell_.data();  // within its plane
  std::uint16_t* plane = plane_.data();
  std::int32_t* order = order_.data();
  std::int32_t* first = first_.data();
  std::int32_t* plane_cell = plane_cell_.data();
  std::int32_t* plane_order = plane_order_.data();
  std::int32_t* start = block_start_.data();  // [block][plane], then the start of every plane
  const double inverse[3] = {cells.count[0] / cells.length[0], cells.count[1] / cells.length[1],
                             cells.count[2] / cells.length[2]};

  const double last[3] = {cells.count[0] - 1.0, cells.count[1] - 1.0, cells.count[2] - 1.0};
  const double lower[3] = {cells.lower[0], cells.lower[1], cells.lower[2]};
  const int count_z = cells.count[2];
  parallel_blocks(size, block, [=](std::size_t b, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const int cx = clamped((x[i] - lower[0]) * inverse[0], last[0]);
      const int cy = clamped((y[i] - lower[1]) * inverse[1], last[1]);
      const int cz = clamped((z[i] - lower[2]) * inverse[2], last[2]);
      plane[i] = static_cast<std::uint16_t>(cx);
      cell[i] = cy * count_z + cz;
    }
    std::int32_t* histogram = start + b * planes;
    std::fill_n(histogram, planes, 0);
    for (std::size_t i = from; i < to; ++i) ++histogram[plane[i]];
  });
  std::int32_t* plane_start = start + blocks * planes;
  std::int32_t running = 0;
  for (std::size_t p = 0; p < planes; ++p) {
    plane_start[p] = running;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::int32_t here = start[b * planes + p];
      start[b * planes + p] = running;
      running += here;
    }
  }
  plane_start[planes] = running;
  parallel_blocks(size, block, [=](std::size_t b, std::size_t from, std::size_t to) {
    std::int32_t* cursor = start + b * planes;
    for (std::size_t i = from; i < to; ++i) {
      const std::int32_t place = cursor[plane[i]]++;
      plane_cell[place] = cell[i];
      plane_order[place] = static_cast<std::int32_t>(i);
    }
  });
  // Counting backwards from the end of every cell leaves `first` at the starts, without a second cursor array.
  parallel_blocks_dynamic(planes, 1, [&](std::size_t p, std::size_t, std::size_t) {
    std::int32_t* here = first + p * per_plane;
    const std::int32_t from = plane_start[p], to = plane_start[p + 1];
    std::fill_n(here, per_plane, 0);
    for (std::int32_t k = from; k < to; ++k) ++here[plane_cell[k]];
    std::int32_t end = from;
    for (std::size_t c = 0; c < per_plane; ++c) {
      end += here[c];
      here[c] = end;
    }
    for (std::int32_t k = to; k-- > from;) order[--here[plane_cell[k]]] = plane_order[k];
  });
  first[cells.size()] = static_cast<std::int32_t>(size);
  already_sorted_ = parallel_reduce(
      size, true,
      [=](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
          if (order[k] != static_cast<std::int32_t>(k)) return false;
        return true;
      },
      [](bool a, bool b) { return a && b; });
}

double CellOrder::bytes() const {
  return 4.0 * static_cast<double>(cell_.capacity() + order_.capacity() + first_.capacity() + plane_cell_.capacity() +
                                   plane_order_.capacity() + block_start_.capacity()) +
         2.0 * static_cast<double>(plane_.capacity());
}

}  // namespace spume
