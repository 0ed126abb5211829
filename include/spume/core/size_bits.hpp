// SPDX-License-Identifier: MIT
// The largest size of many numbers, NaN where one is. The bits of |a| order as the numbers do, with those of NaN above
// infinity, and the compiler takes several of them at a time; comparisons of numbers that may be NaN it does one by
// one.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace spume {

inline std::int64_t size_bits(double a) {
  return std::bit_cast<std::int64_t>(a) & std::numeric_limits<std::int64_t>::max();
}
inline std::int32_t size_bits(float a) {
  return std::bit_cast<std::int32_t>(a) & std::numeric_limits<std::int32_t>::max();
}
inline double of_size_bits(std::int64_t bits) {
  return std::bit_cast<double>(bits);
}
inline float of_size_bits(std::int32_t bits) {
  return std::bit_cast<float>(bits);
}

// Of a[first] .. a[last - 1]; 0 of none.
template <class T>
T largest_size(const T* a, std::size_t first, std::size_t last) {
  decltype(size_bits(T{})) largest = 0;
  for (std::size_t i = first; i < last; ++i) largest = std::max(largest, size_bits(a[i]));
  return of_size_bits(largest);
}

}  // namespace spume
