// SPDX-License-Identifier: MIT
// les-sph with floating bodies that meet walls and each other.
#include <gmock/gmock.h>

#include <numbers>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

using std::numbers::pi;

// Four times as heavy as water.
const std::string sinking_plank = plank_on_water(4000, 2);

// Beside a puddle, far from it: discs in the air.
const std::string dry_tank = R"toml(method = "les-sph"
[time]
end = 2
[domain]
lower = [-1, -0.5]
upper = [1, 1]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
density = 1000
viscosity = 1e-3
gravity = 10
[[liquid]]
lower = [-1, -0.5]
upper = [-0.7, -0.4]
)toml";
std::string falling_disc(double y, double density, double restitution) {
  return "[[body]]\nshape = \"ball\"\nradius = 0.15\nposition = [0.43, " + std::to_string(y) +
         "]\ndensity = " + std::to_string(density) + "\nrestitution = " + std::to_string(restitution) + "\n";
}

struct Whereabouts {
  double x, y, turn, velocity_x, velocity_y, spin;
};
Whereabouts whereabouts(Simulation& run, std::size_t wall) {
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  const double* const r = rows.data() + 14 * wall;
  return {r[8], r[9], r[10], r[11], r[12], r[13]};
}

void go_on(Simulation& run, double longest = 0.01) {
  run.steps(1, std::min(longest, run.method.step_limit().dt));
}

}  // namespace

// It comes down with 1.1 m/s. Where contacts were none it went on; where film particles were squeezed it was thrown up
// with 4 m/s. It may be lifted by the water that it presses out, not faster than it came.
TEST(LesSphContacts, APlankSinksToTheFloorAndStays) {
  Simulation run(sinking_plank);
  double fastest = 0, highest = -1, lowest = 1;
  while (run.method.time() < 1) {
    go_on(run);
    const Whereabouts row = whereabouts(run, 0);
    if (run.method.time() < 0.3) continue;
    fastest = std::max(fastest, row.velocity_y);
    lowest = std::min(lowest, row.y);
    if (run.method.time() > 0.6) highest = std::max(highest, row.y);
  }
  // Half of its thickness and a spacing above the floor; a corner is pressed in by no more than a tenth of a spacing.
  EXPECT_GT(lowest, -0.5 + 0.15 + 0.05 - 0.005);
  EXPECT_LT(highest, -0.5 + 0.15 + 0.05 + 0.05);
  EXPECT_LT(fastest, 0.6);
  EXPECT_NEAR(whereabouts(run, 0).turn, -10, 3);
}

TEST(LesSphContacts, ADiscBouncesOffADryFloorWithItsRestitution) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    Simulation run(dry_tank + falling_disc(0.2, 400, restitution));
    // Falls by 0.5 to the clearance of a spacing: sqrt(2 g h) = 3.16 within g dt, 0.1.
    double before = 0;
    while (run.method.time() < 0.45 && whereabouts(run, 0).velocity_y <= before) {
      before = whereabouts(run, 0).velocity_y;
      go_on(run);
    }
    EXPECT_NEAR(before, -std::sqrt(2 * 10 * 0.5), 0.1);
    // Velocities are those of ends of steps: half of an impact is in the next, however short.
    go_on(run, 0.002);
    EXPECT_NEAR(whereabouts(run, 0).velocity_y, -restitution * before, 0.15) << restitution;
    EXPECT_NEAR(whereabouts(run, 0).velocity_x, 0, 1e-9);
    EXPECT_NEAR(whereabouts(run, 0).spin, 0, 1e-6);
    if (restitution > 0) continue;
    for (int k = 0; k < 20; ++k) go_on(run);
    EXPECT_NEAR(whereabouts(run, 0).y, -0.5 + 0.15 + 0.05, 1e-3);
    EXPECT_NEAR(whereabouts(run, 0).velocity_y, 0, 1e-6);
  }
}

