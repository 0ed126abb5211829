// SPDX-License-Identifier: MIT
#include "spume/neighbours/cell_order.hpp"

#include <algorithm>
#include <bit>

#include "spume/core/borrowed_array.hpp"
#include "spume/core/parallel.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/periodic_cells.hpp"

namespace spume {
namespace {

// Points per block of the sort into slabs: at most 128 blocks, so that their histograms stay small.
std::size_t sort_block(std::size_t size) {
  return std::max<std::size_t>(4096, (size + 127) / 128);
}

// Without branches, so that the loop over points runs in vectors; not-a-number goes to cell 0.
int clamped(double place, double last) {
  const double low = place > 0 ? place : 0.0;
  return static_cast<int>(low < last ? low : last);
}

// Rows of a grid in a slab, as a power of two: slabs of some 8192 points stay in cache, 64 of them occupy all threads,
// and their numbers fit into 16 bits.
int slab_shift(std::size_t rows, std::size_t points) {
  const std::size_t slabs = std::clamp<std::size_t>(points / 8192, 64, 32768);
  return std::bit_width((rows + slabs - 1) / slabs) - (std::has_single_bit((rows + slabs - 1) / slabs) ? 1 : 0);
}

}  // namespace

CellOrder::Memory CellOrder::own_memory(std::size_t size) {
  slab_.resize(size);
  order_.resize(size);
  slab_cell_.resize(size);
  slab_order_.resize(size);
  return {order_.data(), slab_cell_.data(), slab_order_.data(), slab_.data()};
}

template <class Find>
void CellOrder::sort(const Memory& memory, std::size_t size, std::size_t cells, std::size_t per_slab, Find&& find) {
  const std::size_t slabs = (cells + per_slab - 1) / per_slab;
  const std::size_t block = sort_block(size);
  const std::size_t blocks = block_count(size, block);
  size_ = size;
  first_.resize(cells + 1);
  block_start_.resize((blocks + 1) * slabs + 1);

  std::int32_t* cell = memory.order;  // within its slab
  std::uint16_t* slab = memory.slab;
  std::int32_t* order = memory.order;
  std::int32_t* first = first_.data();
  std::int32_t* slab_cell = memory.slab_cell;
  std::int32_t* slab_order = memory.slab_order;
  std::int32_t* start = block_start_.data();  // [block][slab], then the start of every slab

  parallel_blocks(size, block, [=](std::size_t b, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const Place place = find(i);
      slab[i] = static_cast<std::uint16_t>(place.slab);
      cell[i] = place.cell;
    }
    std::int32_t* histogram = start + b * slabs;
    std::fill_n(histogram, slabs, 0);
    for (std::size_t i = from; i < to; ++i) ++histogram[slab[i]];
  });
  std::int32_t* slab_start = start + blocks * slabs;
  std::int32_t running = 0;
  for (std::size_t s = 0; s < slabs; ++s) {
    slab_start[s] = running;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::int32_t here = start[b * slabs + s];
      start[b * slabs + s] = running;
      running += here;
    }
  }
  slab_start[slabs] = running;
  parallel_blocks(size, block, [=](std::size_t b, std::size_t from, std::size_t to) {
    std::int32_t* cursor = start + b * slabs;
    for (std::size_t i = from; i < to; ++i) {
      const std::int32_t place = cursor[slab[i]]++;
      slab_cell[place] = cell[i];
      slab_order[place] = static_cast<std::int32_t>(i);
    }
  });
  // Counting backwards from the end of every cell leaves `first` at the starts, without a second cursor array.
  parallel_blocks(slabs, 1, [&](std::size_t s, std::size_t, std::size_t) {
    std::int32_t* here = first + s * per_slab;
    const std::size_t slab_cells = std::min(per_slab, cells - s * per_slab);
    const std::int32_t from = slab_start[s], to = slab_start[s + 1];
    std::fill_n(here, slab_cells, 0);
    for (std::int32_t k = from; k < to; ++k) ++here[slab_cell[k]];
    std::int32_t end = from;
    for (std::size_t c = 0; c < slab_cells; ++c) {
      end += here[c];
      here[c] = end;
    }
    for (std::int32_t k = to; k-- > from;) order[--here[slab_cell[k]]] = slab_order[k];
  });
  first[cells] = static_cast<std::int32_t>(size);
  already_sorted_ = parallel_reduce(
      size, true,
      [=](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
          if (order[k] != static_cast<std::int32_t>(k)) return false;
        return true;
      },
      [](bool a, bool b) { return a && b; });
}

void CellOrder::build(const CellGrid& grid, const double* x, const double* y, const double* z, std::size_t size) {
  sort(own_memory(size), grid, x, y, z, size);
}

void CellOrder::build(const CellGrid& grid, const double* x, const double* y, const double* z, std::size_t size,
                      ScratchPool& scratch, std::int32_t* order) {
  const BorrowedArray<std::int32_t> slab_cell(scratch, size), slab_order(scratch, size);
  const BorrowedArray<std::uint16_t> slab(scratch, size);
  sort({order, slab_cell.data(), slab_order.data(), slab.data()}, grid, x, y, z, size);
}

void CellOrder::sort(const Memory& memory, const CellGrid& grid, const double* x, const double* y, const double* z,
                     std::size_t size) {
  dimensions_ = grid.dimensions();
  const std::size_t rows = static_cast<std::size_t>(grid.rows_y()) * static_cast<std::size_t>(grid.rows_z());
  const int shift = slab_shift(rows, size);
  const int columns = grid.columns();
  sort(memory, size, static_cast<std::size_t>(grid.cell_count()), static_cast<std::size_t>(columns) << shift,
       [=, &grid](std::size_t i) {
         const std::int32_t row = grid.row(grid.index(1, y[i]), grid.dimensions() == 3 ? grid.index(2, z[i]) : 0);
         const int slab = row >> shift;
         return Place{slab, (row - (slab << shift)) * columns + grid.index(0, x[i])};
       });
}

void CellOrder::build(const PeriodicCells& cells, const double* x, const double* y, const double* z, std::size_t size) {
  dimensions_ = 3;
  const double inverse[3] = {cells.count[0] / cells.length[0], cells.count[1] / cells.length[1],
                             cells.count[2] / cells.length[2]};
  const double last[3] = {cells.count[0] - 1.0, cells.count[1] - 1.0, cells.count[2] - 1.0};
  const double lower[3] = {cells.lower[0], cells.lower[1], cells.lower[2]};
  const int count_z = cells.count[2];
  sort(own_memory(size), size, cells.size(), cells.plane(), [=](std::size_t i) {
    const int cx = clamped((x[i] - lower[0]) * inverse[0], last[0]);
    const int cy = clamped((y[i] - lower[1]) * inverse[1], last[1]);
    const int cz = clamped((z[i] - lower[2]) * inverse[2], last[2]);
    return Place{cx, cy * count_z + cz};
  });
}

// Points: positions read; slab and cell written, the slab read twice and the cell once; cell and index of the slabs
// written, the cell read twice and the index once; the order written and read. Cells: zeroed, counted, summed, taken by
// the points, read.
double CellOrder::build_traffic() const {
  return (8.0 * dimensions_ + 6 + 4 + 4 + 8 + 12 + 8) * static_cast<double>(size_) +
         28.0 * static_cast<double>(first_.size());
}

double CellOrder::bytes() const {
  return 4.0 * static_cast<double>(order_.capacity() + first_.capacity() + slab_cell_.capacity() +
                                   slab_order_.capacity() + block_start_.capacity()) +
         2.0 * static_cast<double>(slab_.capacity());
}

}  // namespace spume
