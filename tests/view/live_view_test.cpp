// SPDX-License-Identifier: MIT
// Runs with a viewer at the other end of a socket: what it is told, what it may do, and that the run does not mind it.
#include "spume/view/live_view.hpp"

#include <atomic>
#include <thread>

#include "run/driver_fixture.hpp"
#include "view/fake_page.hpp"
#include "view/server_fixture.hpp"

namespace spume {
namespace {

using test::FakePage;

class Viewed : public test::WithServer<Driver> {
 protected:
  void TearDown() override {
    // A test that failed has left its run.
    if (runner_.joinable() && !done_) raise(SIGINT);
    if (runner_.joinable()) runner_.join();
    WithServer::TearDown();
  }

  void launch(const std::string& name, bool paused) {
    runner_ = std::thread([this, name, paused] {
      Watch watch;
      OptionInfo option;
      option.key = "dt";
      option.steerable = true;
      LiveView view(server_, watch, {option}, paused);
      const auto simulation = start(name);
      simulation->allow_steering({load_fake_case, make_fake_method, {"dt", "time.end"}});
      state_ = simulation->run(view);
      done_ = true;
      view.finish(state_ == RunState::finished ? "finished" : "interrupted");
    });
  }
  RunState result() {
    runner_.join();
    return state_;
  }

