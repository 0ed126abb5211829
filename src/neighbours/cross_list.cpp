// SPDX-License-Identifier: MIT
#include "spume/neighbours/cross_list.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "packed_store.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

constexpr std::size_t list_block = 128;
// Centres that follow each other and lie close together look for points once.
constexpr std::size_t group_size = 16;
constexpr float group_length = 2, group_width = 1.1F;  // of its box, in reaches of the grid; rows of cells are 1 wide

struct Group {
  std::array<std::size_t, group_size> member{};
  std::size_t size = 0;
  std::array<float, 3> lower{}, upper{};
};

// Points near a group, packed; the memory grows and is reused.
struct Candidates {
  Array<float> x[3], reach;
  Array<std::int32_t> index;
  std::size_t size = 0;

  void need(std::size_t wanted) {
    if (wanted <= index.size()) return;
    for (auto* array : {&x[0], &x[1], &x[2], &reach}) array->resize(2 * wanted);
    index.resize(2 * wanted);
  }
};

}  // namespace

bool CrossList::search(const Geometry& geometry, std::span<const Points> sets) {
  const CellGrid& grid = *geometry.grid;
  const std::array<const float*, 3> point = geometry.point;
  const int columns = grid.columns();
  const auto cell_reach = static_cast<float>(grid.reach());
  double extent = 0;
  for (int axis = 0; axis < 3; ++axis)
    extent = std::max(extent, std::abs(grid.lower(axis) - geometry.origin[static_cast<std::size_t>(axis)]));
  // Cells were assigned from double coordinates.
  const double margin = 1e-4 * grid.reach() + 8 * std::numeric_limits<float>::epsilon() * extent;
  const i32x8 lane = {0, 1, 2, 3, 4, 5, 6, 7};

  // The next group of wanted centres from i on; i moves behind it. Others get an empty list.
  const auto next_group = [&](std::size_t& i, std::size_t end, Group& group) {
    group.size = 0;
    for (; i < end && group.size < group_size; ++i) {
      if (geometry.wanted != nullptr && geometry.wanted[i] == 0) {
        count_[i] = 0;
        continue;
      }
      std::array<float, 3> lower, upper;
      bool close = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const float x = geometry.centre[a][i];
        lower[a] = group.size == 0 ? x : std::min(group.lower[a], x);
        upper[a] = group.size == 0 ? x : std::max(group.upper[a], x);
        close = close && upper[a] - lower[a] <= (a == 0 ? group_length : group_width) * cell_reach;
      }
      if (!close && group.size > 0) break;
      group.lower = lower;
      group.upper = upper;
      group.member[group.size++] = i;
    }
  };

  // Points within the reach of the box of a group.
  const auto gather = [&](const Group& group, float reach, Candidates& candidates) {
    candidates.size = 0;
    std::array<double, 3> low, high;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = geometry.origin[a] + double{group.lower[a]};
      high[a] = geometry.origin[a] + double{group.upper[a]};
    }
    const double far = double{reach} + margin;
    const float reach2 = reach * reach;
    // Distance to row or layer k of an axis; border cells hold what lies beyond the grid.
    const auto gap = [&](int axis, int k, int last) {
      const auto a = static_cast<std::size_t>(axis);
      const double from = grid.lower(axis) + k * grid.side(axis);
      const double below = k == 0 ? 0 : from - high[a], above = k == last ? 0 : low[a] - (from + grid.side(axis));
      return std::max({below, above, 0.0});
    };
    const int z_last = grid.index(2, high[2] + far), y_last = grid.index(1, high[1] + far);
    for (int iz = grid.index(2, low[2] - far); iz <= z_last; ++iz) {
      const double dz = gap(2, iz, grid.rows_z() - 1);
      for (int iy = grid.index(1, low[1] - far); iy <= y_last; ++iy) {
        const double dy = gap(1, iy, grid.rows_y() - 1);
        const double left2 = far * far - dz * dz - dy * dy;
        if (!(left2 > 0)) continue;
        const double half = std::sqrt(left2);
        const std::int64_t row = std::int64_t{grid.row(iy, iz)} * columns;
        const std::int64_t from = row + grid.index(0, low[0] - half), to = row + grid.index(0, high[0] + half) + 1;
        std::int32_t base = 0;
        for (const Points& set : sets) {
          const std::int32_t first = base + set.table->first()[from], last = base + set.table->first()[to];
          base += static_cast<std::int32_t>(set.size);
          if (first == last) continue;
          std::size_t size = candidates.size;
          candidates.need(size + static_cast<std::size_t>(last - first) + 2 * simd::lanes);
          for (std::int32_t k = first; k < last; k += simd::lanes) {
            std::array<f32x8, 3> x;
            f32x8 distance2{};
            for (std::size_t a = 0; a < 3; ++a) {
              x[a] = simd::load(point[a] + k);
              const f32x8 nearest =
                  simd::min(simd::max(x[a], simd::splat(group.lower[a])), simd::splat(group.upper[a]));
              distance2 = distance2 + (x[a] - nearest) * (x[a] - nearest);
            }
            const i32x8 index = lane + k;
            const unsigned mask = mask_of(i32x8(distance2 < reach2) & (index < last));
            const Packing packing = packing_of(mask);
            for (std::size_t a = 0; a < 3; ++a) store_packed(x[a], packing, candidates.x[a].data() + size);
            store_packed(index, packing, candidates.index.data() + size);
            if (geometry.point_reach != nullptr)
              store_packed(simd::load(geometry.point_reach + k), packing, candidates.reach.data() + size);
            size += static_cast<std::size_t>(std::popcount(mask));
          }
          candidates.size = size;
        }
      }
    }
  };

  std::atomic<std::int64_t> used{0}, found{0};
  const auto capacity = static_cast<std::int64_t>(index_.capacity());
  const std::int32_t nobody = nobody_;
  parallel_blocks_dynamic(count_.size(), list_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    thread_local Array<std::int32_t> thread_collected;
    thread_local Candidates thread_candidates;
    Array<std::int32_t>& collected = thread_collected;
    Candidates& candidates = thread_candidates;
    std::size_t filled = 0;
    std::int64_t pairs = 0;
    Group group;
    for (std::size_t i = begin; i < end;) {
      next_group(i, end, group);
      if (group.size == 0) continue;
      float reach = geometry.largest_reach;
      if (geometry.centre_reach != nullptr) {
        reach = 0;
        for (std::size_t g = 0; g < group.size; ++g) reach = std::max(reach, geometry.centre_reach[group.member[g]]);
      }
      gather(group, reach, candidates);
      const std::size_t wanted = filled + group.size * (candidates.size + 2 * simd::lanes);
      if (wanted > collected.size()) collected.resize(2 * wanted);
      for (std::size_t g = 0; g < group.size; ++g) {
        const std::size_t c = group.member[g];
        std::int32_t* const start = collected.data() + filled;
        std::int32_t* out = start;
        const float own = geometry.centre_reach != nullptr ? geometry.centre_reach[c] : geometry.largest_reach;
        for (std::size_t k = 0; k < candidates.size; k += simd::lanes) {
          f32x8 distance2{};
          for (std::size_t a = 0; a < 3; ++a) {
            const f32x8 d = simd::load(candidates.x[a].data() + k) - geometry.centre[a][c];
            distance2 = distance2 + d * d;
          }
          f32x8 limit = simd::splat(own);
          if (geometry.point_reach != nullptr) limit = simd::load(candidates.reach.data() + k);
          unsigned mask = mask_of(i32x8(distance2 < limit * limit));
          if (candidates.size - k < simd::lanes) mask &= (1U << (candidates.size - k)) - 1U;
          store_packed(load_int(candidates.index.data() + k), packing_of(mask), out);
          out += std::popcount(mask);
        }
        store_int(out, i32x8{} + nobody);
        const auto count = static_cast<std::int32_t>(out - start);
        count_[c] = count;
        pairs += count;
        filled += static_cast<std::size_t>((count + 7) / 8 * 8);
      }
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
