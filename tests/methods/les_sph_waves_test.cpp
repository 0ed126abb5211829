// SPDX-License-Identifier: MIT
// Sponges and wavemakers in a run: the damping of one step, its work, and the energy of the run.
#include "les_sph_simulation.hpp"
#include "spume/particles/sponge.hpp"

namespace spume {
namespace {

using les_sph::Flow;
using test::Simulation;
using test::StagedFlow;
using test::tank;

const std::string sponge = "[[sponge]]\nside = \"right\"\nlength = 0.5\nstrength = 8\nvelocity = [0.1, 0]\n";
// Still water that is thrown against a wall.
const std::string thrown = test::replaced(tank, "conform = true\n", "conform = true\nvelocity = [\"0.3\", \"0\"]\n");

TEST(Sponge, VelocityFallsAtTheRateOfThePlace) {
  StagedFlow run(thrown + sponge);
  Flow& flow = run.flow;
  const double dt = 0.005;
  run.run_before("sponges", dt);
  std::vector<Vec3> before(flow.size());
  for (std::size_t i = 0; i < flow.size(); ++i)
    for (int a = 0; a < 2; ++a) before[i][a] = flow.intermediate_velocity[a][i];
  flow.damp_velocity(dt);
  double gain = 0;
  int damped = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double x = (*flow.intermediate_position[0])[i], share = std::max(0.0, (x - 0.5) / 0.5);
    const double left = std::exp(-8 * share * share * dt);
    damped += share > 0;
    for (int a = 0; a < 2; ++a) {
      const double target = a == 0 ? 0.1 : 0, u = flow.intermediate_velocity[a][i];
      if (share == 0)
        EXPECT_EQ(u, before[i][a]);
      else
        EXPECT_NEAR(u, target + left * (before[i][a] - target), 1e-14);
      gain += (u * u - before[i][a] * before[i][a]) / 2;
    }
  }
  EXPECT_GT(damped, 100);
  EXPECT_LT(gain, 0);
  EXPECT_NEAR(flow.work_of_sponges, flow.particle_mass() * gain, 1e-12 * std::abs(flow.work_of_sponges));
}

TEST(Sponge, StrongDampingStopsTheLiquidAndOverlappingSpongesAct) {
  const Domain domain = test::load_text(tank).scene.domain;
  InitialParticles one;
  for (int a = 0; a < 2; ++a) {
    one.position[a].resize(1);
    one.velocity[a].resize(1);
  }
  one.region.resize(1);
  one.position[0][0] = 1.01;  // beyond the side, as behind a wall that moves outwards
  one.position[1][0] = 0.25;
  one.volume = 1;
  const ParticleStore store(2, one);
  VectorScratch velocity;
  for (int a = 0; a < 2; ++a) velocity[a].resize(1);
  velocity[0][0] = 2;
  EXPECT_DOUBLE_EQ(damp_in_sponges(domain, {{0, 1, 0.5, 1e6, {}}}, store.position, 1, 1, velocity), -2);
  EXPECT_EQ(velocity[0][0], 0);
  velocity[0][0] = 2;
  damp_in_sponges(domain, {{0, 1, 0.5, 3, {}}, {1, 0, 0.5, 2, {}}}, store.position, 1, 0.1, velocity);
  EXPECT_NEAR(velocity[0][0], 2 * std::exp(-0.1 * (3 + 2 * 0.25)), 1e-15);
}

TEST(Sponge, SceneWithoutOneHasNoStageAndNoColumn) {
  Simulation without(tank), with(tank + sponge);
  const auto on = [](const Simulation& run) {
    for (const Stage& stage : run.method.plan())
      if (stage.name == "sponges") return stage.on;
    throw std::logic_error("no stage");
  };
  EXPECT_FALSE(on(without));
  EXPECT_TRUE(on(with));
  EXPECT_EQ(without.series().count("work"), 0U);
  EXPECT_EQ(with.series().count("work"), 1U);
}

// A vortex in a box of ideal liquid under a sponge: the energy that it loses is the work of the sponge, but for what
// the scheme errs by, 1 % without the sponge.
TEST(Sponge, TheEnergyThatIsLostIsItsWork) {
  const std::string vortex = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.05
[fluid]
mach = 0
[[liquid]]
velocity = ["sin(pi*x)*cos(pi*y)", "-cos(pi*x)*sin(pi*y)"]
[time]
end = 1
[[sponge]]
side = "right"
length = 1
strength = 4
)toml";
  Simulation run(vortex);
  const auto first = run.series();
  run.steps(60, 0.01);
  const auto last = run.series();
  const double lost = first.at("kinetic_energy") - last.at("kinetic_energy");
  EXPECT_GT(lost, 0.5 * first.at("kinetic_energy"));
  EXPECT_NEAR(-last.at("work"), lost, 0.02 * first.at("kinetic_energy"));
}

