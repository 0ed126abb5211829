// SPDX-License-Identifier: MIT
// Oxygen that bubbles and the surface give to the liquid of les-sph, and sludge that takes it up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "methods/les_sph_simulation.hpp"
#include "reference/gas_exchange.hpp"

namespace spume::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr double rounding = std::numeric_limits<double>::epsilon();

// A litre of slightly compressible water, 10^3 particles, with bubbles of 3 mm. The body force balances gravity.
const std::string cube = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.1, 0.1, 0.1]
x = "periodic"
y = "periodic"
z = "periodic"
[resolution]
spacing = 0.01
[fluid]
density = 1000
viscosity = 1e-3
gravity = 9.81
sound_speed = 20
[forces]
body = ["0", "0", "9.81"]
[[liquid]]
[bubbles]
surface_tension = 0.072
[[bubble_cloud]]
number = 60
bubble_radius = 0.0015
sizes = "log-normal"
deviation = 0.3
[oxygen]
[time]
end = 10
max_step = 0.005
)toml";

// Bubbles rise to the surface of a small tank and burst.
const std::string column = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.08, 0.08, 0.16]
left = "no-slip"
right = "free-slip"
front = "free-slip"
back = "free-slip"
bottom = "no-slip"
[resolution]
spacing = 0.01
[fluid]
density = 1000
viscosity = 1e-3
gravity = 9.81
[turbulence]
model = "mixed-scale"
[[liquid]]
where = "0.1 - z"
conform = true
[bubbles]
surface_tension = 0.072
breakup = true
entrainment = true
fluctuations = true
[[sparger]]
position = [0.04, 0.03, 0.01]
rate = "1e-5"
bubble_radius = 0.002
[[bubble_cloud]]
lower = [0.01, 0.01, 0.01]
upper = [0.07, 0.07, 0.09]
number = 40
bubble_radius = 0.002
[oxygen]
surface_k_l = 1e-4
bubbles_shrink = true
[time]
end = 10
)toml";

const std::string open_pool = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.1, 0.08, 0.1]
left = "free-slip"
right = "free-slip"
front = "free-slip"
back = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.01
[fluid]
density = 1000
viscosity = 1e-3
gravity = 9.81
[[liquid]]
where = "0.06 - z"
conform = true
[oxygen]
surface_k_l = 1e-3
[time]
end = 10
max_step = 0.002
)toml";

const std::string linear_oxygen = "[[scalar]]\nname = \"oxygen\"\ninitial = \"4 + 30*x\"\ndiffusivity = 2e-9\n";

// Float sums over some hundred neighbours, and the inner sums of two bubbles in one place. What bubbles see comes with
// the other sums where fluctuations or breakup leave room among them.
TEST(LesSphOxygen, BubblesGiveWhatTheSlowTwinGives) {
  constexpr double dt = 0.004;
  for (const Overrides& beside : {Overrides{}, Overrides{"bubbles.fluctuations=true"},
                                  Overrides{"bubbles.fluctuations=true", "bubbles.breakup=true"}}) {
    Overrides overrides{"oxygen.bubble_coefficient=\"given\"", "oxygen.bubble_k_l=4e-4",
                        "turbulence.model=\"mixed-scale\""};
    overrides.insert(overrides.end(), beside.begin(), beside.end());
    StagedFlow run(cube + linear_oxygen, overrides);
    run.start_before("bubble events");
    run.flow.started = true;
    run.run_before("viscosity", dt);
    const reference::GasExchange slow = reference::gas_exchange(run.flow, 0.1, dt);
    ASSERT_EQ(run.flow.bubbles->population().size(), 60U);
    EXPECT_GT(slow.given, 0);
    EXPECT_NEAR(run.flow.bubbles->dissolved_amount() / slow.given, 1, 1e-6);
    const double largest = *std::max_element(slow.change.begin(), slow.change.end());
    for (std::size_t i = 0; i < run.flow.size(); ++i)
      EXPECT_NEAR(run.flow.bubbles->dissolution()[i], slow.change[i], 1e-5 * largest);
  }
}

