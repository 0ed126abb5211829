// SPDX-License-Identifier: MIT
// Points of sorted sets near a box or a place, in three dimensions: the pairs between two sets of points, such as
// bubbles and particles, where each pair is looked at so seldom that a list of pairs costs more than it saves.
//
// Points are numbered set by set; each set is sorted by the cells of one grid. What is found, and in which order,
// depends on the sorted points alone.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "spume/core/array.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/images.hpp"

namespace spume {

class CrossSearch {
 public:
  struct Points {
    const CellOrder* table = nullptr;  // may be null for a set without points
    std::size_t size = 0;
    // A box in which none of the points lies; the set is passed over where only that is near.
    std::array<double, 3> free_lower{INFINITY, INFINITY, INFINITY}, free_upper{-INFINITY, -INFINITY, -INFINITY};
  };
  struct Box {
    std::array<float, 3> lower{}, upper{};
  };
  // Consecutive sorted points, as many as are compared at once: first .. min(last, first + pair_lanes).
  struct Block {
    std::int32_t first, last;
  };
  // Grows and is reused; one per thread.
  struct Found {
    Array<std::int32_t> index;  // simd::pair_lanes more are writable
    Array<float> share2;        // (distance / support radius)^2, of near_place alone; filled up to whole vectors with 1
    std::size_t size = 0;
    Array<Block> blocks;
  };
  static constexpr std::size_t most_sets = 2;

  // `point`: float coordinates relative to `origin`, set after set; simd::pair_lanes readable elements follow. Throws
  // std::logic_error for more than most_sets sets.
  CrossSearch(const CellGrid& grid, const std::array<double, 3>& origin, const std::array<const float*, 3>& point,
              std::span<const Points> sets);

  // All points nearer to the box than `support_radius`.
  void near_box(const Box& box, float support_radius, Found& found) const;

  // All points j nearer to `place` than their own support radius 1 / inverse_support_radius[j], at most the largest;
  // simd::pair_lanes readable elements follow.
  void near_place(const std::array<float, 3>& place, float largest_support_radius, const float* inverse_support_radius,
                  Found& found) const;

 private:
  struct Set {
    const std::int32_t* first = nullptr;  // of each cell
    std::int32_t base = 0;                // number of its first point
    Box free;
  };
  std::span<const Block> blocks_near(const Box& box, float support_radius, Found& found) const;

  const CellGrid& grid_;
  std::array<const float*, 3> point_{};
  std::array<Set, most_sets> set_{};
  std::size_t sets_ = 0;
  std::array<float, 3> lower_{}, side_{}, inverse_{};
  std::array<int, 3> last_cell_{};
  float margin_ = 0;  // of the rounding of cells, which were assigned from double coordinates
};

// Images as a set of points.
CrossSearch::Points images_as_points(const Images& images);

}  // namespace spume
