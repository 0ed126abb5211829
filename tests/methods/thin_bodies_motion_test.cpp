// SPDX-License-Identifier: MIT
// Bodies one and two spacings thick that move in the liquid of each method.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "methods/gfd_run.hpp"
#include "methods/les_sph_simulation.hpp"
#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

// A plate in the middle of a tank full of two liquids, that comes and goes; the liquid passes above and below it.
std::string swinging_plate(const std::string& method) {
  return "method = \"" + method + R"toml("
[time]
end = 2
[domain]
lower = [0, 0]
upper = [1.6, 1.2]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.05
[fluid]
gravity = 1
[[phase]]
name = "light"
density = 500
viscosity = 5
[[phase]]
name = "heavy"
density = 1000
viscosity = 10
[interface]
surface_tension = 0
[[region]]
phase = "light"
[[region]]
phase = "heavy"
upper = [1.6, 0.6]
[[body]]
shape = "box"
size = [0.05, 0.7]
position = [0.825, 0.6]
displacement = ["0.1*(1-cos(3*t))", "0"]
)toml";
}
constexpr double plate_top = 0.95, plate_bottom = 0.25;

double middle_at(double t) {
  return 0.825 + 0.1 * (1 - std::cos(3 * t));
}

// No particle goes through the plate, and those beside it, away from its ends, move with it: the liquid that it drives
// round its ends passes there faster, by a tenth of its velocity in the first row.
template <class Run>
void expect_held(Run& run, double end, double longest_step) {
  const auto places = [&] {
    const auto& particles = run.method.flow().particles;
    std::vector<Vec3> all(particles.size());
    for (std::size_t i = 0; i < particles.size(); ++i)
      all[static_cast<std::size_t>((*particles.identifier)[i])] = vector_at(particles.position, 2, i);
    return all;
  };
  std::vector<Vec3> before = places();
  while (run.method.time() < end - 1e-12) {
    const double then = run.method.time();
    run.steps(1, std::min({run.method.step_limit().dt, longest_step, end - then}));
    const std::vector<Vec3> now = places();
    ASSERT_EQ(now.size(), before.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (std::max(before[i][1], now[i][1]) > plate_top - 0.05 ||
          std::min(before[i][1], now[i][1]) < plate_bottom + 0.05)
        continue;
      ASSERT_EQ(before[i][0] < middle_at(then), now[i][0] < middle_at(run.method.time())) << "at t = " << then;
    }
    before = now;
  }
  const auto& particles = run.method.flow().particles;
  const double velocity = 0.3 * std::sin(3 * end);
  std::size_t beside = 0;
  double sum = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec3 r = vector_at(particles.position, 2, i);
    if (std::abs(r[0] - middle_at(end)) > 0.075 || std::abs(r[1] - 0.6) > 0.2) continue;
    ++beside;
    sum += (*particles.velocity[0])[i];
    EXPECT_NEAR((*particles.velocity[0])[i], velocity, 0.4 * velocity) << r[0] << " " << r[1];
  }
  EXPECT_GT(beside, 10U);
  EXPECT_NEAR(sum / static_cast<double>(beside), velocity, 0.1 * velocity);
}

}  // namespace

TEST(ThinBodiesMotion, APlateDrivesTheLiquidsOfGfdAndNoneGoesThroughIt) {
  GfdRun run(swinging_plate("gfd"));
  ASSERT_NE(run.flow().boundary.bodies()->thin(), nullptr);
  expect_held(run, 0.5, 0.01);
}

TEST(ThinBodiesMotion, APlateDrivesTheLiquidsOfWcsphAndNoneGoesThroughIt) {
  WcsphRun run(replaced(swinging_plate("wcsph"), "[interface]\nsurface_tension = 0\n", ""));
  ASSERT_NE(run.method.flow().boundary.bodies()->thin(), nullptr);
  expect_held(run, 0.5, 0.01);
}

// A raft two spacings thick, half as heavy as water: it lies level where it displaces its weight.
TEST(ThinBodiesMotion, ARaftFloatsLevel) {
  Simulation run(
      replaced(replaced(plank_on_water(500), "size = [0.8, 0.3]", "size = [0.8, 0.1]"), "rotation = [10]\n", ""));
  ASSERT_NE(run.method.flow().boundary.bodies()->thin(), nullptr);
  double force = 0, height = 0, turn = 0;
  constexpr int samples = 50;
  const double from = 0.5, to = 1;
  for (int k = 0; k <= samples; ++k) {
    const double end = from + (to - from) * k / samples;
    while (run.method.time() < end) run.steps(1, std::min(run.method.step_limit().dt, end - run.method.time()));
    if (k == 0) continue;
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    force += (rows[3] + rows[5]) / samples;
    height += rows[9] / samples;
    turn = std::max(turn, std::abs(rows[10]));
  }
  EXPECT_NEAR(force, 500 * 0.08 * 10, 0.05 * 400);
  EXPECT_NEAR(height, 0, 0.25 * 0.05);
  EXPECT_LT(turn, 1.0);
}

// Rows before the first step too tell the speed that a body sets out at.
TEST(ThinBodiesMotion, TheFirstRowHasTheSpeedThatABodySetsOutAt) {
  const auto speed = [](auto run) {
    const std::vector<RecordTable> tables = run.method.tables();
    const auto& columns = tables.at(0).columns;
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (columns[c].name == "velocity_x") return rows.at(c);
    return std::nan("");
  };
  const auto setting_out = [](const std::string& method) {
    return replaced(swinging_plate(method), "0.1*(1-cos(3*t))", "0.2*t");
  };
  EXPECT_NEAR(speed(GfdRun(setting_out("gfd"))), 0.2, 1e-6);
  EXPECT_NEAR(speed(WcsphRun(setting_out("wcsph"))), 0.2, 1e-6);
}

}  // namespace spume::test
