// SPDX-License-Identifier: MIT
// Bubbles inside the liquid do not burst; where they do, it is told.
#include <gmock/gmock.h>

#include "methods/les_sph_simulation.hpp"
#include "spume/physics/bubbles/coupling.hpp"

namespace spume::test {
namespace {

// A sparger at the floor of a deep tank.
const std::string tank_with_sparger = R"toml(method = "les-sph"
[domain]
lower = [-0.045, -0.045, 0]
upper = [0.045, 0.045, 0.21]
left = "free-slip"
right = "free-slip"
front = "free-slip"
back = "free-slip"
bottom = "no-slip"
[resolution]
spacing = 0.0075
[fluid]
density = 998
viscosity = 1e-3
gravity = 9.81
[turbulence]
model = "smagorinsky"
[[liquid]]
where = "0.165 - z"
[bubbles]
surface_tension = 0.0728
[[sparger]]
shape = "disc"
position = [0, 0, 0.012]
radius = 0.02
rate = "1e-4"
bubble_radius = 0.002
[time]
end = 1
)toml";

// Bubbles in a drop of eight particles, in a cavity of two spacings all around it deep inside the liquid. The support
// is 2.5 spacings: the drop sees nothing of the liquid.
const std::string drop_in_cavity = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.12, 0.12, 0.3]
x = "periodic"
y = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.01
smoothing_ratio = 1.25
[fluid]
density = 1000
viscosity = 1e-3
gravity = 9.81
[[liquid]]
upper = [0.12, 0.12, 0.18]
where = "max(max(abs(x - 0.06), abs(y - 0.06)), abs(z - 0.09)) - 0.02"
[[liquid]]
lower = [0.05, 0.05, 0.08]
upper = [0.07, 0.07, 0.1]
[bubbles]
surface_tension = 0.07
[[bubble_cloud]]
centre = [0.06, 0.06, 0.09]
radius = 0.001
number = 12
bubble_radius = 1e-4
[time]
end = 1
)toml";

const bubbles::BubbleCoupling& coupling_in(const Simulation& run) {
  return *run.method.flow().bubbles;
}

std::string remarks_in(Simulation& run) {
  std::string text;
  for (const Remark& remark : run.method.take_remarks()) text += remark.text;
  return text;
}

// A swarm that rises from the floor, 13 spacings and more below the surface. Particles that take in gas crowd the
// mixture before they have moved apart; the gradient of that at the front of the swarm, taken for the normal of a
// surface, let 70 of 537 bubbles burst.
TEST(BubblesInside, DoNotBurstAtTheFrontOfASwarm) {
  Simulation run(tank_with_sparger);
  run.steps(36, 0.005);
  const auto& history = coupling_in(run).history();
  EXPECT_GT(history.injected, 500);
  EXPECT_EQ(history.bursts, 0);
  EXPECT_EQ(history.inner_bursts, 0);
}

// Bubbles in a drop burst. With liquid before it they are told of, in the air they are not.
TEST(BubblesInside, ThatBurstInsideTheLiquidAreRemarkedOn) {
  Simulation inside(drop_in_cavity), outside(drop_in_cavity, {"liquid.0.upper=[0.12,0.12,0.04]"});
  for (Simulation* run : {&inside, &outside}) {
    run->steps(1, 1e-4);
    ASSERT_EQ(coupling_in(*run).history().bursts, 12);
  }
  EXPECT_EQ(coupling_in(inside).history().inner_bursts, 12);
  EXPECT_EQ(inside.series().at("inner_bursts"), 12);
  EXPECT_THAT(remarks_in(inside), ::testing::HasSubstr("12 of 12 bursts"));
  EXPECT_EQ(coupling_in(outside).history().inner_bursts, 0);
  EXPECT_THAT(remarks_in(outside), ::testing::Not(::testing::HasSubstr("liquid before them")));
  MemoryState saved;
  inside.method.save(saved);
  Simulation restored(drop_in_cavity);
  restored.method.load(saved);
  EXPECT_EQ(coupling_in(restored).history().inner_bursts, 12);
}

}  // namespace
}  // namespace spume::test
