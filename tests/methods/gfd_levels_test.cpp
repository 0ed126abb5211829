// SPDX-License-Identifier: MIT
// Layers of gfd beside a body.
#include <gtest/gtest.h>

#include "methods/gfd_run.hpp"

namespace spume::test {
namespace {

// Oil over water, a ball in the water.
const std::string layers_over_a_ball = R"toml(method = "gfd"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
bottom = "no-slip"
top = "no-slip"
[resolution]
spacing = 0.05
[fluid]
gravity = 9.81
[[phase]]
name = "oil"
density = 800
viscosity = 0.1
[[phase]]
name = "water"
density = 1000
viscosity = 1e-3
[[region]]
phase = "oil"
[[region]]
phase = "water"
where = "0.5 - y"
[[body]]
shape = "ball"
radius = 0.15
position = [0.5, 0.22]
wall = "no-slip"
[time]
end = 1
)toml";

double largest_step_off_rows(const GfdRun& run, double reach) {
  const gfd::Flow& flow = run.flow();
  double largest = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double y = (*flow.particles.position[1])[i], row = y / 0.05 - 0.5;
    if (std::abs(y - 0.5) < reach) largest = std::max(largest, std::abs(row - std::round(row)));
  }
  return largest;
}

}  // namespace

// Particles that see the interface within their support, and their neighbours, are evened out along it; others about
// the ball in all directions. A tenth of a spacing of height is a wave of 0.005 sqrt(g' k) = 0.01 m/s at most.
TEST(GfdLevels, InterfacesBesideABodyKeepTheirHeightAtTheStart) {
  GfdRun run(layers_over_a_ball);
  run.series();
  EXPECT_LT(largest_step_off_rows(run, 2.6 * 0.05), 1e-9);
  EXPECT_GT(largest_step_off_rows(run, 1), 0.05);
  run.until(0.3);
  EXPECT_LT(run.max_speed(), 1e-3);
}

// A drop is no layer.
TEST(GfdLevels, RoundInterfacesAreEvenedOutInAllDirections) {
  GfdRun with(drop_in_a_turning_tank, {"fluid.gravity=1"}), without(drop_in_a_turning_tank);
  with.series();
  without.series();
  const auto a = with.saved_state(), b = without.saved_state();
  EXPECT_EQ(a.at("position_x"), b.at("position_x"));
  EXPECT_EQ(a.at("position_y"), b.at("position_y"));
}

}  // namespace spume::test
