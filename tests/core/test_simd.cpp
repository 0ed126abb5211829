// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "spume/core/simd.hpp"

namespace spume::simd {
namespace {

// Numbers whose sums depend on their order.
std::vector<float> numbers(std::size_t size) {
  std::vector<float> values(size);
  unsigned state = 1;
  for (float& value : values) {
    state = state * 1664525U + 1013904223U;
    value = 1 / (1 + static_cast<float>(state >> 8)) * static_cast<float>(state % 1000);
  }
  return values;
}

template <class V, int width, class Entry>
void expect_records(Entry per_record) {
  constexpr int size = sizeof(V) / sizeof(float), records = 3 * size;
  const std::vector<float> values = numbers(records * width);
  std::array<Entry, size> entry;
  for (int l = 0; l < size; ++l) entry[l] = static_cast<Entry>(7 * l % records * per_record);
  std::array<V, width> out;
  load_whole_records<width>(values.data(), entry.data(), out.data());
  for (int l = 0; l < size; ++l)
    for (int c = 0; c < width; ++c) EXPECT_EQ(out[c][l], values[7 * l % records * width + c]) << l << " " << c;
}
TEST(Simd, WholeRecordsAreTransposed) {
  const auto of_width = []<int width>() {
    expect_records<f32x8, width, std::int32_t>(4);
    expect_records<f32x8, width, std::uint16_t>(1);
    expect_records<f32n, width, std::int32_t>(4);
    expect_records<f32n, width, std::uint16_t>(1);
  };
  of_width.operator()<4>();
  of_width.operator()<8>();
  of_width.operator()<12>();
  of_width.operator()<16>();
}

}  // namespace
}  // namespace spume::simd