// Each step adds roundings of the amount, the contents of all bubbles and what was released.
TEST(LesSphOxygen, WhatBubblesLoseTheLiquidGains) {
  for (const std::string& text : {cube + linear_oxygen, column}) {
    Simulation run(text);
    const auto before = run.series();
    constexpr int steps = 40;
    run.steps(steps, 0.003);
    auto after = run.series();
    const double tolerance = steps * 64 * rounding;
    EXPECT_GT(std::abs(after["oxygen_from_bubbles"]), 0);
    const double gained = after["amount_of_oxygen"] - before.at("amount_of_oxygen");
    EXPECT_NEAR(gained, after["oxygen_from_bubbles"] + after["oxygen_from_surface"],
                tolerance * (after["amount_of_oxygen"] + after["oxygen_released"]));
    EXPECT_NEAR(after["oxygen_released"],
                after["oxygen_from_bubbles"] + after["oxygen_in_bubbles"] + after["oxygen_left"],
                tolerance * after["oxygen_released"]);
    EXPECT_GT(after["kla"], 0);
  }
}

TEST(LesSphOxygen, BreakupAndBurstingKeepTheGas) {
  Simulation run(column, {"bubbles.surface_tension=0.002"});
  run.steps(150, 0.003);
  auto after = run.series();
  EXPECT_GT(after["bursts"], 0);
  EXPECT_GT(after["oxygen_left"], 0);
  EXPECT_NEAR(after["oxygen_released"],
              after["oxygen_from_bubbles"] + after["oxygen_in_bubbles"] + after["oxygen_left"],
              150 * 64 * rounding * after["oxygen_released"]);
}

// A bubble of constant contents grows as the pressure of its depth falls, and shrinks by what it gives.
TEST(LesSphOxygen, VolumesFollowTheGas) {
  Simulation run(column, {"bubbles.entrainment=false"});
  run.steps(30, 0.003);
  const les_sph::Flow& flow = run.method.flow();
  const bubbles::Population& bubbles = flow.bubbles->population();
  ASSERT_GT(bubbles.size(), 20U);
  for (std::size_t b = 0; b < bubbles.size(); ++b)
    EXPECT_NEAR((*bubbles.volume)[b] / flow.solutes.oxygen->gas().volume((*bubbles.oxygen)[b] + (*bubbles.inert)[b],
                                                                         (*bubbles.position[2])[b]),
                1, 1e-12);
}

// Still water: the area is that of the tank, and the uppermost layer nears saturation with k_L A / V alone.
TEST(LesSphOxygen, AStillSurfaceGivesItsCoefficientTimesItsArea) {
  Simulation run(open_pool, {"oxygen.temperature=10"});
  run.steps(1, 0.002);
  auto after = run.series();
  EXPECT_NEAR(after["surface_area"] / (0.1 * 0.08), 1, 1e-4);  // of moments in float
  const double saturation = oxygen::saturation_concentration(10, 0);
  EXPECT_NEAR(after["oxygen_from_surface"] / (1e-3 * 0.1 * 0.08 * saturation * 0.002), 1, 2e-4);
  EXPECT_NEAR(after["amount_of_oxygen"], after["oxygen_from_surface"], 64 * rounding * after["amount_of_oxygen"]);
  EXPECT_NEAR(after["kla"], 1e-3 / 0.06, 1e-4 * 1e-3 / 0.06);
}

TEST(LesSphOxygen, FlowsAreTheSameBitsWithAndWithoutIt) {
  const std::string without = replaced(column, "[oxygen]\nsurface_k_l = 1e-4\nbubbles_shrink = true\n", "");
  Simulation plain(without), run(column, {"oxygen.bubbles_shrink=false"});
  plain.steps(10, 0.003);
  run.steps(10, 0.003);
  EXPECT_EQ(plain.state().position, run.state().position);
  EXPECT_EQ(plain.state().velocity, run.state().velocity);
}

const std::string sludge = column + R"toml([biokinetics]
interval = 0.005
[[scalar]]
name = "S_O"
initial = "2"
diffusivity = 2e-9
[[scalar]]
name = "S_S"
initial = "20*z/0.1"
source = "x > 0.04 ? 100*t : 0"
[[scalar]]
name = "X_BH"
initial = "2500"
[[scalar]]
name = "S_NH"
initial = "10"
[[scalar]]
name = "S_ALK"
initial = "5"
)toml";

