// SPDX-License-Identifier: MIT
#include "spume/solvers/part_constants.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace spume {
namespace {

// A thousand unknowns; every seventh is of the first part, some of the others of the second.
std::vector<std::vector<std::int32_t>> parts_of_a_thousand() {
  std::vector<std::vector<std::int32_t>> parts(2);
  for (std::int32_t i = 0; i < 1000; ++i) {
    if (i % 7 == 0)
      parts[0].push_back(i);
    else if (i % 100 < 20)
      parts[1].push_back(i);
  }
  return parts;
}

std::vector<double> something() {
  std::vector<double> x(1000);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 3 + std::sin(0.7 * static_cast<double>(i));
  return x;
}

// Part 0 and 1 as given, 2 the rest.
std::vector<double> means(const std::vector<double>& x, const std::vector<std::vector<std::int32_t>>& parts) {
  std::vector<std::size_t> part(x.size(), 2);
  for (std::size_t k = 0; k < 2; ++k)
    for (const std::int32_t i : parts[k]) part[static_cast<std::size_t>(i)] = k;
  std::vector<double> sum(3), count(3);
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum[part[i]] += x[i];
    ++count[part[i]];
  }
  for (std::size_t k = 0; k < 3; ++k) sum[k] /= count[k];
  return sum;
}

// Sums of a thousand doubles of size 4 are exact to 1e-13 of each.
TEST(PartConstants, EachPartLosesItsMean) {
  const auto parts = parts_of_a_thousand();
  std::vector<double> x = something();
  const std::vector<double> before = x, mean = means(x, parts);
  PartConstants(parts, true).remove<double>(x);
  for (const double value : means(x, parts)) EXPECT_NEAR(value, 0, 1e-13);
  EXPECT_NEAR(x[7] - before[7], -mean[0], 1e-13);
  EXPECT_NEAR(x[1] - before[1], -mean[1], 1e-13);
  EXPECT_NEAR(x[50] - before[50], -mean[2], 1e-13);
}

TEST(PartConstants, WhatIsOfNoPartKeepsItsValues) {
  const auto parts = parts_of_a_thousand();
  std::vector<double> x = something();
  const std::vector<double> before = x;
  PartConstants(parts, false).remove<double>(x);
  EXPECT_NEAR(means(x, parts)[0], 0, 1e-13);
  EXPECT_EQ(x[50], before[50]);
}

// Of two parts the constants that leave a body at rest alone: those of one are twice those of the other.
TEST(PartConstants, CombinationsLoseWhatLiesAlongThem) {
  const auto parts = parts_of_a_thousand();
  std::vector<double> x = something();
  const std::vector<double> before = x, mean = means(x, parts);
  const double n0 = static_cast<double>(parts[0].size()), n1 = static_cast<double>(parts[1].size());
  PartConstants(parts, {{2, 1}}).remove<double>(x);
  const double along = (2 * n0 * mean[0] + n1 * mean[1]) / (4 * n0 + n1);
  EXPECT_NEAR(x[7] - before[7], -2 * along, 1e-13);
  EXPECT_NEAR(x[1] - before[1], -along, 1e-13);
  EXPECT_EQ(x[50], before[50]);
  // All combinations are the constants on each.
  PartConstants(parts, {{2, 1}, {1, 1}}).remove<double>(x);
  const std::vector<double> left = means(x, parts);
  EXPECT_NEAR(left[0], 0, 1e-13);
  EXPECT_NEAR(left[1], 0, 1e-13);
}

TEST(PartConstants, WithoutCombinationsThereAreNone) {
  EXPECT_TRUE(PartConstants(parts_of_a_thousand(), std::vector<std::vector<double>>()).empty());
}

}  // namespace
}  // namespace spume
