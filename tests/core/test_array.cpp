// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include "spume/core/array.hpp"

namespace spume {
namespace {

TEST(Array, IsAlignedAndStartsZero) {
  for (const std::size_t size : {1U, 7U, 100000U}) {
    const Array<double> a(size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(a.data()) % 64, 0U);
    for (const double value : a) ASSERT_EQ(value, 0);
  }
}

TEST(Array, GrowingKeepsTheContentsAndShrinkingKeepsTheMemory) {
  Array<int> a(3, 5);
  a.resize(100000);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(a[i], 5);
  EXPECT_EQ(a[99999], 0);
  const int* memory = a.data();
  a.resize(10);
  a.resize(100000);
  EXPECT_EQ(a.data(), memory);
}

TEST(Array, CountsBytesAndAllocations) {
  const ArrayStatistics before = array_statistics();
  {
    Array<double> a(1000);
    EXPECT_EQ(array_statistics().bytes, before.bytes + 8000);
    EXPECT_EQ(array_statistics().allocations, before.allocations + 1);
    EXPECT_GE(array_statistics().peak_bytes, before.bytes + 8000);
    a.resize(10);
    a.resize(1000);
    EXPECT_EQ(array_statistics().allocations, before.allocations + 1);
    a.release();
    EXPECT_EQ(array_statistics().bytes, before.bytes);
  }
  EXPECT_EQ(array_statistics().bytes, before.bytes);
}

TEST(Array, GrowsGeometrically) {
  Array<char> a(1000);
  const auto before = array_statistics().allocations;
  for (std::size_t size = 1001; size <= 10000; ++size) a.resize(size);
  // Each allocation adds a quarter: log(10) / log(1.25) = 10.3.
  EXPECT_LE(array_statistics().allocations - before, 11);
}

TEST(Array, CopiesAreIndependentAndMovesAreNot) {
  Array<int> a(4, 1);
  Array<int> b = a;
  b[0] = 2;
  EXPECT_EQ(a[0], 1);
  const int* memory = a.data();
  const Array<int> c = std::move(a);
  EXPECT_EQ(c.data(), memory);
  b = c;
  EXPECT_EQ(b[0], 1);
}

TEST(Array, HoldsNothing) {
  Array<double> a(0);
  EXPECT_TRUE(a.empty());
  const Array<double> b = a;
  EXPECT_EQ(b.size(), 0U);
  EXPECT_EQ(a.begin(), a.end());
}

}  // namespace
}  // namespace spume
