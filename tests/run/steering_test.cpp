// SPDX-License-Identifier: MIT
// Changes by hand: their file, what they do to a run, and that a replay and a resumed run have the same bits.
#include <functional>
#include <map>

#include "run/driver_fixture.hpp"
#include "spume/io/checkpoint.hpp"

namespace spume {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

// Does something after a step, and may stop after another.
class Hand final : public Observer {
 public:
  using Deed = std::function<void(Simulation&)>;
  explicit Hand(std::map<std::int64_t, Deed> deeds, std::int64_t stop_after = -1)
      : deeds_(std::move(deeds)), stop_after_(stop_after) {}
  void progress(const Progress&) override {}
  void note(const std::string& text) override { notes.push_back(text); }
  void between_steps(Simulation& simulation) override {
    const std::int64_t step = simulation.method().step_count();
    if (const auto deed = deeds_.find(step); deed != deeds_.end()) {
      const Deed does = deed->second;
      deeds_.erase(deed);
      does(simulation);
    }
    if (step == stop_after_) simulation.request_stop();
  }
  std::vector<std::string> notes;

 private:
  std::map<std::int64_t, Deed> deeds_;
  std::int64_t stop_after_;
};

Hand::Deed setting(const std::string& key, const std::string& value) {
  return [=](Simulation& simulation) { simulation.steer(key, value); };
}

std::vector<std::string> reasons(const InputError& error) {
  std::vector<std::string> texts;
  for (const Problem& problem : error.problems()) texts.push_back(problem.message());
  return texts;
}

class Steering : public Driver {
 protected:
  SteeringMeans means() {
    return {load_fake_case, make_fake_method, {"dt", "time.end", "every", "series_every", "particles", "max_retries"}};
  }
  std::unique_ptr<Simulation> steerable(const std::string& name) {
    auto simulation = start(name);
    simulation->allow_steering(means());
    return simulation;
  }
  std::unique_ptr<Simulation> steerable_again(const std::string& name) {
    auto simulation = resume(name);
    simulation->allow_steering(means());
    return simulation;
  }
  std::unique_ptr<Simulation> replaying(const std::string& name, const std::string& of) {
    auto simulation = steerable(name);
    simulation->replay(read_steering(folder_ / of / "steering.csv"));
    return simulation;
  }
  std::map<std::int64_t, Hand::Deed> changes() {
    return {{10, setting("dt", "0.007")},
            {17, [](Simulation& simulation) { simulation.snapshot_now(); }},
            {30, setting("every", "0.21")},
            {41, setting("time.end", "1.2")}};
  }
};

TEST_F(Steering, ItsFileKeepsEveryDigitAndAnyText) {
  const std::vector<SteeringRow> rows{{0, 0, "forces.body", "[\"0.1*x\", \"say \\\"no\\\"\"]"},
                                      {120, 0.1 + 0.2, "fluid.gravity", "9.81"},
                                      {120, 0.1 + 0.2, snapshot_key, ""}};
  write_steering(folder_ / "steering.csv", rows);
  EXPECT_EQ(read_steering(folder_ / "steering.csv"), rows);
  EXPECT_THAT(steering_overrides(rows),
              ElementsAre("forces.body=[\"0.1*x\", \"say \\\"no\\\"\"]", "fluid.gravity=9.81"));
}

TEST_F(Steering, AnEntryOfAListIsAnOption) {
  EXPECT_EQ(steered_option("phase.0.viscosity"), "phase.viscosity");
  EXPECT_EQ(steered_option("domain.wall_velocity.top"), "domain.wall_velocity.top");
  EXPECT_EQ(steered_option("7"), "");
  EXPECT_EQ(steered_option("a..b"), "a..b");
}

TEST_F(Steering, ADamagedFileIsRefusedWithItsLines) {
  const auto refusal = [&](const std::string& text) -> std::vector<std::string> {
    test::write_contents(folder_ / "bad.csv", text);
    try {
      read_steering(folder_ / "bad.csv");
    } catch (const InputError& error) {
      return reasons(error);
    }
    return {};
  };
  EXPECT_THAT(refusal(""), ElementsAre(HasSubstr("expected the columns step,t,key,value")));
  EXPECT_THAT(refusal("t,value\n"), ElementsAre(HasSubstr("bad.csv:1:1: error: expected the columns")));
  EXPECT_THAT(refusal("# by hand\nstep,t,key,value\n1,0.1,a.b\nx,0,a,1\n2,nan,a,1\n3,0.3,a,1\n2,0.2,a,1\n"),
              ElementsAre(AllOf(HasSubstr(":3:"), HasSubstr("found 3 entries")),
                          AllOf(HasSubstr(":4:"), HasSubstr("step 'x'")), AllOf(HasSubstr(":5:"), HasSubstr("t 'nan'")),
                          AllOf(HasSubstr(":7:"), HasSubstr("step 2 comes after step 3"))));
  EXPECT_THROW(read_steering(folder_ / "none.csv"), FileError);
}

TEST_F(Steering, AChangeTakesEffectAfterItsStepAndIsNoted) {
  write_case("end = 0.5\ndt = 0.013\n");
  Hand hand({{10, setting("dt", "0.002")}});
  const auto simulation = steerable("run");
  EXPECT_EQ(simulation->run(hand), RunState::finished);
  const auto rows = read_steering(folder_ / "run" / "steering.csv");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].step, 10);
  EXPECT_EQ(rows[0].key, "dt");
  EXPECT_EQ(rows[0].value, "0.002");
  // Ten steps of about 0.013, and then ones of about 0.002.
  EXPECT_GT(rows[0].time, 0.1);
  EXPECT_GT(simulation->method().step_count(), 100);
  EXPECT_THAT(contents(folder_ / "run" / "log.txt"), HasSubstr("steered after step 10"));
}

