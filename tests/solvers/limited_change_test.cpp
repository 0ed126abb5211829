// SPDX-License-Identifier: MIT
#include "spume/solvers/limited_change.hpp"

#include <gtest/gtest.h>

#include <random>

#include "reference/limited_change.hpp"
#include "support/direct_solution.hpp"

namespace spume::test {
namespace {

struct Program {
  Eigen::MatrixXd mass;
  Eigen::VectorXd start;
  Limits limits;
  std::vector<double> inverse() const {
    const Eigen::MatrixXd m = least_squares(mass, Eigen::MatrixXd::Identity(mass.rows(), mass.rows()));
    return {m.data(), m.data() + m.size()};
  }
};

// Limits of which some say the same, or the same less strictly; x = 1 meets them all.
Program random_program(std::mt19937& random, std::size_t unknowns, std::size_t limits) {
  std::uniform_real_distribution<double> value(-1, 1);
  const auto n = static_cast<Eigen::Index>(unknowns);
  const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return value(random); });
  Program found{root.lazyProduct(root.transpose()) + 0.1 * Eigen::MatrixXd::Identity(n, n),
                Eigen::VectorXd::NullaryExpr(n, [&] { return 3 * value(random); }),
                {unknowns, {}, {}}};
  for (std::size_t k = 0; k < limits; ++k) {
    const bool again = k > 0 && value(random) > 0.4;
    double sum = 0;
    for (std::size_t i = 0; i < unknowns; ++i) {
      const double entry = again ? found.limits.row[(k - 1) * unknowns + i] : value(random);
      found.limits.row.push_back(entry);
      sum += entry;
    }
    found.limits.limit.push_back(sum - (value(random) > 0 ? 0 : 0.3));
  }
  return found;
}

TEST(LimitedChange, IsTheNearestOfAllSetsOfLimits) {
  std::mt19937 random(5);
  std::size_t held = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Program program = random_program(random, 1 + trial % 5, 1 + trial % 7);
    const std::vector<double> inverse = program.inverse();
    const std::vector<double> x0(program.start.data(), program.start.data() + program.start.size());
    const LimitedChange found = nearest_within(inverse, x0, program.limits);
    const auto exact = reference::nearest_within(program.mass, program.start, program.limits);
    ASSERT_TRUE(exact);
    EXPECT_TRUE(found.unmet.empty());
    for (std::size_t i = 0; i < x0.size(); ++i)
      EXPECT_NEAR(found.x[i], (*exact)(static_cast<Eigen::Index>(i)), 1e-7) << trial;
    for (const double multiplier : found.multiplier) EXPECT_GE(multiplier, 0);
    EXPECT_TRUE(found.held.empty() || independent(inverse, program.limits, found.held));
    held += found.held.size();
  }
  EXPECT_GT(held, 300U);
}

TEST(LimitedChange, HoldingThoseThatItFoundGivesTheSame) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 100; ++trial) {
    const Program program = random_program(random, 3, 6);
    const std::vector<double> inverse = program.inverse();
    const std::vector<double> x0(program.start.data(), program.start.data() + 3);
    const Eigen::VectorXd force = program.mass * program.start;
    const LimitedChange found = nearest_within(inverse, x0, program.limits);
    const HeldChange change = holding(inverse, program.limits, found.held);
    std::vector<double> x = change.given;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) x[i] += change.change[3 * i + j] * force(static_cast<Eigen::Index>(j));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(x[i], found.x[i], 1e-9) << trial;
    const std::span<const double> forces(force.data(), 3);
    EXPECT_TRUE(is_nearest(inverse, forces, program.limits, found.held, x));
    // One that is not held, or pulls, is found out.
    if (!found.held.empty()) {
      EXPECT_FALSE(is_nearest(inverse, forces, program.limits, {}, x0));
    }
  }
}

TEST(LimitedChange, ALimitThatPullsIsNotTheNearest) {
  // m x = F = 1 on one unknown, held at 0 by x >= 0: the multiplier is -1.
  const std::vector<double> one{1.0}, force{1.0}, held_at{0.0};
  const Limits limits{1, {1.0}, {0.0}};
  const std::vector<std::size_t> held{0};
  EXPECT_FALSE(is_nearest(one, force, limits, held, held_at));
  EXPECT_TRUE(is_nearest(one, force, limits, {}, force));
}

TEST(LimitedChange, WhatCannotBeMetIsSaid) {
  const std::vector<double> one{1.0}, start{0.0};
  const Limits limits{1, {1.0, -1.0}, {2.0, -1.0}};  // x >= 2 and x <= 1
  EXPECT_EQ(nearest_within(one, start, limits).unmet.size(), 1U);
}

TEST(LimitedChange, ThoseThatSayTheSameAreNotHeldTogether) {
  const std::vector<double> unit{1.0, 0.0, 0.0, 1.0};
  const Limits limits{2, {1.0, 2.0, -2.0, -4.0, 0.0, 1.0}, {0, 0, 0}};
  const std::vector<std::size_t> same{0, 1}, other{0, 2};
  EXPECT_FALSE(independent(unit, limits, same));
  EXPECT_TRUE(independent(unit, limits, other));
}

}  // namespace
}  // namespace spume::test
