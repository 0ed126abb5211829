// SPDX-License-Identifier: MIT
// les-sph with bodies that float.
#include <gmock/gmock.h>

#include <numbers>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

using std::numbers::pi;

// A disc of radius 0.4 in the middle of a round tank of radius 1, full of water: 16 spacings across.
const std::string disc_in_tank = R"toml(method = "les-sph"
[time]
end = 1
[domain]
lower = [-1.1, -1.1]
upper = [1.1, 1.1]
[resolution]
spacing = 0.05
[fluid]
density = 1000
viscosity = 0
gravity = 10
[[liquid]]
[[body]]
shape = "ball"
radius = 1
inside = false
[[body]]
shape = "ball"
radius = 0.4
)toml";

const std::string plank = plank_on_water(400);

// A tank without a surface, and a body of half the density of the water in it.
const std::string full_tank =
    "method = \"les-sph\"\n[time]\nend = 2\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nleft = \"free-slip\"\nright = "
    "\"free-slip\"\nbottom = \"free-slip\"\ntop = \"free-slip\"\n[resolution]\nspacing = 0.05\n[fluid]\ndensity = "
    "1\ngravity = 1\n[[liquid]]\n";
const std::string light_box =
    "[[body]]\nshape = \"box\"\nsize = [0.3, 0.2]\ndensity = 0.5\nfree = [\"x\", \"y\", \"turn\"]\n";

// Columns of bodies.csv.
struct Row {
  double pressure_y, viscous_y, y, turn, velocity_y, spin;
};
Row row_of(Simulation& run, std::size_t wall) {
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  const double* const r = rows.data() + 14 * wall;
  return {r[3], r[5], r[9], r[10], r[12], r[13]};
}

}  // namespace

// Nothing but a force drives the liquid and what floats in it: no speed says how fast a body may move.
TEST(LesSphFloating, MovesWithoutGravity) {
  std::string text = full_tank + "[forces]\nbody = [\"0.2\", \"0\"]\n" + light_box;
  text.replace(text.find("gravity = 1\n"), 12, "");
  text.insert(text.find("[[body]]\n") + 9, "position = [0.5, 0.5]\n");
  Simulation run(text);
  run.steps(3, 0.01);
  EXPECT_GT(run.method.flow().floating->largest_speed(), 0);
}

// Potential flow: the water that a disc of radius a moves in a tank of radius b weighs (b^2 + a^2) / (b^2 - a^2) times
// what the disc displaces. Rounded by particles of 1/8 of its radius the disc is off by 1 to 2 %. A body a hundred
// times lighter than water moves with the water's inertia alone.
TEST(LesSphFloating, ADiscRisesWithItsAddedMass) {
  const double a = 0.4, area = pi * a * a, added = (1 + a * a) / (1 - a * a), dt = 1e-3;
  for (const double density : {10.0, 500.0, 3000.0}) {
    Simulation run(disc_in_tank + "density = " + std::to_string(density) + "\n");
    run.steps(5, dt);
    const double mass = density * area, exact = (1000 * area - mass) * 10 / (mass + added * 1000 * area);
    EXPECT_NEAR(row_of(run, 1).velocity_y, exact * 5 * dt, 0.03 * std::abs(exact) * 5 * dt) << density;
  }
}

TEST(LesSphFloating, ItsAccelerationIsWhatTheForceGivesItsMass) {
  Simulation run(disc_in_tank + "density = 200\n");
  run.steps(1, 1e-6);  // the places of the start
  const Row row = row_of(run, 1);
  const double mass = 200 * pi * 0.16;
  // The force is that of a step of no length, whose solution has the tolerance of the solver.
  EXPECT_NEAR(row.velocity_y / 1e-6, row.pressure_y / mass - 10, 0.01 * row.pressure_y / mass);
}

TEST(LesSphFloating, ADiscAsHeavyAsWaterStays) {
  Simulation run(disc_in_tank + "density = 1000\n");
  for (int step = 0; step < 50; ++step) run.steps(1, 0.01);
  const Row row = row_of(run, 1);
  // The force on it at rest is within 0.5 % of its weight (cases/hydrostatic_bodies).
  EXPECT_LT(std::abs(row.y), 0.5 * 0.005 * 10 / 2.4 * 0.25);
}

// What a disc gains by rising the water has lost: the verdict on the energy has both.
TEST(LesSphFloating, TheVerdictOnTheEnergyHasThatOfTheBody) {
  Simulation run(disc_in_tank + "density = 500\n");
  run.steps(5, 1e-3);
  const std::vector<Invariant> invariants = run.method.invariants();
  const auto energy = std::find_if(invariants.begin(), invariants.end(),
                                   [](const Invariant& one) { return one.quantity == "energy_growth"; });
  ASSERT_NE(energy, invariants.end());
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  const double *const r = rows.data() + 14, spin = r[13] * pi / 180;
  const double mass = 500 * pi * 0.16, kinetic = mass * (r[11] * r[11] + r[12] * r[12] + 0.16 / 2 * spin * spin) / 2;
  EXPECT_NEAR(energy->beside(), kinetic + mass * 10 * r[9], 1e-9 * kinetic);
  const double of_liquid = run.series()["kinetic_energy"];  // the scale is that of the row
  EXPECT_NEAR(energy->scale(), of_liquid + kinetic, 1e-9 * kinetic);
}