TEST_F(Steering, AReplayHasTheSameBits) {
  write_case(full_case);
  Hand hand(changes()), nobody({});
  EXPECT_EQ(steerable("whole")->run(hand), RunState::finished);
  EXPECT_EQ(replaying("replay", "whole")->run(nobody), RunState::finished);
  expect_equal_results("whole", "replay");
  EXPECT_EQ(contents(folder_ / "whole" / "steering.csv"), contents(folder_ / "replay" / "steering.csv"));
  EXPECT_EQ(summary("replay")["t"], summary("whole")["t"]);
  EXPECT_THAT(nobody.notes, Contains(HasSubstr("replayed after step 10: dt = 0.007")));
  EXPECT_THAT(nobody.notes, Not(Contains(HasSubstr("departed"))));
}

TEST_F(Steering, AnInterruptedRunContinuesWithItsChanges) {
  write_case(full_case);
  Hand hand(changes());
  steerable("whole")->run(hand);
  for (const std::int64_t stop : {10, 15, 17, 41, 50}) {
    const std::string name = "stopped-" + std::to_string(stop);
    // Before the stop by hand; after it as a replay of what has yet to be made.
    Hand stopping({}, stop), continuing({});
    EXPECT_EQ(replaying(name, "whole")->run(stopping), RunState::interrupted);
    EXPECT_EQ(steerable_again(name)->run(continuing), RunState::finished);
    expect_equal_results("whole", name);
  }
}

// What a kill leaves: a checkpoint from before the changes, and the file with them.
TEST_F(Steering, AKilledRunMakesItsChangesAgain) {
  write_case(full_case);
  Hand hand(changes()), nobody({});
  steerable("whole")->run(hand);
  Hand early({}, 5);
  steerable("killed")->run(early);
  std::filesystem::copy_file(folder_ / "whole" / "steering.csv", folder_ / "killed" / "steering.csv");
  EXPECT_EQ(steerable_again("killed")->run(nobody), RunState::finished);
  expect_equal_results("whole", "killed");
}

TEST_F(Steering, ARefusedChangeLeavesTheRunAsItWas) {
  write_case(full_case);
  Watch watch;
  start("whole")->run(watch);
  std::vector<std::string> refused;
  const auto trying = [&](const std::string& key, const std::string& value) -> Hand::Deed {
    return [&refused, key, value](Simulation& simulation) {
      try {
        simulation.steer(key, value);
      } catch (const InputError& error) {
        refused.emplace_back(error.what());
      }
    };
  };
  // An option that cannot be steered, no value, two lines, an end that is over, a case that the method refuses.
  Hand hand({{5, trying("dimensions", "2")},
             {10, trying("dt", "")},
             {15, trying("dt", "1\nend = 3")},
             {20, trying("time.end", "0.1")},
             {25, trying("particles", "-1")}});
  EXPECT_EQ(steerable("tried")->run(hand), RunState::finished);
  EXPECT_THAT(refused, ElementsAre(HasSubstr("'dimensions' cannot be changed"), HasSubstr("needs a value"),
                                   HasSubstr("needs a value on one line"), HasSubstr("already at t"),
                                   HasSubstr("the method needs particles")));
  expect_equal_results("whole", "tried");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "tried" / "steering.csv"));
}

TEST_F(Steering, AReplayThatDepartsSaysSo) {
  write_case("end = 0.5\n");
  Hand hand({{10, setting("dt", "0.005")}}), nobody({});
  steerable("run")->run(hand);
  write_case("end = 0.5\ndt = 0.011\n");
  replaying("other", "run")->run(nobody);
  EXPECT_THAT(nobody.notes, Contains(HasSubstr("the replay has departed from its run")));
  // A change that this run does not allow is refused before the first step.
  const auto plain = start("plain");
  EXPECT_THROW(plain->replay({{3, 0.1, "dt", "0.005"}}), InputError);
}

TEST_F(Steering, AnEndGivenToResumeHoldsOverOneSteeredBefore) {
  write_case(full_case);
  Hand hand({{10, setting("time.end", "0.3")}}), nobody({}), again({}, 40);
  steerable("run")->run(hand);
  EXPECT_EQ(resume("run", 0.9)->run(again), RunState::interrupted);
  const auto simulation = steerable_again("run");
  EXPECT_EQ(simulation->run(nobody), RunState::finished);
  EXPECT_NEAR(simulation->method().time(), 0.9, 1e-9);
}

// Numbers of events are kept in checkpoints; with another interval they mean other times.
TEST_F(Steering, OutputsOfAChangedIntervalFallOnItsMultiples) {
  write_case("end = 1\nevery = 0.1\n");
  Hand hand({{30, setting("every", "0.25")}, {60, setting("every", "0.02")}});
  steerable("run")->run(hand);
  const auto times = read_vtkhdf_contents(folder_ / "run" / "fluid.vtkhdf").times;
  for (std::size_t k = 1; k < times.size(); ++k) EXPECT_GT(times[k], times[k - 1]);
  EXPECT_THAT(times, Contains(testing::DoubleNear(0.5, 1e-12)));
  EXPECT_THAT(times, Contains(testing::DoubleNear(0.98, 1e-12)));
  EXPECT_EQ(times.back(), 1);
}

}  // namespace
}  // namespace spume
