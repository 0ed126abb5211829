// SPDX-License-Identifier: MIT
// les-sph with bodies that move.
#include <gmock/gmock.h>

#include <numbers>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

// A closed tank of liquid, itself a body that moves in a domain without walls.
const std::string moving_tank = R"toml(method = "les-sph"
[time]
end = 1
[domain]
lower = [-1.6, -1.1]
upper = [1.6, 1.1]
[resolution]
spacing = 0.05
[fluid]
reynolds = 1e4
[[liquid]]
lower = [-0.5, -0.4]
upper = [0.5, 0.4]
[[body]]
shape = "box"
size = [1, 0.8]
inside = false
)toml";

// The particles' largest deviation from the velocity of the tank that they are in, per component.
double deviation(const Simulation& run, const std::function<Vec3(const Vec3&)>& tank) {
  const les_sph::Flow& flow = run.method.flow();
  double most = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const Vec3 u = tank(vector_at(flow.particles.position, flow.dimensions, i));
    for (int axis = 0; axis < flow.dimensions; ++axis)
      most = std::max(most, std::abs((*flow.particles.velocity[axis])[i] - u[axis]));
  }
  return most;
}

const std::string shaken = moving_tank + "displacement = [\"0.25*t^2\", \"0\"]\nangle = \"90*t^2\"\n";

}  // namespace

// Of [[solid]] boxes that stand beside bodies too, as they are bodies then.
TEST(LesSphBodyMotion, BoxesThatBecomeBodiesAreWarnedOf) {
  const auto warned = [](const std::string& box) {
    std::vector<std::string> texts;
    for (const Problem& one :
         Simulation(moving_tank + "displacement = [\"t\", \"0\"]\n[[solid]]\n" + box).loaded.options.warnings)
      texts.push_back(one.text);
    return texts;
  };
  EXPECT_THAT(warned("lower = [0, -0.2]\nupper = [0.04, 0.2]\n"),
              testing::Contains(testing::HasSubstr("the body 'solid.0' is thinner than a spacing, 0.05, behind")));
  EXPECT_THAT(warned("lower = [-0.2, -0.2]\nupper = [0.1, 0.2]\n"),
              testing::Not(testing::Contains(testing::HasSubstr("'solid.0'"))));
}

// The pressure of a tank that is pushed evenly is linear across it and moves all of the liquid alike. Fits at the walls
// take single precision.
TEST(LesSphBodyMotion, LiquidMovesWithATankThatIsPushed) {
  Simulation run(moving_tank + "displacement = [\"0.25*t^2\", \"-0.1*t^2\"]\n");
  for (int step = 0; step < 30; ++step) run.steps(1, 0.02);
  const double t = run.method.time();
  EXPECT_NEAR(t, 0.6, 1e-12);
  EXPECT_LT(deviation(run, [t](const Vec3&) { return Vec3{0.5 * t, -0.2 * t, 0}; }), 2e-3 * 0.5 * t);
  const les_sph::Flow& flow = run.method.flow();
  double slope = 0, squares = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double x = (*flow.particles.position[0])[i] - 0.25 * t * t;
    slope += x * (*flow.pressure)[i];
    squares += x * x;
  }
  EXPECT_NEAR(slope / squares, -0.5, 0.005);
}

// Still water seen from beside: sides, a ball, and a box half through the right side go by with one speed. Bodies lost
// their wall points beyond where the sides had stood at the start, and the run ended with 165 sqrt(gH).
TEST(LesSphBodyMotion, BodiesGoOnWithATankWhoseSidesMoveByItsWidth) {
  Simulation run(
      "method = \"les-sph\"\n[time]\nend = 2\n[domain]\nlower = [0, 0]\nupper = [1, 0.8]\nleft = \"free-slip\"\nright "
      "= "
      "\"free-slip\"\nbottom = \"free-slip\"\n[domain.wall_velocity]\nleft = [\"0.5\", \"0\"]\nright = [\"0.5\", "
      "\"0\"]\n"
      "[resolution]\nspacing = 0.04\n[fluid]\ndensity = 1\ngravity = 1\n[[liquid]]\nupper = [1, 0.5]\nvelocity = "
      "[\"0.5\", "
      "\"0\"]\n[[body]]\nshape = \"box\"\nsize = [0.32, 0.2]\nposition = [1, 0.2]\ndisplacement = [\"0.5*t\", \"0\"]\n"
      "[[body]]\nshape = \"ball\"\nradius = 0.12\nposition = [0.4, 0.25]\ndisplacement = [\"0.5*t\", \"0\"]\n");
  while (run.method.time() < 2) run.steps(1, std::min(0.02, run.method.step_limit().dt));
  EXPECT_LT(deviation(run, [](const Vec3&) { return Vec3{0.5, 0, 0}; }), 1e-3);
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  const double of_box = 0.16 * 0.2, of_ball = std::numbers::pi * 0.12 * 0.12;
  EXPECT_NEAR(rows[3], of_box, 0.005 * of_box);
  EXPECT_NEAR(rows[rows.size() / 2 + 3], of_ball, 0.005 * of_ball);
}