TEST(LesSphOxygen, ARestoredRunAndAnyNumberOfThreadsGiveTheSameBits) {
  for (const std::string& text : {column, sludge}) {
    Simulation straight(text);
    straight.steps(4, 0.003);
    MemoryState saved;
    straight.method.save(saved);
    straight.steps(4, 0.003);
    const OneThread one;
    Simulation restored(text);
    restored.method.load(saved);
    restored.steps(4, 0.003);
    EXPECT_EQ(straight.saved_state(), restored.saved_state());
  }
}

TEST(LesSphOxygen, ARefusedStepLeavesTheState) {
  EXPECT_EQ(changed_by_a_refused_step(sludge, {}, 0.003), "");
}

// Small bubbles of pure oxygen in water without any dissolve whole: they are gone, and what they held is in the water.
TEST(LesSphOxygen, BubblesThatDissolveWholeAreGone) {
  Simulation run(replaced(cube, "[oxygen]",
                          "[oxygen]\nbubbles_shrink = true\ngas_fraction = 1\nbubble_coefficient = "
                          "\"given\"\nbubble_k_l = 4e-3"),
                 {"bubble_cloud.0.bubble_radius=1e-4", "bubble_cloud.0.deviation=0.1"});
  run.steps(4, 0.005);
  EXPECT_GT(run.method.flow().bubbles->population().size(), 0U);
  while (run.method.time() < 2 && !run.method.flow().bubbles->population().empty()) run.steps(1, 0.005);
  auto after = run.series();
  EXPECT_TRUE(run.method.flow().bubbles->population().empty());
  EXPECT_EQ(after["bubbles_dissolved"], 60);
  EXPECT_EQ(after["bursts"], 0);
  EXPECT_NEAR(after["oxygen_from_bubbles"] / after["oxygen_released"], 1, 1e-13);
  EXPECT_NEAR(after["amount_of_oxygen"] / after["oxygen_released"], 1, 1e-12);
}

// A source of a + b t adds its integral: the midpoint rule is exact for it.
TEST(LesSphOxygen, SourcesAddTheirIntegral) {
  Simulation run(cube + "[[scalar]]\nname = \"feed\"\nsource = \"2 + 3*t\"\n[[scalar]]\nname = \"dye\"\n");
  run.steps(10, 0.005);
  auto after = run.series();
  constexpr double t = 0.05, volume = 1e-3;
  EXPECT_NEAR(after["amount_of_feed"], volume * (2 * t + 1.5 * t * t), 1e-12);
  EXPECT_NEAR(after["source_of_feed"], after["amount_of_feed"], 1e-15);
  EXPECT_EQ(after["amount_of_dye"], 0);
}

// It takes no more than is there: a step of 1 g/m^3/s would leave the 0.5 g/m^3 of oxygen below zero at once.
TEST(LesSphOxygen, ASinkTakesNoMoreThanThereIs) {
  Simulation run(
      cube + "[[scalar]]\nname = \"oxygen\"\ninitial = \"5e-3 + 0.01*x\"\ndiffusivity = 2e-9\nsource = \"0-1\"\n",
      {"oxygen.bubble_coefficient=\"none\""});
  const double first = run.series()["amount_of_oxygen"];
  run.steps(4, 0.005);
  EXPECT_EQ(run.series()["amount_of_oxygen"], 0);
  EXPECT_NEAR(run.series()["source_of_oxygen"] / first, -1, 1e-12);
}

// Without bubbles oxygen rides on the viscous sweep, before the sink: what diffuses out of particles that the sink
// empties would else be missing.
TEST(LesSphOxygen, ASinkTakesNoMoreThanDiffusionLeaves) {
  Simulation run(open_pool +
                 "[[scalar]]\nname = \"oxygen\"\ninitial = \"x < 0.05 ? 5e-3 : 0\"\n"
                 "diffusivity = 1e-3\nsource = \"x > 0.045 ? -1 : 0\"\n");
  for (int k = 0; k < 10; ++k) {
    run.steps(1, 0.002);
    const Array<double>& oxygen = run.method.flow().solutes.scalars->values(0);
    EXPECT_GE(*std::min_element(oxygen.begin(), oxygen.end()), 0);
  }
  EXPECT_LT(run.series()["source_of_oxygen"], 0);
}

