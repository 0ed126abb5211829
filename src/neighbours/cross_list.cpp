// SPDX-License-Identifier: MIT
#include "spume/neighbours/cross_list.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/core/simd.hpp"

namespace spume {
namespace {

using simd::f32x8;
using simd::i32x8;

constexpr std::size_t list_block = 128;

inline unsigned mask_of(i32x8 lanes) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(__m256i(lanes))));
#else
  unsigned mask = 0;
  for (int l = 0; l < 8; ++l) mask |= static_cast<unsigned>(lanes[l] != 0) << l;
  return mask;
#endif
}

}  // namespace

bool CrossList::search(const Geometry& geometry, std::span<const Points> sets) {
  const CellGrid& grid = *geometry.grid;
  const std::array<const float*, 3> point = geometry.point;
  const int rows_y = grid.rows_y(), rows_z = grid.rows_z(), columns = grid.columns();
  double extent = 0;
  for (int axis = 0; axis < 3; ++axis) extent = std::max(extent, std::abs(grid.lower(axis) - geometry.origin[axis]));
  // Cells were assigned from double coordinates.
  const double margin = 1e-4 * grid.reach() + 8 * std::numeric_limits<float>::epsilon() * extent;

  std::atomic<std::int64_t> used{0}, found{0};
  const auto capacity = static_cast<std::int64_t>(index_.capacity());
  const std::int32_t nobody = nobody_;
  parallel_blocks_dynamic(count_.size(), list_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    thread_local Array<std::int32_t> thread_collected;
    Array<std::int32_t>& collected = thread_collected;
    std::size_t filled = 0;
    std::int64_t pairs = 0;
    for (std::size_t i = begin; i < end; ++i) {
      std::array<double, 3> centre;  // absolute
      std::array<f32x8, 3> r;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        centre[axis] = geometry.origin[axis] + double{geometry.centre[axis][i]};
        r[axis] = simd::splat(geometry.centre[axis][i]);
      }
      const float own = geometry.centre_reach != nullptr ? geometry.centre_reach[i] : geometry.largest_reach;
      const double reach = double{own} + margin;
      const f32x8 own2 = simd::splat(own * own);
      const std::size_t start = filled;
      // Distance to the row or layer k of an axis; border cells hold what lies beyond the grid.
      const auto gap = [&](int axis, int k, int last) {
        const double low = grid.lower(axis) + k * grid.side(axis);
        const double below = k == 0 ? 0 : low - centre[static_cast<std::size_t>(axis)];
        const double above = k == last ? 0 : centre[static_cast<std::size_t>(axis)] - (low + grid.side(axis));
        return std::max({below, above, 0.0});
      };
      const int z_last = grid.index(2, centre[2] + reach), y_last = grid.index(1, centre[1] + reach);
      for (int iz = grid.index(2, centre[2] - reach); iz <= z_last; ++iz) {
        const double dz = gap(2, iz, rows_z - 1);
        for (int iy = grid.index(1, centre[1] - reach); iy <= y_last; ++iy) {
          const double dy = gap(1, iy, rows_y - 1);
          const double left2 = reach * reach - dz * dz - dy * dy;
          if (!(left2 > 0)) continue;
          const double half = std::sqrt(left2);
          const std::int64_t row = std::int64_t{grid.row(iy, iz)} * columns;
          const std::int64_t from = row + grid.index(0, centre[0] - half),
                             to = row + grid.index(0, centre[0] + half) + 1;
          std::int32_t base = 0;
          for (const Points& set : sets) {
            const std::int32_t first = base + set.table->first()[from], last = base + set.table->first()[to];
            base += static_cast<std::int32_t>(set.size);
            if (first == last) continue;
            const std::size_t wanted = filled + static_cast<std::size_t>(last - first) + 2 * simd::lanes;
            if (wanted > collected.size()) collected.resize(2 * wanted);
            std::int32_t* out = collected.data() + filled;
            for (std::int32_t k = first; k < last; k += simd::lanes) {
              f32x8 distance2{};
              for (std::size_t axis = 0; axis < 3; ++axis) {
                const f32x8 d = simd::load(point[axis] + k) - r[axis];
                distance2 = distance2 + d * d;
              }
              f32x8 limit2 = own2;
              if (geometry.point_reach != nullptr) {
                const f32x8 theirs = simd::load(geometry.point_reach + k);
                limit2 = theirs * theirs;
              }
              unsigned mask = mask_of(i32x8(distance2 < limit2));
              if (last - k < simd::lanes) mask &= (1U << (last - k)) - 1U;
              for (; mask != 0; mask &= mask - 1) *out++ = k + std::countr_zero(mask);
            }
            filled = static_cast<std::size_t>(out - collected.data());
          }
        }
      }
      const std::size_t count = filled - start;
      count_[i] = static_cast<std::int32_t>(count);
      pairs += static_cast<std::int64_t>(count);
      if (filled + simd::lanes > collected.size()) collected.resize(2 * (filled + simd::lanes));
      while (filled % simd::lanes != 0) collected[filled++] = nobody;
    }
    found += pairs;
    const std::int64_t target = used.fetch_add(static_cast<std::int64_t>(filled));
    if (target + static_cast<std::int64_t>(filled) > capacity) return;
    std::copy_n(collected.data(), filled, index_.data() + target);
    std::int64_t running = target;
    for (std::size_t i = begin; i < end; ++i) {
      first_[i] = running;
      running += (count_[i] + 7) / 8 * 8;
    }
  });
  pairs_ = found;
  const std::int64_t wanted = used;
  if (wanted <= capacity) {
    index_.resize(static_cast<std::size_t>(wanted));
    return true;
  }
  index_.release();
  index_.reserve(static_cast<std::size_t>(wanted + wanted / 8));
  return false;
}

void CrossList::build(const Geometry& geometry, std::size_t centres, std::span<const Points> sets) {
  count_.resize(centres);
  first_.resize(centres);
  std::size_t points = 0;
  for (const Points& set : sets) points += set.size;
  nobody_ = static_cast<std::int32_t>(points);
  std::array<Points, 4> present{};
  std::size_t n = 0;
  // A set without points has no table either; sets that follow keep their numbers because its size is zero.
  for (const Points& set : sets)
    if (set.size > 0 && n < present.size()) present[n++] = set;
  while (!search(geometry, std::span(present).first(n))) {
  }
}

double CrossList::bytes() const {
  return 4.0 * static_cast<double>(index_.capacity() + count_.capacity()) +
         8.0 * static_cast<double>(first_.capacity());
}

}  // namespace spume
