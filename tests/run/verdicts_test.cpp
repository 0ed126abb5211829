// SPDX-License-Identifier: MIT
#include "spume/run/verdicts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace spume {
namespace {

using Kind = Invariant::Kind;

const std::vector<SeriesColumn> columns = {{"t", "time"}, {"mass", "1"}, {"energy", "1"}, {"kinetic", "1"}};

InvariantWatch watched(const Invariant& invariant, const std::vector<std::vector<double>>& rows) {
  InvariantWatch watch({invariant}, columns);
  for (const auto& row : rows) watch.observe(row);
  return watch;
}

TEST(Verdicts, DriftIsTheLargestDistanceFromTheStart) {
  const Invariant mass{.quantity = "m", .kind = Kind::drift, .column = "mass", .bound = 0.1};
  const auto kept = watched(mass, {{0, 2, 0, 0}, {1, 2, 0, 0}}).verdicts().at(0);
  EXPECT_EQ(kept.value, 0);
  EXPECT_TRUE(kept.pass());
  const auto lost = watched(mass, {{0, 2, 0, 0}, {1, 1.5, 0, 0}, {2, 2.25, 0, 0}}).verdicts().at(0);
  EXPECT_EQ(lost.value, 0.25);
  EXPECT_FALSE(lost.pass());
  EXPECT_TRUE(watched(mass, {{0, 0, 0, 0}, {1, 0, 0, 0}}).verdicts().at(0).pass());  // nothing stays nothing
  EXPECT_FALSE(watched(mass, {{0, 0, 0, 0}, {1, 1e-300, 0, 0}}).verdicts().at(0).pass());
}

TEST(Verdicts, GrowthCountsAboveTheStartAndByItsScale) {
  Invariant energy{.quantity = "e", .kind = Kind::growth, .column = "energy", .bound = 0.1, .scale_column = "kinetic"};
  const std::vector<std::vector<double>> rows = {{0, 0, 5, 2}, {1, 0, 3, -4}, {2, 0, 5.5, 1}};
  EXPECT_EQ(watched(energy, rows).verdicts().at(0).value, 0.5 / 4);
  energy.scale_floor = 6;
  EXPECT_EQ(watched(energy, rows).verdicts().at(0).value, 0.5 / 10);
  // With what the column leaves out, which may take up what it loses.
  double left_out = 0.5;
  energy.beside = [&] { return left_out -= 0.125; };
  EXPECT_EQ(watched(energy, rows).verdicts().at(0).value, 0.25 / 10);
  // Decay is no growth.
  EXPECT_EQ(watched(energy, {{0, 0, 5, 2}, {1, 0, 3, 1}}).verdicts().at(0).value, 0);
}

TEST(Verdicts, ChangeCountsBothWaysByItsScale) {
  Invariant momentum{
      .quantity = "p", .kind = Kind::change, .column = "energy", .bound = 0.1, .scale_column = "kinetic"};
  const std::vector<std::vector<double>> rows = {{0, 0, 0, 2}, {1, 0, -3, 4}, {2, 0, 1, 1}};
  EXPECT_EQ(watched(momentum, rows).verdicts().at(0).value, 3.0 / 4);
  momentum.scale_factor = 10;
  momentum.scale_floor = 20;
  EXPECT_EQ(watched(momentum, rows).verdicts().at(0).value, 3.0 / 60);
  EXPECT_TRUE(watched(momentum, rows).verdicts().at(0).pass());
  double scale = 1;
  momentum.scale = [&] { return scale += 1; };  // 2, 3, 4 in place of the column
  EXPECT_EQ(watched(momentum, rows).verdicts().at(0).value, 3.0 / 60);
  momentum.scale_floor = 0;
  scale = 5;
  EXPECT_EQ(watched(momentum, rows).verdicts().at(0).value, 3.0 / 80);
}

TEST(Verdicts, LargestTakesEitherSign) {
  const Invariant residual{.quantity = "r", .kind = Kind::largest, .column = "mass", .bound = 3};
  const auto verdict = watched(residual, {{0, 1, 0, 0}, {1, -3, 0, 0}, {2, 2, 0, 0}}).verdicts().at(0);
  EXPECT_EQ(verdict.value, 3);
  EXPECT_TRUE(verdict.pass());
}

TEST(Verdicts, LargestIsBesideTheScaleOfItsRow) {
  const Invariant residual{
      .quantity = "r", .kind = Kind::largest, .column = "energy", .bound = 1, .scale_column = "kinetic"};
  // The largest value, 6, is half of what its row allows; 0 where nothing is allowed is nothing.
  const auto verdict = watched(residual, {{0, 0, 0, 0}, {1, 0, 6, 12}, {2, 0, -3, 4}}).verdicts().at(0);
  EXPECT_EQ(verdict.value, 0.75);
  EXPECT_FALSE(watched(residual, {{0, 0, 0, 0}, {1, 0, 1e-9, 0}}).verdicts().at(0).pass());
}

TEST(Verdicts, WhatIsNotANumberPassesNothing) {
  for (const Kind kind : {Kind::drift, Kind::growth, Kind::change, Kind::largest}) {
    const Invariant any{.quantity = "x", .kind = kind, .column = "mass", .bound = 1e300};
    EXPECT_FALSE(watched(any, {{0, 1, 0, 0}, {1, NAN, 0, 0}, {2, 1, 0, 0}}).verdicts().at(0).pass());
  }
}

TEST(Verdicts, ContinueFromWhatWasSeen) {
  const Invariant mass{.quantity = "m", .kind = Kind::drift, .column = "mass", .bound = 0.1};
  const auto before = watched(mass, {{0, 2, 0, 0}, {1, 1, 0, 0}});
  InvariantWatch after({mass}, columns);
  after.restore(before.seen());
  after.observe(std::vector<double>{2, 2, 0, 0});
  EXPECT_EQ(after.verdicts().at(0).value, 0.5);
  // Of another number of invariants nothing is known.
  InvariantWatch other({mass, mass}, columns);
  other.restore(before.seen());
  other.observe(std::vector<double>{2, 3, 0, 0});
  EXPECT_EQ(other.verdicts().at(0).value, 0);
}

TEST(Verdicts, AnInvariantNamesAColumn) {
  EXPECT_THROW(InvariantWatch({{.quantity = "x", .column = "nothing"}}, columns), std::logic_error);
}

TEST(Verdicts, OneStepInAHundredMayBeRefused) {
  EXPECT_TRUE(refused_steps(1, 5).pass());
  EXPECT_FALSE(refused_steps(2, 5).pass());
  EXPECT_TRUE(refused_steps(10, 1000).pass());
  EXPECT_FALSE(refused_steps(11, 1000).pass());
}

}  // namespace
}  // namespace spume
