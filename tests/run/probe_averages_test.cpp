// SPDX-License-Identifier: MIT
// Averaged pressures of probes, by themselves and in runs of the fake method, whose pressure at the first probe is
// 0.5 + t.
#include "spume/run/probe_averages.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <cctype>
#include <cmath>
#include <sstream>

#include "spume/run/driver.hpp"
#include "support/fake_method.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using test::contents;
using test::load_fake_case;
using test::make_fake_method;

class Steps final : public Observer {
 public:
  explicit Steps(std::int64_t stop_after = -1) : stop_after_(stop_after) {}
  void progress(const Progress& progress) override {
    length.push_back(progress.dt);
    if (progress.step == stop_after_) raise(SIGINT);
  }
  void note(const std::string&) override {}
  std::vector<double> length;

 private:
  std::int64_t stop_after_;
};

class ProbeAveragesOfARun : public testing::Test {
 protected:
  void write_case(const std::string& text) { test::write_contents(folder_ / "case.toml", text); }
  void run(const std::string& name, Steps& steps) {
    Simulation::start(load_fake_case((folder_ / "case.toml").string(), {}), make_fake_method, folder_ / name)
        ->run(steps);
  }
  // The first two columns of probes.csv: time and pressure.
  std::vector<std::array<double, 2>> rows(const std::string& name) {
    std::istringstream lines(contents(folder_ / name / "probes.csv"));
    std::vector<std::array<double, 2>> values;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || !std::isdigit(static_cast<unsigned char>(line[0]))) continue;
      const std::size_t comma = line.find(',');
      values.push_back({std::stod(line), std::stod(line.substr(comma + 1))});
    }
    return values;
  }
  test::TemporaryFolder folder_;
};

// Rows as far apart as the average is long: their sum is that of p dt over all steps, to rounding. Without the average
// a row holds the pressure of its own step.
TEST_F(ProbeAveragesOfARun, RowsHoldTheWholeImpulse) {
  write_case("end = 0.3\nseries_every = 0.02\nprobes = true\naverage = 0.02\n");
  Steps steps;
  run("run", steps);
  double time = 0, impulse = 0;
  for (const double dt : steps.length) {
    time += dt;
    impulse += (0.5 + time) * dt;
  }
  const auto recorded = rows("run");
  ASSERT_EQ(recorded.size(), 16U);
  EXPECT_EQ(recorded[0][1], 0.5);  // nothing to average yet
  double sum = 0;
  for (std::size_t k = 1; k < recorded.size(); ++k) sum += recorded[k][1] * (recorded[k][0] - recorded[k - 1][0]);
  EXPECT_NEAR(sum, impulse, 1e-12);
  EXPECT_GT(std::abs(recorded[1][1] - (0.5 + recorded[1][0])), 1e-4);  // steps of 0.013 and 0.007, and their pressures
}

TEST_F(ProbeAveragesOfARun, AContinuedRunAveragesOverItsBreak) {
  write_case("end = 1.0\nseries_every = 0.02\nprobes = true\naverage = 0.05\n");
  Steps steps, stopping(30), continuing;
  run("whole", steps);
  run("stopped", stopping);
  Simulation::resume(folder_ / "stopped", load_fake_case, make_fake_method, {})->run(continuing);
  EXPECT_EQ(contents(folder_ / "whole" / "probes.csv"), contents(folder_ / "stopped" / "probes.csv"));
}

// A window that begins within a step takes the part of its impulse that lies in the window.
TEST(ProbeAverages, AWindowMayBeginWithinAStep) {
  test::TemporaryFolder folder;
  test::write_contents(folder / "case.toml", "end = 1\nprobes = true\naverage = 0.025\n");
  const LoadedCase loaded = load_fake_case((folder / "case.toml").string(), {});
  const auto method = make_fake_method(loaded);
  Ledger ledger;
  ProbeAverages averages(loaded.options.probes, loaded.probe_scalars);
  EXPECT_EQ(averages.pressure(0, 7), 7);
  for (int k = 0; k < 4; ++k) {
    method->step(0.01, ledger);
    averages.add_step(*method, 0.01);
  }
  // Steps end at 0.01 to 0.04 with pressures 0.51 to 0.54; the window is 0.015 to 0.04.
  EXPECT_NEAR(averages.pressure(0, 0), (0.5 * 0.52 + 0.53 + 0.54) * 0.01 / 0.025, 1e-12);
  EXPECT_EQ(averages.pressure(1, 7), 7);  // an elevation has no pressure
}

}  // namespace
}  // namespace spume
