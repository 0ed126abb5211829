// SPDX-License-Identifier: MIT
// Entries in batches of 16-bit numbers beyond a base (NarrowBatches).
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "packed_store.hpp"
#include "spume/core/array.hpp"
#include "spume/neighbours/neighbour_list.hpp"

namespace spume {

// The entries of a vector as numbers of points beyond that of `low`.
static_assert(entry_scale == 1 << 2);
[[gnu::always_inline]] inline Codes codes_of(i32n entries, std::int32_t low) {
  return __builtin_convertvector((entries - low) >> 2, Codes);
}

// The batches of a block of particles, before it is known where they go.
class NarrowBlock {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }

  // Whether one base reaches all of them.
  static bool within_reach(const std::int32_t* entry, std::size_t size, std::int32_t& low) {
    low = 0;
    if (size == 0) return true;
    i32n least = i32n{} + entry[0], most = least;
    std::size_t k = 0;
    for (; k + pair_lanes <= size; k += pair_lanes) {
      const auto more = load_int<i32n>(entry + k);
      least = least < more ? least : more;
      most = most < more ? more : most;
    }
    low = least_lane(least);
    std::int32_t high = largest_lane(most);
    for (; k < size; ++k) {
      low = std::min(low, entry[k]);
      high = std::max(high, entry[k]);
    }
    return high - low < reach;
  }

  // Where the numbers of a list beyond one base go, which then has `count`; returns how many batches it takes.
  std::uint16_t* begin_list(std::size_t most) {
    make_room(most);
    return code_.data() + size_ * pair_lanes;
  }
  std::int32_t end_list(std::size_t count, std::int32_t low) {
    const std::size_t batches = (count + pair_lanes - 1) / pair_lanes;
    std::uint16_t* const code = code_.data() + size_ * pair_lanes;
    for (std::size_t k = count; k < batches * pair_lanes; ++k) code[k] = code[k / pair_lanes * pair_lanes];
    for (std::size_t b = 0; b < batches; ++b) base_[size_ + b] = low;
    size_ += batches;
    return static_cast<std::int32_t>(batches);
  }

  // Adds a list that one base may not reach; returns how many batches it takes.
  std::int32_t add(const std::int32_t* start, const std::int32_t* stop) {
    make_room(static_cast<std::size_t>(stop - start) * pair_lanes);
    const std::size_t before = size_;
    while (start < stop) {
      std::int32_t low = start[0], high = start[0];
      if (stop - start >= pair_lanes && within_reach(start, pair_lanes, low)) {
        const Codes whole = codes_of(load_int<i32n>(start), low);
        std::memcpy(code_.data() + size_ * pair_lanes, &whole, sizeof whole);
        base_[size_++] = low;
        start += pair_lanes;
        continue;
      }
      low = start[0];
      int taken = 1;
      for (; taken < std::min<std::ptrdiff_t>(stop - start, pair_lanes); ++taken) {
        const std::int32_t lower = std::min(low, start[taken]), higher = std::max(high, start[taken]);
        if (higher - lower >= reach) break;
        low = lower;
        high = higher;
      }
      std::uint16_t* const code = code_.data() + size_ * pair_lanes;
      for (int l = 0; l < pair_lanes; ++l)
        code[l] = static_cast<std::uint16_t>((start[l < taken ? l : 0] - low) / entry_scale);
      base_[size_++] = low;
      start += taken;
    }
    return static_cast<std::int32_t>(size_ - before);
  }

  void copy_to(std::uint16_t* code, std::int32_t* base) const {
    std::copy_n(code_.data(), size_ * pair_lanes, code);
    std::copy_n(base_.data(), size_, base);
  }

 private:
  static constexpr std::int32_t reach = narrow_reach * entry_scale;

  // Of so many numbers, and of the vectors that are written behind the last.
  void make_room(std::size_t numbers) {
    const std::size_t batches = size_ + numbers / pair_lanes + 3;
    if (batches <= base_.size()) return;
    base_.resize(2 * batches);
    code_.resize(2 * batches * pair_lanes);
  }

  Array<std::uint16_t> code_;
  Array<std::int32_t> base_;
  std::size_t size_ = 0;
};

}  // namespace spume
