// SPDX-License-Identifier: MIT
#include "spume/run/schedule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace spume {
namespace {

TEST(Schedule, LandsExactlyOnMultiplesOfTheInterval) {
  Schedule schedule({10, 0.1, 0, 0});
  double t = 0;
  std::vector<double> outputs;
  for (int step = 0; step < 10000 && !schedule.finished(t); ++step) {
    t += schedule.step(t, 0.013 * (1 + 0.5 * std::sin(step)));
    if (schedule.arrive(t).output) outputs.push_back(t);
  }
  ASSERT_EQ(outputs.size(), 100u);
  // Two roundings, of the difference and of the sum, separate a landing from k * interval.
  for (std::size_t k = 1; k <= outputs.size(); ++k)
    EXPECT_NEAR(outputs[k - 1], static_cast<double>(k) * 0.1, 2e-16 * static_cast<double>(k) * 0.1) << k;
}

TEST(Schedule, LeavesNoSliverBeforeAnEvent) {
  Schedule schedule({1, 0, 0, 0});
  EXPECT_DOUBLE_EQ(schedule.step(0, 0.4), 0.4);
  EXPECT_DOUBLE_EQ(schedule.step(0.4, 0.59), 0.3);  // two equal steps, not 0.59 and 0.01
  EXPECT_DOUBLE_EQ(schedule.step(0.7, 0.59), 0.3);
  double t = 0, smallest = 1;
  Schedule outputs({1, 0.1, 0, 0});
  while (!outputs.finished(t)) {
    const double dt = outputs.step(t, 0.0099);
    smallest = std::min(smallest, dt);
    t += dt;
    outputs.arrive(t);
  }
  EXPECT_GE(smallest, 0.0099 / 2);
}

// Half of what remains, and half of that again, would be a step for every digit.
TEST(Schedule, ALimitThatAimsAtAnEventMayMissItByRounding) {
  const Schedule schedule({1, 0.2, 0, 0});
  const double remaining = 0.2 - 0.15;
  for (const double limit : {std::nextafter(remaining, 0), std::nextafter(remaining, 1)})
    EXPECT_EQ(schedule.step(0.15, limit), remaining);
}

TEST(Schedule, EventsThatDifferByRoundingCoincide) {
  Schedule schedule({1, 0.3, 0.1, 0});  // 3 * 0.1 is not 0.3 in binary
  double t = 0;
  int steps = 0;
  while (!schedule.finished(t)) {
    t += schedule.step(t, 1);
    const auto due = schedule.arrive(t);
    EXPECT_TRUE(due.series);
    ++steps;
  }
  EXPECT_EQ(steps, 10);
}

TEST(Schedule, EventsThatDifferByTheDigitsOfACaseCoincide) {
  Schedule schedule({10, 0.1, 0.1 * (1 + 2.5e-11), 0});
  double t = 0, smallest = 1;
  int both = 0;
  while (!schedule.finished(t)) {
    const double dt = schedule.step(t, 0.04);
    smallest = std::min(smallest, dt);
    t += dt;
    const Schedule::Due due = schedule.arrive(t);
    EXPECT_EQ(due.output, due.series) << t;
    both += due.output && due.series ? 1 : 0;
  }
  EXPECT_EQ(both, 100);
  EXPECT_GE(smallest, 0.02);
}

TEST(Schedule, TheEndMakesEverythingDue) {
  Schedule schedule({0.25, 0.1, 0.1, 0.2});
  const auto due = schedule.arrive(0.25);
  EXPECT_TRUE(due.output && due.series && due.spectrum && due.end);
  Schedule without_spectra({0.25, 0.1, 0.1, 0});
  EXPECT_FALSE(without_spectra.arrive(0.25).spectrum);
}

TEST(Schedule, EveryStepIsInTheSeriesWithoutAnInterval) {
  Schedule schedule({1, 0.5, 0, 0});
  EXPECT_TRUE(schedule.arrive(0.01).series);
  EXPECT_FALSE(schedule.arrive(0.02).output);
}

TEST(StepControl, HalvesOnRefusalAndDoublesBack) {
  StepControl control;
  EXPECT_EQ(control.allowed(1), 1);
  control.refused(1);
  control.refused(control.allowed(1));
  EXPECT_EQ(control.allowed(1), 0.25);
  control.accepted(1);
  EXPECT_EQ(control.allowed(1), 0.5);
  control.accepted(1);
  EXPECT_EQ(control.allowed(1), 1);
  EXPECT_TRUE(std::isinf(control.cap()));
}

}  // namespace
}  // namespace spume
