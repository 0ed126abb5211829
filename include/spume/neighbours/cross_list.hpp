// SPDX-License-Identifier: MIT
// Neighbour lists between two sets of points in three dimensions: for each centre the points nearer than a distance,
// which belongs to the centre or to the point. The same pairs therefore appear when the two sets change places.
//
// Points are numbered set by set; each set is sorted by the cells of one grid. Lists are padded with `nobody()` to a
// multiple of 8. Their order depends on the sorted points alone.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "spume/core/array.hpp"
#include "spume/neighbours/cell_grid.hpp"

namespace spume {

class CrossList {
 public:
  struct Points {
    const CellTable* table = nullptr;
    std::size_t size = 0;
  };
  struct Geometry {
    const CellGrid* grid = nullptr;
    std::array<double, 3> origin{};        // of the float coordinates
    std::array<const float*, 3> centre{};  // coordinates of the centres
    std::array<const float*, 3> point{};   // of the points, set after set; eight readable elements follow
    const float* centre_reach = nullptr;   // one of the two: the distance that counts
    const float* point_reach = nullptr;    // eight readable elements follow
    const std::uint8_t* wanted = nullptr;  // centres with 0 get an empty list; null: all are wanted
    float largest_reach = 0;               // of all
  };
  // Sets without points are skipped. Allocates only while the lists grow.
  void build(const Geometry& geometry, std::size_t centres, std::span<const Points> sets);

  std::size_t centres() const { return count_.size(); }
  std::int64_t pair_count() const { return pairs_; }
  std::int32_t nobody() const { return nobody_; }  // one past the last point
  std::int32_t count(std::size_t i) const { return count_[i]; }
  const std::int32_t* begin(std::size_t i) const { return index_.data() + first_[i]; }
  const std::int32_t* padded_end(std::size_t i) const { return begin(i) + (count_[i] + 7) / 8 * 8; }
  std::span<const std::int32_t> of(std::size_t i) const { return {begin(i), static_cast<std::size_t>(count_[i])}; }
  double bytes() const;

 private:
  bool search(const Geometry& geometry, std::span<const Points> sets);

  Array<std::int32_t> index_, count_;
  Array<std::int64_t> first_;
  std::int64_t pairs_ = 0;
  std::int32_t nobody_ = 0;
};

}  // namespace spume
