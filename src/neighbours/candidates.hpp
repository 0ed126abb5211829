// SPDX-License-Identifier: MIT
// The points among which the neighbours of a group of particles are searched for.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "narrow_lists.hpp"
#include "packed_store.hpp"
#include "spume/core/array.hpp"

namespace spume {

// Candidates of a group, packed. The memory is one array per thread, which grows and is reused.
struct Candidates {
  std::array<float*, 3> coordinate{};
  std::int32_t* entry = nullptr;
  std::uint16_t* code = nullptr;  // of narrow lists, where one base reaches all
  std::size_t size = 0;

  Candidates(Array<float>& memory, std::size_t most) {
    // Vector loads and stores reach past the end.
    const std::size_t stride = (most + 2 * pair_lanes) / pair_lanes * pair_lanes;
    if (memory.size() < 5 * stride) memory.resize(10 * stride);
    for (int axis = 0; axis < 3; ++axis) coordinate[axis] = memory.data() + axis * stride;
    entry = reinterpret_cast<std::int32_t*>(memory.data() + 3 * stride);
    code = reinterpret_cast<std::uint16_t*>(memory.data() + 4 * stride);
  }
  const std::int32_t* numbers(const std::int32_t*) const { return entry; }
  const std::uint16_t* numbers(const std::uint16_t*) const { return code; }
  void find_codes(std::int32_t low) {
    for (std::size_t k = 0; k < size; k += pair_lanes) {
      const Codes codes = codes_of(load_int<i32n>(entry + k), low);
      std::memcpy(code + k, &codes, sizeof codes);
    }
  }
};

}  // namespace spume
