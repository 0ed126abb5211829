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

template <class V>
V lanes_of(std::uint64_t trial, std::uint64_t k) {
  V v;
  for (std::size_t l = 0; l < sizeof(V) / sizeof(float); ++l)
    v[l] = static_cast<float>(random_uniform(1, RandomPurpose::test, trial, k, static_cast<std::uint32_t>(l))[0] - 0.5);
  return v;
}

// Six, three and two: the last four of eleven are not full.
template <class V>
void expect_those_of_arrays() {
  for (std::uint64_t trial = 0; trial < 100; ++trial) {
    std::array<V, 11> v;
    for (std::size_t k = 0; k < v.size(); ++k) v[k] = lanes_of<V>(trial, k);
    const std::array<V, 6> six{v[0], v[1], v[2], v[3], v[4], v[5]};
    const std::array<float, 11> sums = simd::sums_of(six, std::array{v[6], v[7], v[8]}, std::array{v[9], v[10]});
    const std::array<float, 6> largest = simd::largest_of(six);
    for (std::size_t k = 0; k < v.size(); ++k) EXPECT_EQ(sums[k], simd::sum(v[k])) << k;
    for (std::size_t k = 0; k < six.size(); ++k) EXPECT_EQ(largest[k], simd::largest(six[k])) << k;
  }
}

TEST(JoinedLanes, SumsAndExtremesOfArraysAreThoseOfEachToTheBit) {
  expect_those_of_arrays<simd::f32x8>();
  expect_those_of_arrays<simd::f32n>();
}

}  // namespace
}  // namespace spume
