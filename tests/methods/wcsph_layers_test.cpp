// SPDX-License-Identifier: MIT
// Layers at rest by wcsph: the start that keeps them there, and where it is taken.
#include <gtest/gtest.h>
#include <omp.h>

#include "methods/wcsph_run.hpp"
#include "spume/particles/column_pressure.hpp"

namespace spume::test {
namespace {

// Of 0.5 x 1, the water 0.5 deep, 8 rows of it, without viscosity.
const std::string layers = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [0.5, 1]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.0625
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1000
viscosity = 0
[[phase]]
name = "air"
density = 1
viscosity = 0
[[region]]
phase = "air"
[[region]]
phase = "water"
upper = [0.5, 0.5]
[time]
end = 5
)toml";

const std::string box_below = R"toml(
[[body]]
shape = "box"
size = [0.19, 0.2]
position = [0.25, 0.1]
)toml";

// The largest speed over sqrt(g H) until t = 3 sqrt(H / g), by when layers on a lattice have broken up: 0.48 in a tank
// of twice the size.
double largest_speed(const std::string& text, const Overrides& set = {}) {
  WcsphRun run(text, set);
  const double depth = 0.5, g = 1;
  double largest = 0;
  while (run.method.time() < 3 * std::sqrt(depth / g)) {
    run.steps(1, run.method.step_limit().dt);
    largest = std::max(largest, run.method.flow().largest_speed);
  }
  return largest / std::sqrt(g * depth);
}

// An acceleration of 0.005 g starts a speed of 0.005 g / w in a particle that swings with w = sqrt(0.015 g / spacing),
// the softest of a row under the pressure of half a spacing: 0.0144 sqrt(g H) here.
TEST(WcsphLayers, TheyStayAtRestWithoutViscosity) {
  EXPECT_LT(largest_speed(layers), 0.0145);
  EXPECT_LT(largest_speed(layers, {"resolution.spacing=0.055"}), 0.0145);
  EXPECT_LT(largest_speed(layers, {"region.1.upper=[0.5, 0.88]"}), 0.0145);
}

// Settled liquid is accelerated by less than 0.0003 g; the step has its neighbours in another order. Terms of 2 P |grad
// W| V sum to 2.1e4 at P = 500, over a density of 1 in air: 1.25e-3 a unit of the rounding of floats, three for places,
// kernels and sums.
TEST(WcsphLayers, TheStartLeavesNoAcceleration) {
  WcsphRun run(layers + box_below);
  run.steps(1, run.method.step_limit().dt);
  const wcsph::Flow& flow = run.method.flow();
  for (std::size_t i = 0; i < flow.size(); ++i)
    EXPECT_LT(std::hypot((*flow.acceleration[0])[i], (*flow.acceleration[1])[i]), 0.0003 + 3 * 1.25e-3);
  EXPECT_TRUE(run.method.take_remarks().empty());
}

TEST(WcsphLayers, ParticlesStayInTheirLayer) {
  WcsphRun run(layers);
  run.steps(1, 1e-9);
  const wcsph::Flow& flow = run.method.flow();
  for (std::size_t i = 0; i < flow.size(); ++i)
    EXPECT_EQ(flow.phase_of(i) == 0, (*flow.particles.position[1])[i] < 0.5) << i;
}

TEST(WcsphLayers, ARestoredRunAndAnyNumberOfThreadsGiveTheSameBits) {
  const int before = omp_get_max_threads();
  std::vector<std::map<std::string, std::vector<double>>> states;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    WcsphRun run(layers + box_below);
    run.steps(4, 1e-4);
    MemoryState saved;
    run.method.save(saved);
    WcsphRun restored(layers + box_below);
    restored.method.load(saved);
    run.steps(4, 1e-4);
    restored.steps(4, 1e-4);
    EXPECT_EQ(restored.saved_state(), run.saved_state());
    states.push_back(run.saved_state());
  }
  omp_set_num_threads(before);
  EXPECT_EQ(states[0], states[1]);
  EXPECT_EQ(states[0], states[2]);
}

TEST(WcsphLayers, TheirSumsAreWeightedAndThoseOfOthersWhereAsked) {
  const auto weighted = [](const std::string& text, const Overrides& set) {
    return WcsphRun(text, set).method.flow().features.weighted;
  };
  EXPECT_TRUE(weighted(layers, {}));
  EXPECT_FALSE(weighted(layers, {"compressibility.interface_pressure=\"mean\""}));
  EXPECT_FALSE(weighted(layers, {"compressibility.shifting=\"on\""}));
  const std::string column = "region.1.upper=[0.3, 0.5]";
  EXPECT_FALSE(weighted(layers, {column}));
  EXPECT_TRUE(weighted(layers, {column, "compressibility.interface_pressure=\"weighted\""}));
}

// Water and air at rest in SI units, the air below an open top; by the mean of the pressures speeds reach 0.17 m/s by
// 0.3 s, 0.12 sqrt(g H). The bound is that of cases/hydrostatic_layers with the viscosity of the phases.
TEST(WcsphLayers, StayAtRestBelowAnOpenTop) {
  const std::string text = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [0.2, 0.3]
bottom = "free-slip"
left = "free-slip"
right = "free-slip"
[resolution]
spacing = 0.01
[fluid]
gravity = 9.81
[[phase]]
name = "water"
density = 1000
viscosity = 1e-3
[[phase]]
name = "air"
density = 1.2
viscosity = 1.8e-5
[[region]]
phase = "air"
[[region]]
phase = "water"
upper = [0.2, 0.2]
[[outflow]]
side = "top"
[time]
end = 0.3
)toml";
  WcsphRun run(text);
  EXPECT_TRUE(run.method.flow().features.weighted);
  EXPECT_FALSE(run.method.flow().features.rest.settles);  // not settled
  until(run, 0.3);
  EXPECT_LT(run.method.flow().largest_speed, 0.01 * std::sqrt(9.81 * 0.3));
}

// Settling carries velocities along to where they do not belong.
TEST(WcsphLayers, ThatMoveDoNotSettle) {
  const WcsphRun still(layers),
      moving(replaced(layers, "phase = \"air\"", "phase = \"air\"\nvelocity = [\"0.1*(y-0.5)\", \"0\"]"));
  EXPECT_TRUE(still.method.flow().features.rest.settles);
  EXPECT_FALSE(moving.method.flow().features.rest.settles);
}

TEST(WcsphLayers, AreRecognised) {
  const auto in_layers = [](const std::string& text, const Overrides& set = {}) {
    return lie_in_layers(WcsphRun(text, set).method.flow().scene);
  };
  EXPECT_TRUE(in_layers(layers));
  EXPECT_TRUE(in_layers(layers + box_below));
  EXPECT_FALSE(in_layers(layers, {"region.1.upper=[0.3, 0.5]"}));                           // a column
  EXPECT_FALSE(in_layers(layers, {"phase.0.density=0.1"}));                                 // heavy above light
  EXPECT_FALSE(in_layers(layers + "\n[[region]]\nphase = \"air\"\nupper = [0.2, 0.2]\n"));  // a bubble
}

}  // namespace
}  // namespace spume::test
