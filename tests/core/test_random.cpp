// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "spume/core/random.hpp"

namespace spume {
namespace {

constexpr auto purpose = RandomPurpose::test;

// A seed whose key words are the given ones for this purpose.
std::uint64_t seed_of(std::uint32_t low, std::uint32_t high) {
  return std::uint64_t{high ^ static_cast<std::uint32_t>(purpose)} << 32 | low;
}

TEST(Random, EqualsThePublishedPhiloxVectors) {
  // Philox 4x32-10 in kat_vectors of Random123: counter, key, output.
  struct Vector {
    std::uint32_t counter[4], key[2], output[4];
  };
  const Vector vectors[] = {
      {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
      {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
       {0xffffffff, 0xffffffff},
       {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
      {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
       {0xa4093822, 0x299f31d0},
       {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
  };
  for (const auto& v : vectors) {
    const auto found = random_uniform(seed_of(v.key[0], v.key[1]), purpose,
                                      std::uint64_t{v.counter[1]} << 32 | v.counter[0], v.counter[2], v.counter[3]);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(found[k], v.output[k] / 4294967296.0);
  }
}

TEST(Random, EveryArgumentChangesTheNumbers) {
  std::set<std::array<double, 4>> seen;
  seen.insert(random_uniform(1, purpose, 2, 3, 4));
  seen.insert(random_uniform(2, purpose, 2, 3, 4));
  seen.insert(random_uniform(1, RandomPurpose::initial_jitter, 2, 3, 4));
  seen.insert(random_uniform(1, purpose, 3, 3, 4));
  seen.insert(random_uniform(1, purpose, 2 + (1ULL << 32), 3, 4));
  seen.insert(random_uniform(1, purpose, 2, 4, 4));
  seen.insert(random_uniform(1, purpose, 2, 3, 5));
  EXPECT_EQ(seen.size(), 7U);
  EXPECT_EQ(random_uniform(1, purpose, 2, 3, 4), random_uniform(1, purpose, 2, 3, 4));
}

TEST(Random, IsUniformAndUncorrelatedBetweenNeighbouringStreams) {
  // Mean and correlation of n numbers have standard deviations sqrt(1/12n) and 1/sqrt(n): five of them.
  const int n = 40000;
  double mean = 0, square = 0;
  std::array<double, 3> correlation{};
  for (int i = 0; i < n; ++i) {
    const auto id = static_cast<std::uint64_t>(i);
    const double u = random_uniform(7, purpose, id, 0, 0)[0] - 0.5;
    mean += u / n;
    square += u * u / n;
    correlation[0] += 12 * u * (random_uniform(7, purpose, id + 1, 0, 0)[0] - 0.5) / n;
    correlation[1] += 12 * u * (random_uniform(8, purpose, id, 0, 0)[0] - 0.5) / n;
    correlation[2] += 12 * u * (random_uniform(7, purpose, id, 1, 0)[0] - 0.5) / n;
    ASSERT_GE(u, -0.5);
    ASSERT_LT(u, 0.5);
  }
  EXPECT_NEAR(mean, 0, 5 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(square, 1.0 / 12, 5 * std::sqrt(1.0 / 180 / n));
  for (const double c : correlation) EXPECT_NEAR(c, 0, 5 / std::sqrt(n));
}

}  // namespace
}  // namespace spume
