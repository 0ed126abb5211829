// SPDX-License-Identifier: MIT
// Loops of a few constant steps. Arrays of vectors that they index stay in registers; GCC 12 keeps in memory what a
// loop indexes that it unrolls late or not at all.
#pragma once

#include <type_traits>
#include <utility>

namespace spume {

// body(k) for k = 0 .. count - 1, each an std::integral_constant.
template <int count, class Body>
[[gnu::always_inline]] inline void unrolled(Body&& body) {
  const auto all = [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    (body(std::integral_constant<int, k>()), ...);
  };
  all(std::make_integer_sequence<int, count>());
}

}  // namespace spume
