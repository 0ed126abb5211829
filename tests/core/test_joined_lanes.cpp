// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "spume/core/joined_lanes.hpp"
#include "spume/core/random.hpp"

namespace spume {
namespace {

template <class V>
void expect_those_of_each() {
  constexpr std::size_t lanes = sizeof(V) / sizeof(float);
  for (std::uint64_t trial = 0; trial < 1000; ++trial) {
    V v[4];
    for (std::uint64_t k = 0; k < 4; ++k)
      for (std::size_t l = 0; l < lanes; ++l)
        v[k][l] = static_cast<float>(
            random_uniform(1, RandomPurpose::test, trial, k, static_cast<std::uint32_t>(l))[0] - 0.5);
    const simd::f32x4 sums = simd::sums(v[0], v[1], v[2], v[3]), largest = simd::largest(v[0], v[1], v[2], v[3]);
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(sums[k], simd::sum(v[k]));
      EXPECT_EQ(largest[k], simd::largest(v[k]));
    }
  }
}

TEST(JoinedLanes, SumsAndExtremesOfFourAreThoseOfEachToTheBit) {
  expect_those_of_each<simd::f32x8>();
  expect_those_of_each<simd::f32n>();
}

}  // namespace
}  // namespace spume
