// SPDX-License-Identifier: MIT
// Plans of stages: order, loops, conditions, and what the ledger is told.
#include "spume/methods/stage.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

namespace spume {
namespace {

using testing::ElementsAre;

struct Recorded {
  Plan plan;
  Ledger ledger;
  std::vector<std::string> order;

  void add(const std::string& name, StagePart part = StagePart::step, std::function<bool()> due = {}) {
    plan.add({.name = name,
              .reason = "test",
              .work = [this, name](StageRun&) { order.push_back(name); },
              .part = part,
              .due = due});
  }
};

// Answers true `times` times, then false once, and so on.
std::function<bool()> passes(int times) {
  return [times, left = times]() mutable {
    if (left-- > 0) return true;
    left = times;
    return false;
  };
}

TEST(Plan, RunsLoopsWithinLoops) {
  Recorded run;
  run.add("a");
  run.plan.repeat(passes(2), [&] {
    run.plan.repeat(passes(3), [&] { run.add("b"); });
    run.add("c");
  });
  run.plan.repeat(passes(0), [&] { run.add("never"); });
  run.add("d");
  for (int step = 0; step < 2; ++step) {
    run.order.clear();
    run.plan.run_step(0.1, 1, run.ledger);
    EXPECT_THAT(run.order, ElementsAre("a", "b", "b", "b", "c", "b", "b", "b", "c", "d"));
  }
}

TEST(Plan, RunsInAStartWhatBelongsToIt) {
  Recorded run;
  run.add("start", StagePart::start);
  run.plan.repeat(passes(2), [&] {
    run.add("both", StagePart::both);
    run.add("step");
  });
  run.plan.run_start(1, run.ledger);
  EXPECT_THAT(run.order, ElementsAre("start", "both", "both"));
}

TEST(Plan, RunsBeforeTheFirstRecordWhatBelongsThere) {
  Recorded run;
  run.add("before", StagePart::before);
  run.add("start", StagePart::start);
  run.add("both", StagePart::both);
  bool told = false;
  run.plan.add({.name = "long",
                .reason = "test",
                .work =
                    [&](StageRun& one) {
                      told = !one.go_on({"half", 0.5});
                    },
                .part = StagePart::before});
  run.plan.run_before(1, run.ledger, [](const HowFar& how_far) { return how_far.words != "half"; });
  EXPECT_THAT(run.order, ElementsAre("before"));
  EXPECT_TRUE(told);
}

// A start and the steps after it run different stages.
TEST(Plan, IsTheOrderOfTheLedger) {
  Recorded run;
  run.add("a", StagePart::both);
  run.add("b");
  run.add("c", StagePart::start);
  run.add("never", StagePart::step, [] { return false; });
  run.add("d", StagePart::both);
  run.plan.run_start(1, run.ledger);
  run.plan.run_step(0.1, 1, run.ledger);
  std::vector<std::string> listed;
  for (const Ledger::Entry& entry : run.ledger.entries()) listed.push_back(entry.stage);
  EXPECT_THAT(listed, ElementsAre("a", "b", "c", "d"));
}

TEST(Plan, SkipsWhatIsNotDueWithoutCountingIt) {
  Recorded run;
  int step = 0;
  run.add("sort", StagePart::step, [&] { return step % 3 == 0; });
  for (; step < 7; ++step) run.plan.run_step(0.1, 10, run.ledger);
  EXPECT_EQ(run.ledger.entries().at(0).calls, 3);
  EXPECT_EQ(run.ledger.entries().at(0).particles, 30);
}

TEST(Plan, CountsTheParticlesAndArraysOfAStage) {
  Plan plan;
  Ledger ledger;
  std::array<Array<float>, 2> pair{Array<float>(3), Array<float>(5)};
  const std::array<Array<float>, 2>* none = nullptr;
  plan.add({.name = "a",
            .reason = "test",
            .work = [](StageRun& run) { run.particles = 7, run.pairs = 11, run.bytes = 100; },
            .reads = {pair, none, ArrayUse([] { return 1000.0; })},
            .writes = {pair[0]}});
  plan.run_step(0.1, 10, ledger);
  EXPECT_EQ(ledger.entries().at(0).particles, 7);
  EXPECT_EQ(ledger.entries().at(0).pairs, 11);
  EXPECT_EQ(ledger.entries().at(0).bytes, 4 * 8 + 1000 + 4 * 3 + 100);
}

TEST(Plan, RefusesWhatCannotRun) {
  Recorded run;
  run.add("a");
  EXPECT_THROW(run.add("a"), std::logic_error);
  EXPECT_THROW(run.plan.add({.name = "idle", .reason = "test"}), std::logic_error);
  EXPECT_THROW(run.plan.repeat(passes(1), [] {}), std::logic_error);
}

}  // namespace
}  // namespace spume
