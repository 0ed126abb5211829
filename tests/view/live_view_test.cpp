// SPDX-License-Identifier: MIT
// Runs with a viewer at the other end of a socket: what it is told, what it may do, and that the run does not mind it.
#include "spume/view/live_view.hpp"

#include <atomic>
#include <cstring>
#include <functional>
#include <thread>

#include "run/driver_fixture.hpp"
#include "view/server_fixture.hpp"
#include "view/socket_client.hpp"

namespace spume {
namespace {

using testing::Contains;
using testing::HasSubstr;

// A page: acknowledges frames and remembers what it was told.
class FakePage {
 public:
  explicit FakePage(const Server& server) : connection_(test::open_socket(server)) { say(test::ready); }
  void say(const std::string& text) { connection_->send(test::text_frame(text)); }
  // Reads until the condition holds; false after half a minute without that, or when the server has gone.
  bool read_until(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      bytes_ += connection_->receive([](const std::string& some) { return !some.empty(); });
      if (!take_frame() && connection_->gone()) return condition();
      while (take_frame()) {
      }
    }
    return true;
  }
  bool read_until_words(const std::string& words) {
    return read_until([&] { return state.value("words", "") == words; });
  }
  bool reads_line(const std::string& part) {
    return read_until([&] { return log.find(part) != std::string::npos; });
  }

  nlohmann::json hello = nlohmann::json::object(), state = hello, frame = hello;
  std::vector<nlohmann::json> rows;
  std::string log;
  int frames = 0;

 private:
  bool take_frame() {
    if (bytes_.size() < 2) return false;
    const auto byte = [&](std::size_t k) { return static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[k])); };
    std::uint64_t length = byte(1) & 127U;
    const std::size_t extra = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (bytes_.size() < 2 + extra) return false;
    if (extra > 0) length = 0;
    for (std::size_t k = 0; k < extra; ++k) length = length << 8U | byte(2 + k);
    if (bytes_.size() < 2 + extra + length) return false;
    const std::string payload = bytes_.substr(2 + extra, length);
    const std::uint64_t opcode = byte(0) & 15U;
    bytes_.erase(0, 2 + extra + length);
    if (opcode == 1) take_text(nlohmann::json::parse(payload));
    if (opcode != 2) return true;
    std::uint32_t arrays = 0;
    std::memcpy(&arrays, payload.data(), sizeof arrays);
    frame = nlohmann::json::parse(payload.substr(4 + arrays));
    ++frames;
    say(test::ready);
    return true;
  }
  void take_text(const nlohmann::json& message) {
    if (message["type"] == "hello") hello = message;
    if (message["type"] == "state") state = message;
    if (message["type"] == "series" && message["anew"]) rows.clear();
    if (message["type"] == "series")
      for (const auto& row : message["rows"]) rows.push_back(row);
    if (message["type"] == "log")
      for (const auto& line : message["lines"]) log += line.get<std::string>() + '\n';
  }
  std::unique_ptr<test::Connection> connection_;
  std::string bytes_;
};

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
