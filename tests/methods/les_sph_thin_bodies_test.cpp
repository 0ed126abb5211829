// SPDX-License-Identifier: MIT
// les-sph on both sides of bodies one spacing thick.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

// The tank: 1.6 m long, of sound speed 20.
const Overrides long_tank{"domain.upper=[1.6, 1.3]", "fluid.mach=0.05", "time.max_step=1", "fluid.reynolds=1e4"};
const std::string empty_tank = replaced(tank, "[[liquid]]\nwhere = \"1 - y\"\nconform = true\n", "");
const std::string two_levels =
    "[[liquid]]\nlower = [0, 0]\nupper = [0.8, 1]\n[[liquid]]\nlower = [0.85, 0]\nupper = [1.6, 0.5]\n";
const std::string divider =
    "[[body]]\nshape = \"box\"\nsize = [0.05, 4]\nposition = [0.825, 0.5]\nwall = \"no-slip\"\n";

void run_until(Simulation& run, double end) {
  while (run.method.time() < end) run.steps(1, std::min(run.method.step_limit().dt, end - run.method.time()));
}

std::vector<double> on_bodies(Simulation& run) {
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  return rows;
}

}  // namespace

// 1 m of water on the left, 0.5 m on the right. The divider bears (1 - 1/4) / 2. It moves at 6e-5 to 2e-4; without what
// it hides the left water reaches 5 and the energy guard stops it at t = 0.9.
TEST(LesSphThinBodies, TwoLevelsStayStill) {
  Simulation run(empty_tank + two_levels + divider, long_tank);
  run_until(run, 20);
  EXPECT_LT(run.series()["max_speed"], 1e-3);
  const std::vector<double> force = on_bodies(run);
  EXPECT_NEAR(force[2], 0.375, 0.01 * 0.375);
  std::size_t left = 0;
  for (const Vec3& place : run.state().position) left += place[0] < 0.825 ? 1 : 0;
  EXPECT_EQ(left, 320U);
}

TEST(LesSphThinBodies, TwoLevelsStayStillIn3D) {
  Simulation run(replaced(replaced(empty_tank, "lower = [0, 0]", "lower = [0, 0, 0]"), "upper = [1, 1.5]",
                          "upper = [1.6, 0.7, 1.3]\nfront = \"free-slip\"\nback = \"free-slip\"") +
                     "[[liquid]]\nlower = [0, 0, 0]\nupper = [0.8, 0.7, 1]\n[[liquid]]\nlower = [0.9, 0, 0]\nupper = "
                     "[1.6, 0.7, 0.5]\n[[body]]\nshape = \"box\"\nsize = [0.1, 4, 4]\nposition = [0.85, 0.2, 0.5]\n",
                 {"fluid.mach=0.05", "time.max_step=1", "resolution.spacing=0.1"});
  run_until(run, 3);
  EXPECT_LT(run.series()["max_speed"], 1e-3);
  EXPECT_NEAR(on_bodies(run)[2], 0.7 * 0.375, 0.02 * 0.7 * 0.375);
}

// A plate at 30 degrees under water, all edges in the liquid: Archimedes.
TEST(LesSphThinBodies, APlateUnderWaterBearsItsBuoyancy) {
  Simulation run(empty_tank +
                     "[[liquid]]\nupper = [1.6, 1]\n[[body]]\nshape = \"box\"\nsize = [0.6, 0.05]\nposition = [0.81, "
                     "0.42]\nrotation = [30]\nwall = \"no-slip\"\n",
                 long_tank);
  run_until(run, 5);
  EXPECT_LT(run.series()["max_speed"], 1e-4);
  const std::vector<double> force = on_bodies(run);
  EXPECT_NEAR(force[2], 0, 0.005 * 0.03);
  EXPECT_NEAR(force[3], 0.03, 0.005 * 0.03);
}

// Steady Couette flow below a plate of which each face slides along itself, the other way above, where a layer moves
// with it: u = 2 y is exact, and what is above is as if there were nothing below.
TEST(LesSphThinBodies, FlowsOnTheirSidesDoNotFeelEachOther) {
  const std::string text = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [0.5, 1.5]
x = "periodic"
bottom = "no-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 10
froude = 0.3
mach = 0.1
[[liquid]]
upper = [0.5, 0.5]
velocity = ["2*y", "0"]
[[liquid]]
lower = [0, 0.55]
upper = [0.5, 1.05]
velocity = ["-1", "0"]
[[body]]
shape = "box"
size = [10, 0.05]
position = [0.25, 0.525]
wall = "no-slip"
velocity = ["(y<0.525) - (y>0.525)", "0"]
[time]
end = 1
)toml";
  Simulation run(text);
  run_until(run, 0.5);
  const State state = run.state();
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const double y = state.position[i][1];
    EXPECT_NEAR(state.velocity[i][0], y < 0.525 ? 2 * y : -1.0, y < 0.525 ? 3e-3 : 1e-4) << "at " << y;
  }
}

