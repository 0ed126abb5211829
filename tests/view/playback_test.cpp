// SPDX-License-Identifier: MIT
// Results in the view: the state that a viewer asks for, two runs beside each other, a run that goes on.
#include "spume/view/playback.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "spume/core/error.hpp"
#include "spume/io/vtkhdf.hpp"
#include "support/temporary_folder.hpp"
#include "view/fake_page.hpp"
#include "view/server_fixture.hpp"

namespace spume {
namespace {

using test::FakePage;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* case_text =
    "title = \"Two drops\"\nmethod = \"any\"\n[domain]\nlower = [0, 0]\nupper = [2, 1]\n[resolution]\nspacing = 0.25\n";

class Played : public test::WithServer<testing::Test> {
 protected:
  void TearDown() override {
    ended_ = true;
    if (thread_.joinable()) thread_.join();
    WithServer::TearDown();
  }
  // Adds states at times 0, 0.1, ... of five particles with p = 10 * state.
  void add_states(const std::string& run, std::size_t first, std::size_t last) {
    const auto path = folder_ / run;
    std::filesystem::create_directories(path);
    if (first == 0) {
      test::write_contents(path / "case.toml", case_text);
      test::write_contents(
          path / "series.csv",
          "# title\n# t: time\n# kinetic_energy: rho u^2 / 2\nstep,t,dt,kinetic_energy\n0,0,0,1.5\n1,0.1,0.1,2\n");
      test::write_contents(path / "log.txt", "a line\n");
      test::write_contents(path / "ledger.json", R"({"stages": [{"stage": "pressure", "calls": 3, "seconds": 0.5}]})");
    }
    if (!file_ || first == 0) file_.emplace(path / "fluid.vtkhdf", VtkhdfFile::Options{});
    for (std::size_t step = first; step < last; ++step) {
      const std::vector<double> x{0, 0.25, 0.5, 0.75, 1}, y(5, 0.5), p(5, 10.0 * static_cast<double>(step));
      file_->append(0.1 * static_cast<double>(step),
                    {"fluid", 5, {x.data(), y.data()}, {{"pressure", {p.data()}, {}}}});
    }
  }
  void play(const std::vector<std::string>& names) {
    std::vector<std::unique_ptr<PlayedRun>> runs;
    for (const std::string& name : names) runs.push_back(std::make_unique<PlayedRun>(folder_ / name));
    playback_.emplace(server_, std::move(runs));
    thread_ = std::thread([this] {
      while (!ended_) playback_->serve(std::chrono::milliseconds(10));
    });
  }
  static std::string asking(const std::string& more) {
    return R"({"do":"ready","points":1000,"bits":16,)" + more + "}";
  }

