// SPDX-License-Identifier: MIT
#include "spume/operators/interface_bands.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace spume {
namespace {

constexpr std::uint8_t varying_flag = 1, mixed_flag = 2;

// Cells of a row that lie within the support radius of one of them.
int reach_along_rows(const CellGrid& grid) {
  return static_cast<int>(std::ceil(grid.support_radius() / grid.side(0)));
}

}  // namespace

void InterfaceBands::Range::include(Range other) {
  least = std::min(least, other.least);
  most = std::max(most, other.most);
}

void InterfaceBands::find_ranges(const SweepContext& context, const CellOrder& order,
                                 std::span<const std::uint8_t> phase, std::size_t cells) {
  ranges_.resize(cells);
  const std::int32_t* first = order.first();
  const std::int32_t* source = context.images->source();
  const std::int32_t* first_image = context.images->size() > 0 ? context.images->table().first() : nullptr;
  parallel_for(cells, [&](std::size_t c) {
    Range range;
    for (std::int32_t i = first[c]; i < first[c + 1]; ++i) range.include({phase[i], phase[i]});
    if (first_image != nullptr)
      for (std::int32_t k = first_image[c]; k < first_image[c + 1]; ++k)
        range.include({phase[source[k]], phase[source[k]]});
    ranges_[c] = range;
  });
}

// Ranges were spread along the rows; rows are at least a support radius wide.
bool InterfaceBands::several_around(const CellGrid& grid, int column, int iy, int iz) const {
  Range range;
  for (int z = std::max(0, iz - 1); z <= std::min(grid.rows_z() - 1, iz + 1); ++z)
    for (int y = std::max(0, iy - 1); y <= std::min(grid.rows_y() - 1, iy + 1); ++y)
      range.include(along_rows_[static_cast<std::size_t>(grid.row(y, z)) * static_cast<std::size_t>(grid.columns()) +
                                static_cast<std::size_t>(column)]);
  return range.least < range.most;
}

void InterfaceBands::build(const SweepContext& context, const CellGrid& grid, const CellOrder& order,
                           std::span<const std::uint8_t> phase) {
  mixed_.clear();
  varying_.clear();
  const std::size_t n = context.list->particles();
  if (n == 0) return;
  const auto joined = [](Range a, Range b) {
    a.include(b);
    return a;
  };
  const Range all = parallel_reduce(
      n, Range{},
      [&](std::size_t from, std::size_t to) {
        Range range;
        for (std::size_t i = from; i < to; ++i) range.include({phase[i], phase[i]});
        return range;
      },
      joined);
  if (all.least == all.most) return;

  const auto cells = static_cast<std::size_t>(grid.cell_count());
  const auto columns = static_cast<std::size_t>(grid.columns());
  find_ranges(context, order, phase, cells);
  along_rows_.resize(cells);
  const int reach = reach_along_rows(grid);
  parallel_for(cells, [&](std::size_t c) {
    const int column = static_cast<int>(c % columns);
    Range range;
    for (int x = std::max(0, column - reach); x <= std::min(grid.columns() - 1, column + reach); ++x)
      range.include(ranges_[c - static_cast<std::size_t>(column) + static_cast<std::size_t>(x)]);
    along_rows_[c] = range;
  });

  near_.resize(n);
  const auto particles = static_cast<std::int32_t>(n);
  const std::int32_t* source = context.images->source();
  const std::int32_t* first = order.first();
  point_phase_.resize(n + context.images->size());
  parallel_for(n, [&](std::size_t i) { point_phase_[i] = phase[i]; });
  parallel_for(context.images->size(), [&](std::size_t k) { point_phase_[n + k] = phase[source[k]]; });
  const auto find_mixed = [&](std::int32_t from, std::int32_t to, bool several) {
    for (std::int32_t i = from; i < to; ++i) {
      const bool differs =
          several && context.list->any_of(static_cast<std::size_t>(i),
                                          [&, own = phase[i]](std::int32_t j) { return point_phase_[j] != own; });
      near_[i] = differs ? mixed_flag : 0;
    }
  };
  const auto rows_y = static_cast<std::size_t>(grid.rows_y()), rows_z = static_cast<std::size_t>(grid.rows_z());
  parallel_blocks(rows_y * rows_z, 1, [&](std::size_t row_number, std::size_t, std::size_t) {
    const int iy = static_cast<int>(row_number % rows_y), iz = static_cast<int>(row_number / rows_y);
    const std::size_t start = static_cast<std::size_t>(grid.row(iy, iz)) * columns;
    for (std::size_t column = 0; column < columns; ++column)
      if (const std::int32_t from = first[start + column], to = first[start + column + 1]; from < to)
        find_mixed(from, to, several_around(grid, static_cast<int>(column), iy, iz));
  });
  parallel_select(n, mixed_, [&](std::size_t i) { return near_[i] == mixed_flag; });
  parallel_for(mixed_.size(), [&](std::size_t k) {
    context.list->any_of(static_cast<std::size_t>(mixed_[k]), [&](std::int32_t j) {
      std::atomic_ref<std::uint8_t> mark(near_[j < particles ? j : source[j - particles]]);
      if (mark.load(std::memory_order_relaxed) == 0) mark.store(varying_flag, std::memory_order_relaxed);
      return false;
    });
  });
  parallel_select(n, varying_, [&](std::size_t i) { return near_[i] != 0; });
}

double InterfaceBands::bytes() const {
  return ranges_.bytes() + along_rows_.bytes() + point_phase_.bytes() + near_.bytes() +
         4.0 * static_cast<double>(mixed_.capacity() + varying_.capacity());
}

}  // namespace spume