// Through a gap below it the water levels; no particle is lost, and none is in the plate.
TEST(LesSphThinBodies, LiquidPassesBelowAPlateAlone) {
  Simulation run(replaced(empty_tank + two_levels + divider, "position = [0.825, 0.5]", "position = [0.825, 2.3]"),
                 {long_tank[0], long_tank[1], long_tank[2], long_tank[3], "liquid.1.lower=[0.8, 0]"});
  const std::size_t particles = run.state().position.size();
  std::vector<double> before;
  for (const Vec3& place : run.state().position) before.push_back(place[0]);
  // Who changed sides was below the edge then, up to what it moves in a step.
  double highest = 0;
  while (run.method.time() < 2) {
    run.steps(1, run.method.step_limit().dt);
    const State state = run.state();
    ASSERT_EQ(state.position.size(), particles);
    for (std::size_t i = 0; i < particles; ++i) {
      if ((state.position[i][0] < 0.825) != (before[i] < 0.825)) highest = std::max(highest, state.position[i][1]);
      before[i] = state.position[i][0];
      EXPECT_GT(run.loaded.scene.walls.distance(state.position[i]), 0);
    }
  }
  EXPECT_GT(highest, 0);
  EXPECT_LT(highest, 0.3 + 0.025);
}

// A flap that swings fast in still water, its edges in the liquid.
TEST(LesSphThinBodies, APlateThatMovesKeepsItsSides) {
  Simulation run(empty_tank +
                     "[[liquid]]\nupper = [1.6, 0.8]\n[[body]]\nshape = \"box\"\nsize = [0.05, 4]\nposition = "
                     "[0.825, 2]\ndisplacement = [\"0.1*(1-cos(3*t))\", \"0\"]\n",
                 {long_tank[0], long_tank[1], long_tank[2], long_tank[3]});
  std::size_t left = 0;
  for (const Vec3& place : run.state().position) left += place[0] < 0.825 ? 1 : 0;
  while (run.method.time() < 1.5) {
    run.steps(1, run.method.step_limit().dt);
    const double middle = 0.825 + 0.1 * (1 - std::cos(3 * run.method.time()));
    std::size_t now = 0;
    for (const Vec3& place : run.state().position) now += place[0] < middle ? 1 : 0;
    ASSERT_EQ(now, left) << "at t = " << run.method.time();
  }
}

TEST(LesSphThinBodies, GiveTheSameBitsForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  State first;
  for (const int count : {1, 2, 3}) {
    omp_set_num_threads(count);
    Simulation run(empty_tank + two_levels + divider, long_tank);
    run.steps(4, 0.002);
    if (count == 1)
      first = run.state();
    else
      EXPECT_TRUE(run.state() == first) << count << " threads";
  }
  omp_set_num_threads(threads);
}

TEST(LesSphThinBodies, GoOnBitForBitFromASavedState) {
  const std::string text =
      replaced(empty_tank + two_levels + divider, "wall = \"no-slip\"", "displacement = [\"0.1*sin(5*t)\", \"0\"]");
  Simulation straight(text, long_tank), restored(text, long_tank);
  straight.steps(3, 0.002);
  MemoryState saved;
  straight.method.save(saved);
  straight.steps(2, 0.002);
  restored.method.load(saved);
  restored.steps(2, 0.002);
  EXPECT_TRUE(restored.state() == straight.state());
}

// Where a plate stood at the last state tells whom it meets in the next step: here it has come four spacings far, and
// liquid lies where it was.
TEST(LesSphThinBodies, GoOnBitForBitOnceAPlateHasMovedFar) {
  const std::string text = empty_tank +
                           "[[liquid]]\nupper = [1.6, 0.8]\n[[body]]\nshape = \"box\"\nsize = [0.05, 4]\nposition = "
                           "[0.825, 2]\ndisplacement = [\"0.1*(1-cos(3*t))\", \"0\"]\n";
  Simulation straight(text, long_tank), restored(text, long_tank);
  while (straight.method.time() < 1) straight.steps(1, straight.method.step_limit().dt);
  MemoryState saved;
  straight.method.save(saved);
  const double dt = straight.method.step_limit().dt;
  straight.steps(3, dt);
  restored.method.load(saved);
  restored.steps(3, dt);
  EXPECT_TRUE(restored.state() == straight.state());
}

}  // namespace spume::test