TEST(LesSphBodyMotion, LiquidTurnsOnWithATankThatTurns) {
  Simulation run(replaced(moving_tank, "upper = [0.5, 0.4]\n", "upper = [0.5, 0.4]\nvelocity = [\"-y\", \"x\"]\n") +
                 "angle = \"180/pi*t\"\n");
  for (int step = 0; step < 100; ++step) run.steps(1, 0.01);
  EXPECT_LT(deviation(run, [](const Vec3& r) { return Vec3{-r[1], r[0], 0}; }), 0.02);
}

// A quarter turn opens a void behind the tips. Corrections of gradients that did not fade there gave it speeds of 300,
// and the run ended at t = 0.27; the tips move with 0.66.
TEST(LesSphBodyMotion, APaddleStirsAFullTank) {
  Simulation run(
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [0.413, 0.377]\nleft = \"no-slip\"\nright = "
      "\"no-slip\"\nbottom = \"no-slip\"\ntop = \"no-slip\"\n[resolution]\nspacing = 0.0083\n[fluid]\ngravity = "
      "9.81\ndensity = 998\nviscosity = 0.05\n[[liquid]]\n[[body]]\nshape = \"box\"\nsize = [0.21, "
      "0.033]\nposition = [0.2, 0.19]\nangle = \"360*t\"\nwall = \"no-slip\"\n[time]\nend = 1\n");
  double fastest = 0;
  while (run.method.time() < 0.5) {
    run.steps(1, run.method.step_limit().dt);
    fastest = std::max(fastest, run.series().at("max_speed"));
  }
  EXPECT_LT(fastest, 2 * 0.66);
}

// A tank that is shaken does all the work that its liquid has: what lies beside its energy in the verdict is taken off,
// and a run that is continued goes on with it. Wall forces are within 5 %, which the verdict allows for.
TEST(LesSphBodyMotion, TheVerdictOnTheEnergyHasTheWorkOfTheWalls) {
  Simulation straight(shaken), restored(shaken);
  const auto to_next_row = [](Simulation& run) {
    run.steps(1, 0.005);
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
  };
  const auto beside = [](const Simulation& run) {
    const std::vector<Invariant> invariants = run.method.invariants();
    const auto energy = std::find_if(invariants.begin(), invariants.end(),
                                     [](const Invariant& one) { return one.quantity == "energy_growth"; });
    return energy == invariants.end() ? std::nan("") : energy->beside();
  };
  std::vector<double> rows;
  straight.method.table_rows("bodies", rows);
  const double before = straight.series()["total_energy"] + beside(straight);
  for (int step = 0; step < 30; ++step) to_next_row(straight);
  MemoryState saved;
  straight.method.save(saved);
  restored.method.load(saved);
  for (int step = 0; step < 20; ++step) to_next_row(straight), to_next_row(restored);
  const double energy = straight.series()["total_energy"], now = beside(straight);
  EXPECT_GT(energy - before, 0.01);
  EXPECT_LT(energy + now - before, 0.05 * straight.series()["kinetic_energy"]);
  EXPECT_NEAR(energy + now, before, 0.2 * (energy - before));
  EXPECT_EQ(beside(restored), now);
}

TEST(LesSphBodyMotion, GivesTheSameBitsForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  State first;
  for (const int count : {1, 2, 3}) {
    omp_set_num_threads(count);
    Simulation run(shaken);
    run.steps(4, 0.01);
    if (count == 1)
      first = run.state();
    else
      EXPECT_TRUE(run.state() == first) << count << " threads";
  }
  omp_set_num_threads(threads);
}

TEST(LesSphBodyMotion, GoesOnBitForBitFromASavedState) {
  Simulation straight(shaken), restored(shaken);
  straight.steps(3, 0.01);
  MemoryState saved;
  straight.method.save(saved);
  straight.steps(2, 0.01);
  restored.method.load(saved);
  restored.steps(2, 0.01);
  EXPECT_TRUE(restored.state() == straight.state());
}

TEST(LesSphBodyMotion, ARefusedStepLeavesTheState) {
  EXPECT_EQ(changed_by_a_refused_step(shaken, {}, 0.01), "");
}

}  // namespace spume::test