TEST(LesSphFloating, APlankTurnsToTheLevelAndFloats) {
  Simulation run(plank);
  while (run.method.time() < 1) run.steps(1, std::min(0.01, run.method.step_limit().dt));
  const Row row = row_of(run, 0);
  EXPECT_LT(std::abs(row.turn), 10);
  EXPECT_NEAR(row.y, 0.03, 0.1);  // 0.4 of 0.3 below the surface: its middle 0.03 above
}

TEST(LesSphFloating, ABodyThatSinksThroughTheFloorIsRemarkedOn) {
  Simulation run(replaced(plank_on_water(4000), "rotation = [10]", "rotation = [10]\nposition = [0, -0.3]"));
  bool remarked = false;
  for (int step = 0; step < 60 && !remarked; ++step) {
    run.steps(1, std::min(0.01, run.method.step_limit().dt));
    for (const Remark& remark : run.method.take_remarks())
      remarked = remarked || remark.text.find("overlap at the start") != std::string::npos;
  }
  EXPECT_TRUE(remarked);
}

// Of a closed liquid a constant pressure moves no body. Without that of the void behind it a box flew to the floor, and
// the run ended at t = 1.88 with 150 m/s.
TEST(LesSphFloating, ALightBoxRisesFromTheFloorOfATankThatIsFull) {
  Simulation run(full_tank + light_box + "position = [0.5, 0.2]\nrotation = [20]\n");
  while (run.method.time() < 1.9) run.steps(1, std::min(0.02, run.method.step_limit().dt));
  EXPECT_GT(row_of(run, 0).y, 0.4);
  EXPECT_LT(run.series()["max_speed"], std::sqrt(2.0));  // of a fall through the tank
}

// The void below a flat face stays, and nothing has its pressure: the start says so. Where corrections of gradients do
// not fade beside it the body was thrown to the lid and the run ended.
TEST(LesSphFloating, AGapBelowABoxInATankThatIsFullIsRemarkedOn) {
  Simulation run(full_tank + light_box + "position = [0.5, 0.11]\n");
  run.steps(1, 1e-3);
  EXPECT_THAT(
      run.method.take_remarks(),
      testing::Contains(testing::Field(
          &Remark::text, testing::HasSubstr("floats in liquid that fills its domain and starts 0.2 spacings"))));
  Simulation lies(full_tank + light_box + "position = [0.5, 0.1]\n");
  lies.steps(1, 1e-3);
  EXPECT_THAT(lies.method.take_remarks(),
              testing::Not(testing::Contains(testing::Field(&Remark::text, testing::HasSubstr("floats in liquid")))));
  while (run.method.time() < 1.9) run.steps(1, std::min(0.02, run.method.step_limit().dt));
  EXPECT_GT(row_of(run, 0).y, 0.2);
}

// What neighbours share of the shift was taken out of it beside the box too, where no surface could be lifted: the
// liquid that the landing had stirred stayed thin in places of a few spacings, which the pressure closed at the price
// of jets, of 19 sqrt(gH) by t = 3.2, and the box flew through the tank.
TEST(LesSphFloating, AHeavyBoxComesToRestOnTheFloorOfATankThatIsFull) {
  const double spacing = 0.04;
  Simulation run(replaced(full_tank, "spacing = 0.05", "spacing = 0.04") +
                 "[[body]]\nshape = \"box\"\nsize = [0.3, 0.3]\ndensity = 2\nposition = [0.5, 0.5]\n");
  const std::size_t particles = run.method.flow().size();
  double fastest = 0;
  while (run.method.time() < 4) {
    run.steps(1, std::min(0.02, run.method.step_limit().dt));
    fastest = std::max(fastest, run.series()["max_speed"]);
  }
  EXPECT_NEAR(row_of(run, 0).y, 0.15 + spacing, 0.1 * spacing);
  EXPECT_LT(std::abs(row_of(run, 0).velocity_y), 0.02);
  EXPECT_LT(fastest, 2);  // it falls with 0.3, and what it presses out of the gap is faster by its width over that
  EXPECT_EQ(run.method.flow().size(), particles);
}

TEST(LesSphFloating, GivesTheSameBitsForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  State first;
  for (const int count : {1, 2, 3}) {
    omp_set_num_threads(count);
    Simulation run(plank);
    run.steps(4, 0.005);
    if (count == 1)
      first = run.state();
    else
      EXPECT_TRUE(run.state() == first) << count << " threads";
  }
  omp_set_num_threads(threads);
}

TEST(LesSphFloating, GoesOnBitForBitFromASavedState) {
  Simulation straight(plank), restored(plank);
  straight.steps(3, 0.005);
  MemoryState saved;
  straight.method.save(saved);
  straight.steps(2, 0.005);
  restored.method.load(saved);
  restored.steps(2, 0.005);
  EXPECT_TRUE(restored.state() == straight.state());
}

TEST(LesSphFloating, ARefusedStepLeavesTheState) {
  EXPECT_EQ(changed_by_a_refused_step(plank, {}, 0.005), "");
}

}  // namespace spume::test
