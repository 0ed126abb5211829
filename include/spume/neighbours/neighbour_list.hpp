// SPDX-License-Identifier: MIT
// Neighbour lists of particles: for each particle the particles and images within the support radius, itself excluded.
// With solids, of these what it sees (scene/solid_union.hpp), and with anything else that hides points
// (neighbours/sight.hpp).
//
// Points are numbered particles first (0 .. n-1), then images (n .. n+m-1), then one sentinel (n+m) far from
// everything. Lists are padded with the sentinel to a multiple of 8, so that pair loops have no remainder:
// kernels vanish at the sentinel. The order within a list depends on the sorted particles alone, never on the
// thread count.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <stdexcept>

#include "spume/core/array.hpp"
#include "spume/core/simd.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/images.hpp"

namespace spume {

// Lists hold entries: four times the number of a point, which is where its record of four floats begins. Pair loops
// then address records without arithmetic of their own, a sixth of the instructions of the pressure operator.
inline constexpr std::int32_t entry_scale = 4;

// The points that a run of entries stands for.
class ListedPoints {
 public:
  class Iterator {
   public:
    using value_type = std::int32_t;
    using difference_type = std::ptrdiff_t;
    using reference = std::int32_t;
    using pointer = const std::int32_t*;
    using iterator_category = std::input_iterator_tag;
    explicit Iterator(const std::int32_t* entry) : entry_(entry) {}
    std::int32_t operator*() const {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(*entry_) / entry_scale);
    }
    Iterator& operator++() {
      ++entry_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(entry_++); }
    bool operator==(const Iterator&) const = default;

   private:
    const std::int32_t* entry_;
  };
  using value_type = std::int32_t;
  using const_iterator = Iterator;

  ListedPoints(const std::int32_t* first, std::size_t size) : first_(first), size_(size) {}
  Iterator begin() const { return Iterator(first_); }
  Iterator end() const { return Iterator(first_ + size_); }
  std::size_t size() const { return size_; }

 private:
  const std::int32_t* first_;
  std::size_t size_;
};

// Lists may be kept narrow: batches of as many entries as a pair loop takes at a time, each one number for all and one
// of 16 bits for each, what it is beyond the smallest. A list of 104 neighbours takes 250 bytes in place of 432. Points
// are mostly closer together than 16 bits reach; a batch ends where they are not. What is left of a batch repeats its
// first neighbour: none stands twice in a list, so that this needs no number of its own and no other way of reading.
struct NarrowBatches {
  const std::uint16_t* code = nullptr;  // points beyond the base, simd::pair_lanes a batch
  const std::int32_t* base = nullptr;   // an entry
  std::size_t size = 0;                 // batches
};
inline constexpr std::int32_t narrow_reach = 0x10000;  // points

class NeighbourList {
 public:
  // From the next build on. Lists are then read by for_each_batch and any_of alone.
  void keep_narrow() { narrow_ = true; }
  bool narrow() const { return narrow_; }
  NarrowBatches batches(std::size_t i) const {
    const std::size_t first = first_[i];
    return {code_.data() + first * simd::pair_lanes, base_.data() + first, static_cast<std::size_t>(count_[i])};
  }

  // Throws std::length_error for more points than entries can number, 5e8, and for more than 3e10 entries.
  // Positions must be sorted by `particles` (of `grid`). Coordinates are kept as floats relative to
  // `origin`: a domain 1000 spacings across is resolved to 6e-5 spacings.
  void build(const CellGrid& grid, const CellOrder& particles, const double* x, const double* y, const double* z,
             std::size_t n, const Images& images, const std::array<double, 3>& origin);
  // The same with a support radius of its own for each particle, between the grid's and the largest, at most 1.3 times
  // the grid's. The list of i then has what is within the support of i.
  void build(const CellGrid& grid, const CellOrder& particles, const double* x, const double* y, const double* z,
             std::size_t n, const Images& images, const std::array<double, 3>& origin, const float* own_support_radius,
             double largest_support_radius);

  // New coordinates of the points; the lists stay as they are. They hold who came within the support radius where they
  // were built: less twice what a point has moved since, they still do.
  void move(const std::array<const double*, 3>& position, const Images& images, int dimensions);

  std::size_t particles() const { return count_.size(); }
  std::size_t points() const { return points_; }  // particles and images
  std::int32_t sentinel() const { return static_cast<std::int32_t>(points_); }
  std::int64_t pair_count() const { return pairs_; }  // directed, without padding
  // Whether one of the points in the list of i has a property, has(j), however lists are kept; none is asked after it.
  template <class Has>
  bool any_of(std::size_t i, Has&& has) const {
    if (!narrow_) {
      for (const std::int32_t j : of(i))
        if (has(j)) return true;
      return false;
    }
    const NarrowBatches some = batches(i);
    for (std::size_t b = 0; b < some.size; ++b) {
      const std::uint16_t* const code = some.code + b * simd::pair_lanes;
      const std::int32_t base = some.base[b] / entry_scale;
      for (int l = 0; l < simd::pair_lanes && (l == 0 || code[l] != code[0]); ++l)
        if (has(base + code[l])) return true;
    }
    return false;
  }
  // Of all lists, with their padding.
  double list_bytes() const {
    return 4.0 * static_cast<double>(index_.size() + base_.size()) + 2.0 * static_cast<double>(code_.size());
  }
  // This and what follows: of lists that are not narrow.
  std::int32_t count(std::size_t i) const { return count_[i]; }
  const std::int32_t* counts() const { return count_.data(); }
  // Entries, padded with that of the sentinel.
  const std::int32_t* begin(std::size_t i) const { return index_.data() + std::size_t{simd::lanes} * first_[i]; }
  const std::int32_t* padded_end(std::size_t i) const { return begin(i) + (count_[i] + 7) / 8 * 8; }
  ListedPoints of(std::size_t i) const {
    if (narrow_) throw std::logic_error("narrow lists are read batch by batch");
    return {begin(i), static_cast<std::size_t>(count_[i])};
  }
  // Float coordinates relative to the origin, sentinel included.
  const float* coordinate(int axis) const { return coordinate_[axis].data(); }
  double bytes() const;

 private:
  template <int dimensions>
  bool search(const CellGrid& grid, const CellOrder& particles, const std::array<const double*, 3>& position,
              const Images& images, const float* own_support_radius);

  std::array<Array<float>, 3> coordinate_;
  bool narrow_ = false;
  Array<std::int32_t> index_, count_;  // narrow: none, and batches
  Array<std::uint32_t> first_;         // eight entries; narrow: batch
  Array<std::uint16_t> code_;
  Array<std::int32_t> base_;
  std::size_t points_ = 0;
  std::int64_t pairs_ = 0;
  std::array<double, 3> origin_{};
  std::array<float, 3> image_free_lower_{}, image_free_upper_{};
};

}  // namespace spume