// The lower one bounces off the floor and meets the upper one in the air, three times as heavy: what both have together
// changes by gravity alone.
TEST(LesSphContacts, TwoBodiesKeepTheirMomentum) {
  Simulation run(dry_tank + falling_disc(-0.1, 400, 1) + falling_disc(0.8, 1200, 1));
  const double area = pi * 0.15 * 0.15;
  const auto momentum = [&] {
    return area * (400 * whereabouts(run, 0).velocity_y + 1200 * whereabouts(run, 1).velocity_y);
  };
  const auto energy = [&] {
    const Whereabouts a = whereabouts(run, 0), b = whereabouts(run, 1);
    return area *
           (400 * (a.velocity_y * a.velocity_y / 2 + 10 * a.y) + 1200 * (b.velocity_y * b.velocity_y / 2 + 10 * b.y));
  };
  bool met = false, bounced = false;
  double t = 0, p = 0, e = 0;
  while (run.method.time() < 0.5 && !met) {
    const Whereabouts before = whereabouts(run, 1);
    go_on(run, 0.004);
    if (!bounced && whereabouts(run, 0).velocity_y > 1 && whereabouts(run, 0).y > -0.25) {
      bounced = true;  // both are in the air
      t = run.method.time();
      p = momentum();
      e = energy();
    }
    if (!bounced) continue;
    const double exact = p - 1600 * area * 10 * (run.method.time() - t);
    EXPECT_NEAR(momentum(), exact, 1e-9 * std::abs(p)) << run.method.time();
    if (whereabouts(run, 1).velocity_y > before.velocity_y + 0.5) met = true;  // it gains 2 m/s, half in a step
  }
  ASSERT_TRUE(met);
  for (int k = 0; k < 2; ++k) go_on(run, 0.002);
  // What is left of the distance when they meet, up to a step's way, is potential energy of a few per cent.
  EXPECT_NEAR(energy(), e, 0.05 * std::abs(e));
}

// Dry, on two free feet: it cannot move, whatever the step.
TEST(LesSphContacts, ABoxOnTheFloorStaysWhereItIs) {
  Simulation run(dry_tank + "[[body]]\nshape = \"box\"\nsize = [0.4, 0.2]\nposition = [0.3, -0.4]\ndensity = 400\n");
  for (int k = 0; k < 30; ++k) go_on(run, 0.001 + 0.004 * (k % 3));
  const Whereabouts row = whereabouts(run, 0);
  EXPECT_NEAR(row.y, -0.4, 1e-9);
  EXPECT_NEAR(row.turn, 0, 1e-9);
  EXPECT_NEAR(row.velocity_y, 0, 1e-9);
}

// Started nearer to the floor, it comes to rest in the first steps.
const std::string landing = replaced(sinking_plank, "rotation = [10]", "position = [0, -0.27]");

TEST(LesSphContacts, GiveTheSameBitsForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  State first;
  for (const int count : {1, 2}) {
    omp_set_num_threads(count);
    Simulation run(landing);
    run.steps(15, 0.01);
    EXPECT_LT(whereabouts(run, 0).y, -0.295);
    if (count == 1)
      first = run.state();
    else
      EXPECT_TRUE(run.state() == first);
  }
  omp_set_num_threads(threads);
}

TEST(LesSphContacts, GoOnBitForBitFromASavedState) {
  Simulation straight(landing), restored(landing);
  straight.steps(14, 0.01);
  MemoryState saved;
  straight.method.save(saved);
  restored.method.load(saved);
  EXPECT_EQ(straight.method.step_limit().dt, restored.method.step_limit().dt);
  straight.steps(4, 0.01);
  restored.steps(4, 0.01);
  EXPECT_LT(whereabouts(restored, 0).y, -0.295);
  EXPECT_TRUE(restored.state() == straight.state());
}

TEST(LesSphContacts, ARefusedStepLeavesThem) {
  const std::string close = replaced(landing, "position = [0, -0.27]", "position = [0, -0.3]");
  EXPECT_EQ(changed_by_a_refused_step(close, {}, 0.005), "");
}

}  // namespace spume::test