TEST(Wavemaker, TheWallMovesByTheTheoryAndHoldsTheLiquid) {
  const std::string maker =
      "[[wavemaker]]\nside = \"left\"\nwaves = \"regular\"\nheight = 0.1\nperiod = 2\nramp = 0.5\n";
  Simulation run(tank + maker);
  run.steps(150, 0.005);
  const auto& velocity = *run.loaded.scene.domain.sides[0][0].velocity;
  double place = 0;  // by the midpoint rule in steps a hundred times as short
  for (int i = 0; i < 15000; ++i) place += velocity({}, (i + 0.5) * 5e-5)[0] * 5e-5;
  EXPECT_NEAR(run.method.flow().boundary.walls[0][0], place, 1e-9);
  EXPECT_GT(std::abs(place), 0.005);
  for (const Vec3& r : run.state().position) EXPECT_GT(r[0], place);
}

// The wall gives way to what rises at it; the way that it has gone is that of its correction.
const std::string absorber = "[[wavemaker]]\nside = \"right\"\nwaves = \"none\"\nabsorption = \"long-wave\"\n";

TEST(Absorption, AWallGivesWayToTheLiquidThatRisesAtIt) {
  Simulation held(thrown), run(thrown + absorber);
  held.steps(30, 0.005);
  run.steps(30, 0.005);
  const Boundary& boundary = run.method.flow().boundary;
  EXPECT_GT(boundary.absorbing()->excess(1), 0.02);
  EXPECT_GT(boundary.walls[0][1], 1.001);
  EXPECT_NEAR(boundary.walls[0][1], 1 - boundary.absorbing()->displacement(1), 1e-12);
  EXPECT_EQ(boundary.walls[0][0], 0);
  EXPECT_LT(run.method.elevation({0.95, 0, 0}), held.method.elevation({0.95, 0, 0}));
  // A place beyond the side that was: the wall has let liquid there.
  double farthest = 0;
  for (const Vec3& r : run.state().position) farthest = std::max(farthest, r[0]);
  EXPECT_GT(farthest, 0.98);
  EXPECT_LT(farthest, boundary.walls[0][1]);
}

void expect_the_same_run(const std::string& scene) {
  Simulation straight(scene), before(scene), after(scene);
  straight.steps(12, 0.005);
  test::MemoryState saved;
  straight.method.save(saved);
  straight.steps(12, 0.005);
  after.method.load(saved);
  after.steps(12, 0.005);
  EXPECT_TRUE(after.state() == straight.state());
  EXPECT_EQ(after.saved_state(), straight.saved_state());
  const test::OneThread one;
  before.steps(24, 0.005);
  EXPECT_EQ(before.saved_state(), straight.saved_state());
}

TEST(Absorption, RunsAreTheSameToTheBitAfterACheckpointAndOnAnyThreads) {
  expect_the_same_run(thrown + absorber);
  // Beside a box images follow the faces of solids and walls, where the absorbing one stands.
  expect_the_same_run(thrown + absorber + "[[solid]]\nlower = [0.7, 0]\nupper = [0.8, 0.1]\n");
}

TEST(Absorption, ARefusedStepLeavesTheStateAsItWas) {
  EXPECT_EQ(test::changed_by_a_refused_step(thrown + absorber, {}, 0.005), "");
}

TEST(Absorption, OnlyASceneThatAbsorbsHasItsStage) {
  const auto on = [](const std::string& text) {
    Simulation run(text);
    for (const Stage& stage : run.method.plan())
      if (stage.name == "absorption") return stage.on;
    throw std::logic_error("no stage");
  };
  EXPECT_FALSE(on(tank));
  EXPECT_TRUE(on(tank + absorber));
}

}  // namespace
}  // namespace spume