  const test::TemporaryFolder folder_;
  std::optional<VtkhdfFile> file_;
  std::optional<Playback> playback_;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

TEST_F(Played, AViewerSeesTheStateThatItAsksFor) {
  add_states("run", 0, 4);
  play({"run"});
  FakePage page(server_, false);
  ASSERT_TRUE(page.read_until([&] { return page.frames == 1; }));
  EXPECT_EQ(page.hello["title"], "Two drops");
  EXPECT_EQ(page.hello["dimensions"], 2);
  EXPECT_EQ(page.hello["times"].size(), 4U);
  EXPECT_EQ(page.hello["may_steer"], false);
  EXPECT_EQ(page.hello["columns"][3]["unit"], "rho u^2 / 2");
  EXPECT_EQ(page.rows.size(), 2U);
  EXPECT_EQ(page.rows[1][3], 2);
  EXPECT_THAT(page.log, HasSubstr("a line"));
  EXPECT_EQ(page.frame["time"], 0);
  page.say(page.wish = asking(R"("snapshot":3,"pick":{"family":"fluid","at":[0.7,0.5]})"));
  ASSERT_TRUE(page.read_until([&] { return page.frames == 2; }));
  EXPECT_NEAR(page.frame["time"].get<double>(), 0.3, 1e-12);
  EXPECT_EQ(page.frame["picked"]["index"], 3);
  EXPECT_EQ(page.frame["picked"]["values"][0]["values"][0], 30);
  // One beyond the last is the last; what is known is not sent again.
  page.say(page.wish = asking(R"("snapshot":100)"));
  ASSERT_TRUE(page.read_until([&] { return page.frames == 3; }));
  EXPECT_EQ(page.frame["step"], 3);
  page.say(page.wish);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  page.say(asking(R"("snapshot":0)"));
  ASSERT_TRUE(page.read_until([&] { return page.frame["step"] == 0; }));
  EXPECT_EQ(page.frames, 4);
}

TEST_F(Played, APlaceTellsWhatItWentThrough) {
  add_states("run", 0, 7);
  play({"run"});
  FakePage page(server_, false);
  page.say(page.wish = asking(R"("point":[0.5,0.5])"));
  ASSERT_TRUE(page.read_until([&] { return page.past.size() >= 7; }));
  for (std::size_t step = 0; step < 7; ++step) {
    EXPECT_NEAR(page.past[step]["time"].get<double>(), 0.1 * static_cast<double>(step), 1e-12);
    EXPECT_NEAR(page.past[step]["values"][0]["value"].get<double>(), 10.0 * static_cast<double>(step), 1e-4);
  }
}

TEST_F(Played, TwoRunsAreSeenAtTheSameTime) {
  add_states("long", 0, 9);
  add_states("short", 0, 3);
  play({"long", "short"});
  FakePage page(server_, false);
  page.say(page.wish = asking(R"("snapshot":2)"));
  ASSERT_TRUE(page.read_until([&] { return page.frames > 0 && page.frame["step"] == 2; }));
  ASSERT_EQ(page.frame["blocks"].size(), 2U);
  EXPECT_EQ(page.frame["blocks"][1]["side"], 1);
  EXPECT_NEAR(page.frame["beside"]["time"].get<double>(), 0.2, 1e-12);
  EXPECT_THAT(page.hello["beside"]["folder"].get<std::string>(), HasSubstr("short"));
  page.say(page.wish = asking(R"("snapshot":8)"));  // the other one has ended
  ASSERT_TRUE(page.read_until([&] { return page.frame["step"] == 8; }));
  EXPECT_NEAR(page.frame["beside"]["time"].get<double>(), 0.2, 1e-12);
}

TEST_F(Played, ARunThatGoesOnGrowsInTheView) {
  add_states("run", 0, 2);
  play({"run"});
  FakePage page(server_, false);
  ASSERT_TRUE(page.read_until([&] { return page.frames > 0; }));
  EXPECT_EQ(page.hello["times"].size(), 2U);
  add_states("run", 2, 5);
  EXPECT_TRUE(page.read_until([&] { return page.hello["times"].size() == 5; }));
}

TEST(PlayedRun, AFileOfAnotherProgramHasTheBoxOfItsParticles) {
  const test::TemporaryFolder folder;
  std::vector<double> x, y, z;
  for (int i = 0; i < 1000; ++i) x.push_back(i % 10), y.push_back(i / 10 % 10), z.push_back(i / 100);
  VtkhdfFile(folder / "cloud.vtkhdf", {}).append(1, {"cloud", 1000, {x.data(), y.data(), z.data()}, {}});
  PlayedRun run(folder / "cloud.vtkhdf");
  EXPECT_EQ(run.dimensions, 3);
  EXPECT_THAT(run.lower, ElementsAre(0, 0, 0));
  EXPECT_THAT(run.upper, ElementsAre(9, 9, 9));
  EXPECT_NEAR(run.spacing, 0.9, 1e-12);  // 1000 of them in 9^3
  EXPECT_EQ(run.state(0).families.at(0).size, 1000U);
}

TEST(PlayedRun, WhatHoldsNoResultIsRefused) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(PlayedRun(folder / "none"), InputError);
  EXPECT_THROW(PlayedRun(folder.path()), InputError);
  test::write_contents(folder / "text.vtkhdf", "text");
  EXPECT_THROW(PlayedRun(folder / "text.vtkhdf"), FileError);
}

}  // namespace
}  // namespace spume