// Uniform sludge in still water is one tank: the same as the reactions alone.
TEST(LesSphOxygen, SludgeInStillWaterReactsAsInOneTank) {
  const std::string text =
      replaced(open_pool, "surface_k_l = 1e-3", "") +
      "[biokinetics]\ninterval = 0.01\ntolerance = 1e-9\n"
      "[[scalar]]\nname = \"S_O\"\ninitial = \"6\"\n[[scalar]]\nname = \"S_S\"\ninitial = \"20\"\n"
      "[[scalar]]\nname = \"X_BH\"\ninitial = \"2500\"\n[[scalar]]\nname = \"S_NH\"\ninitial = \"9\"\n"
      "[[scalar]]\nname = \"S_ALK\"\ninitial = \"5\"\n";
  Simulation run(text);
  run.steps(50, 0.002);
  const les_sph::Flow& flow = run.method.flow();
  const BiokineticsOptions& options = run.loaded.options.get<BiokineticsOptions>();
  std::vector<double> tank(biokinetics::asm1::components, 0.0);
  std::vector<double*> one;
  for (double& c : tank) one.push_back(&c);
  tank[biokinetics::asm1::s_o] = 6;
  tank[biokinetics::asm1::s_s] = 20;
  tank[biokinetics::asm1::x_bh] = 2500;
  tank[biokinetics::asm1::s_nh] = 9;
  tank[biokinetics::asm1::s_alk] = 5;
  const biokinetics::Integrator integrator(biokinetics::asm1_model(options.parameters), 1e-9);
  for (int k = 0; k < 10; ++k) integrator.advance(one, 0, 1, 0.01 / 86400);
  for (std::size_t i = 0; i < tank.size(); ++i)
    EXPECT_NEAR(flow.solutes.scalars->values(options.scalars[i])[7], tank[i], 1e-12 * std::max(tank[i], 1.0)) << i;
  auto after = run.series();
  const double volume = flow.solutes.scalars->liquid_volume();
  EXPECT_NEAR(after["oxygen_uptake"], volume * (6 - tank[biokinetics::asm1::s_o]), 1e-11 * volume);
  EXPECT_GT(after["oxygen_uptake_rate"], 10);
  EXPECT_LT(after["oxygen_uptake_rate"], 300);
}

TEST(LesSphOxygen, BadInputIsRefusedWithItsPlaceAndAFix) {
  const auto refused = [](const std::string& text, const std::string& message) {
    EXPECT_THAT(problems_of(text), Contains(HasSubstr(message))) << message;
  };
  refused(replaced(cube, "[oxygen]", "[oxygen]\ngas_fraction = 1.1"), "gas_fraction");
  refused(replaced(cube, "[oxygen]", "[oxygen]\nbubble_coefficient = \"given\""),
          "needs a value; add  oxygen.bubble_k_l");
  refused(replaced(cube, "[oxygen]", "[oxygen]\nbubble_coefficient = \"film\""), "higbie");
  refused(replaced(cube, "[oxygen]", "[oxygen]\ntemperature = 293"), "temperature");
  refused(cube + "[[scalar]]\nname = \"oxygen\"\n", "has no diffusivity");
  refused(cube + "[[scalar]]\nname = \"oxygen\"\ninitial = \"x - 0.05\"\ndiffusivity = 2e-9\n", "finite number >= 0");
  refused(cube + "[[scalar]]\nname = \"dye\"\nsource = \"2*w\"\n", "w");
  refused(replaced(taylor_green_3d, "[[liquid]]", "[oxygen]\n[[liquid]]"), "holds values in SI units");
  refused(replaced(cube, "[oxygen]\n", "[biokinetics]\n"), "the case has no [oxygen]");
  refused(cube + "[biokinetics]\n[[scalar]]\nname = \"S_NX\"\n", "is no component of biokinetics.model");
  refused(cube + "[biokinetics]\ny_h = 1.5\n", "a yield lies between 0 and 1");
  refused(cube + "[biokinetics]\nmu_h = -1\n", "mu_h");
  refused(cube + "[biokinetics]\n[[scalar]]\nname = \"S_NH\"\ninitial = \"5\"\n", "without S_ALK nothing grows");
  refused(replaced(cube, "[oxygen]", "[oxygen]\nscalar = \"dye\"") + "[biokinetics]\n", "remove the key");
}

}  // namespace
}  // namespace spume::test