  std::thread runner_;
  std::atomic<bool> done_ = false;
  RunState state_ = RunState::interrupted;
};

TEST_F(Viewed, AViewerIsToldEverything) {
  write_case("title = \"Round and round\"\nend = 0.5\nevery = 0.1\n");
  launch("run", true);
  FakePage page(server_);
  ASSERT_TRUE(page.read_until([&] { return page.frames > 0; }));
  EXPECT_EQ(page.hello["title"], "Round and round");
  EXPECT_EQ(page.hello["dimensions"], 2);
  EXPECT_EQ(page.hello["columns"][3]["name"], "radius");
  EXPECT_EQ(page.hello["plan"].size(), 3U);
  EXPECT_EQ(page.state["words"], "paused");
  EXPECT_EQ(page.frame["step"], 0);
  EXPECT_EQ(page.frame["blocks"][0]["family"], "fluid");
  EXPECT_EQ(page.frame["blocks"][0]["count"], 50);
  page.say(R"({"do": "go"})");
  ASSERT_TRUE(page.read_until_words("finished"));
  EXPECT_EQ(result(), RunState::finished);
  // Every row of series.csv has come, the first and the last among them.
  ASSERT_FALSE(page.rows.empty());
  EXPECT_EQ(page.rows.front()[0], 0);
  EXPECT_EQ(page.rows.back()[1], 0.5);
  EXPECT_EQ(page.rows.size(), page.rows.back()[0].get<std::size_t>() + 1);
  EXPECT_EQ(page.state["step"], page.rows.back()[0]);
}

TEST_F(Viewed, AViewerPausesStepsAndStops) {
  write_case("end = 1000\nsleep = 0.001\n");
  launch("run", false);
  FakePage page(server_);
  ASSERT_TRUE(page.read_until([&] { return page.state.value("step", 0) > 5; }));
  page.say(R"({"do": "pause"})");
  ASSERT_TRUE(page.read_until_words("paused"));
  const int step = page.state["step"];
  ASSERT_TRUE(page.read_until([&] { return page.frame["step"] == step; }));  // which follows
  page.say(R"({"do": "step"})");
  ASSERT_TRUE(page.read_until([&] { return page.state["step"] == step + 1 && page.state["words"] == "paused"; }));
  page.say(R"({"do": "checkpoint"})");
  ASSERT_TRUE(page.reads_line("checkpoint after step " + std::to_string(step + 1)));
  page.say(R"({"do": "snapshot"})");
  ASSERT_TRUE(page.reads_line("snapshot after step " + std::to_string(step + 1)));
  EXPECT_EQ(page.state["step"], step + 1);
  page.say(R"({"do": "stop"})");
  EXPECT_EQ(result(), RunState::interrupted);
  EXPECT_EQ(summary("run")["state"], "interrupted");
}

TEST_F(Viewed, AViewerStopsARunThatPrepares) {
  write_case("end = 1\nsleep = 0.001\nprepares = 1000000\n");
  launch("run", false);
  FakePage page(server_);
  ASSERT_TRUE(page.read_until([&] { return page.state.value("limit", "").rfind("round ", 0) == 0; }));
  EXPECT_EQ(page.state["words"], "preparing");
  EXPECT_EQ(page.state["end"], 1);
  EXPECT_EQ(page.hello["dimensions"], 2);
  page.say(R"({"do": "stop"})");
  ASSERT_TRUE(page.read_until_words("interrupted"));
  EXPECT_EQ(result(), RunState::interrupted);
  EXPECT_EQ(page.frames, 0);
  EXPECT_NE(page.log.find("start the run again"), std::string::npos);
}

TEST_F(Viewed, WhatAViewerAsksOfARunThatPreparesWaitsForItsFirstStep) {
  write_case("end = 1\nsleep = 0.001\nprepares = 1000\n");
  launch("run", false);
  FakePage page(server_);
  ASSERT_TRUE(page.read_until_words("preparing"));
  page.say(R"({"do": "steer", "key": "dt", "value": "0.002"})");
  page.say(R"({"do": "pause"})");
  ASSERT_TRUE(page.read_until_words("paused"));
  EXPECT_EQ(page.state["step"], 0);
  ASSERT_TRUE(page.reads_line("steered after step 0: dt = 0.002"));
  ASSERT_TRUE(page.read_until([&] { return page.frames > 0; }));
  EXPECT_FALSE(page.hello["columns"].empty());
  page.say(R"({"do": "stop"})");
  EXPECT_EQ(result(), RunState::interrupted);
}

// Frames of a state that is known would keep both sides busy for nothing.
TEST_F(Viewed, APausedRunSendsNothingTwice) {
  write_case("end = 1000\n");
  launch("run", true);
  FakePage page(server_);
  ASSERT_TRUE(page.read_until([&] { return page.frames > 0; }));
  const auto later = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  std::thread stopping([&] {
    std::this_thread::sleep_until(later);
    raise(SIGINT);
  });
  page.read_until_words("interrupted");
  stopping.join();
  EXPECT_EQ(page.frames, 1);
  EXPECT_EQ(result(), RunState::interrupted);
}

TEST_F(Viewed, AViewerSteers) {
  write_case("end = 1\n");
  launch("run", true);
  FakePage page(server_);
  ASSERT_TRUE(page.read_until_words("paused"));
  page.say(R"({"do": "steer", "key": "dimensions", "value": "3"})");
  ASSERT_TRUE(page.reads_line("refused: 'dimensions' cannot be changed"));
  page.say(R"({"do": "steer", "key": "dt", "value": "0.002"})");
  ASSERT_TRUE(page.reads_line("steered after step 0: dt = 0.002"));
  page.say(R"({"do": "go"})");
  ASSERT_TRUE(page.read_until_words("finished"));
  EXPECT_EQ(result(), RunState::finished);
  EXPECT_GT(page.state["step"], 300);
  EXPECT_EQ(read_steering(folder_ / "run" / "steering.csv").front().key, "dt");
}

TEST_F(Viewed, WhoMayOnlyLookIsToldAndCannotSteer) {
  write_case("end = 1000\nsleep = 0.001\n");
  launch("run", false);
  FakePage looks(server_, false), steers(server_);
  ASSERT_TRUE(looks.read_until([&] { return looks.frames > 0; }));
  ASSERT_TRUE(steers.read_until([&] { return steers.frames > 0; }));
  EXPECT_EQ(looks.hello["may_steer"], false);
  EXPECT_EQ(steers.hello["may_steer"], true);
  EXPECT_EQ(steers.hello["fields"]["velocity"]["unit"], "length/time");
  looks.say(R"({"do": "stop"})");
  const int step = steers.state["step"];
  ASSERT_TRUE(steers.read_until([&] { return steers.state["step"] > step + 5; }));  // it goes on
  steers.say(R"({"do": "stop"})");
  EXPECT_EQ(result(), RunState::interrupted);
}

TEST_F(Viewed, LookingChangesNothing) {
  write_case(std::string(full_case) + "sleep = 0.002\n");
  Watch watch;
  start("whole")->run(watch);
  launch("seen", false);
  FakePage page(server_);
  ASSERT_TRUE(page.read_until_words("finished"));
  EXPECT_EQ(result(), RunState::finished);
  expect_equal_results("whole", "seen");
}

TEST_F(Viewed, TheRunGoesOnWithoutAViewerThatIsSilentOrGone) {
  write_case("end = 0.5\nsleep = 0.002\n");
  const auto silent = test::open_socket(server_);
  silent->send(test::text_frame(test::ready));
  {
    FakePage gone(server_);
    launch("run", false);
    gone.read_until([&] { return gone.frames > 0; });
  }
  EXPECT_EQ(result(), RunState::finished);
}

}  // namespace
}  // namespace spume
