// SPDX-License-Identifier: MIT
// Full tanks with bodies: at rest, and with liquid that solids enclose apart from the rest, whose pressure has a
// constant of its own.
#include <gtest/gtest.h>

#include <numbers>

#include "methods/gfd_run.hpp"
#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

const std::string closed = "left = \"free-slip\"\nright = \"free-slip\"\nbottom = \"free-slip\"\ntop = \"free-slip\"\n";

std::string full_of_water(const std::string& upper, double spacing, const std::string& region) {
  return "method = \"gfd\"\n[domain]\nlower = [0, 0]\nupper = " + upper + "\n" + closed +
         "[resolution]\nspacing = " + std::to_string(spacing) +
         "\n[fluid]\ngravity = 1\n[[phase]]\nname = \"water\"\ndensity = 1\nviscosity = 0.01\n[[region]]\nphase = "
         "\"water\"\n" +
         region + "[time]\nend = 1\nmax_step = 0.02\n";
}

// A vortex left of a wall, which leaves the liquid right of it at rest.
const std::string vortex = "velocity = [\"sin(pi*x)*cos(pi*y)*(x < 1)\", \"-cos(pi*x)*sin(pi*y)*(x < 1)\"]\n";
const std::string wall = "[[solid]]\nlower = [1, 0]\nupper = [1.2, 1]\n";

std::string les_sph(const std::string& upper) {
  return "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = " + upper + "\n" + closed +
         "[resolution]\nspacing = 0.05\n[fluid]\ndensity = 1\nviscosity = 0.01\n[[liquid]]\n" + vortex +
         "[time]\nend = 1\nmax_step = 0.02\n";
}

// Both runs in equal steps: the one with the wall has a vortex as the other has, and still water behind the wall.
template <class Run>
void expect_the_vortex_of_a_tank_of_its_own(const std::string& two, const std::string& one) {
  Run walled(two), alone(one);
  for (int step = 0; step < 20; ++step) {
    walled.steps(1, 0.01);
    alone.steps(1, 0.01);
  }
  // A step leaves a thousandth of its divergence to the next one in both.
  EXPECT_NEAR(walled.series()["kinetic_energy"], alone.series()["kinetic_energy"],
              1e-3 * alone.series()["kinetic_energy"]);
  const auto& flow = walled.flow();
  double behind = 0;
  for (std::size_t i = 0; i < flow.size(); ++i)
    if ((*flow.particles.position[0])[i] > 1.1)
      for (int axis = 0; axis < 2; ++axis) behind = std::max(behind, std::abs((*flow.particles.velocity[axis])[i]));
  EXPECT_LT(behind, 1e-5);
}

// Between walls, up to a level.
std::string water_below(const std::string& upper, const std::string& spacing, const std::string& level) {
  return "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = " + upper +
         "\nleft = \"free-slip\"\nright = \"free-slip\"\nbottom = \"free-slip\"\n[resolution]\nspacing = " + spacing +
         "\n[fluid]\ndensity = 1\ngravity = 1\n[[liquid]]\nwhere = \"" + level +
         " - y\"\n[time]\nend = 1\nmax_step = 0.02\n";
}

struct LesSphRun : Simulation {
  using Simulation::Simulation;
  const les_sph::Flow& flow() const { return method.flow(); }
};

}  // namespace

// The residual of liquid at rest is the rounding of its weight, of which no millionth can be asked: the second step did
// not converge.
TEST(EnclosedLiquidFlow, AFullTankRestsAroundATurnedBox) {
  GfdRun run(full_of_water("[1.6, 1.1]", 0.04, "") +
             "[[body]]\nshape = \"box\"\nposition = [0.7727, 0.1668]\nsize = [0.5234, 0.5048]\nrotation = [118.39]\n");
  for (int step = 0; step < 20; ++step) run.steps(1, 0.02);
  EXPECT_LT(run.max_speed(), 1e-9);
}

// Neither converged.
TEST(EnclosedLiquidFlow, MovesAsInATankOfItsOwnByGfd) {
  expect_the_vortex_of_a_tank_of_its_own<GfdRun>(full_of_water("[2.25, 1]", 0.05, vortex) + wall,
                                                 full_of_water("[1, 1]", 0.05, vortex));
}

TEST(EnclosedLiquidFlow, MovesAsInATankOfItsOwnByLesSph) {
  expect_the_vortex_of_a_tank_of_its_own<LesSphRun>(les_sph("[2.25, 1]") + wall, les_sph("[1, 1]"));
}

TEST(EnclosedLiquidFlow, ResumesBitForBit) {
  expect_the_same_bits_resumed<GfdRun>(full_of_water("[2.25, 1]", 0.05, vortex) + wall, 3, 0.01);
  expect_the_same_bits_resumed<LesSphRun>(les_sph("[2.25, 1]") + wall, 3, 0.01);
}

// Turned boxes that enclose a drop of some particles between them and the floor.
TEST(EnclosedLiquidFlow, RestsBetweenBodies) {
  const std::string boxes =
      "[[body]]\nshape = \"box\"\nposition = [0.8986, 0.0211]\nsize = [0.5301, 0.7317]\nrotation = [165.0085]\n"
      "[[body]]\nshape = \"box\"\nposition = [1.3141, 0.2409]\nsize = [0.7949, 0.461]\nrotation = [149.2659]\n";
  GfdRun run(full_of_water("[1.6, 1.1]", 0.04, "") + boxes);
  for (int step = 0; step < 20; ++step) run.steps(1, 0.02);
  EXPECT_LT(run.max_speed(), 1e-9);
}

// A piston with a narrow gap at both ends, of the density of water or half as much again, floats on what it encloses.
// With as much water above as below, constants above and below together leave it at rest: taken for the only unknown
// ones, it fell at 0.2 m/s.
TEST(EnclosedLiquidFlow, APistonRestsOnWhatItEncloses) {
  // A hundred times as heavy as all water above it, it counted as free and fell.
  for (const auto& [height, density] :
       {std::pair{"0.35", "1"}, {"0.4", "1"}, {"0.35", "1.5"}, {"0.5", "1"}, {"0.5", "1000"}}) {
    SCOPED_TRACE(std::string(height) + ", density " + density);
    LesSphRun run(water_below("[1, 1.2]", "0.025", "1") +
                  "[[body]]\nshape = \"box\"\nsize = [0.98, 0.3]\nfree = [\"y\"]\nposition = [0.5, " +
                  std::string(height) + "]\ndensity = " + density + "\n");
    for (int step = 0; step < 3; ++step) run.steps(1, 0.01);
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    const double weight = 0.98 * 0.3 * std::stod(density);
    EXPECT_NEAR(rows[3], weight, 1e-4 * weight);
    EXPECT_LT(run.series()["max_speed"], 1e-4);
  }
}

// Two chambers below one piston, which a wall parts: it knows their mean and not their difference, which made the wall
// bear half of the weight sideways.
TEST(EnclosedLiquidFlow, APistonOverTwoChambersLeavesTheWallBetweenThemAlone) {
  LesSphRun run(water_below("[1, 1.4]", "0.025", "1") +
                "[[body]]\nshape = \"box\"\nsize = [0.98, 0.3]\nfree = [\"y\"]\nposition = [0.5, 0.6]\ndensity = 1.5\n"
                "[[body]]\nshape = \"box\"\nsize = [0.2, 0.98]\nposition = [0.5, 0]\n");
  for (int step = 0; step < 3; ++step) run.steps(1, 0.01);
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  const double weight = 0.98 * 0.3 * 1.5;
  EXPECT_NEAR(rows[3], weight, 1e-4 * weight);
  const std::size_t wall = rows.size() / 2;
  EXPECT_NEAR(rows[wall + 2], 0, 1e-3 * weight);
}

// With air alone above it, no pressure is known but what carries the piston. Its mean was taken out: it fell faster
// than without any water.
TEST(EnclosedLiquidFlow, APistonBelowAirRestsOnWhatItEncloses) {
  LesSphRun run(
      water_below("[1.6, 1.3]", "0.04", "0.56") +
      "[[body]]\nshape = \"box\"\nsize = [1.58, 0.3]\nposition = [0.8, 0.71]\nfree = [\"y\"]\ndensity = 1.5\n");
  run.steps(3, 0.02);
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  const double weight = 1.58 * 0.3 * 1.5;
  EXPECT_NEAR(rows[3], weight, 1e-4 * weight);
}

// No pressure turns a ball: what its torque has is rounding, which counted as what it knows of the constant.
TEST(EnclosedLiquidFlow, ABallMayTurnInWhatSolidsEnclose) {
  LesSphRun run(
      water_below("[1, 1.2]", "0.025", "1") +
      "[[body]]\nshape = \"box\"\nsize = [0.98, 0.3]\nposition = [0.5, 0.5]\n"
      "[[body]]\nshape = \"ball\"\nradius = 0.1\nposition = [0.5, 0.15]\nfree = [\"x\", \"y\", \"turn\"]\ndensity = "
      "1.1\n");
  run.steps(3, 0.01);
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  // Its weight less its acceleration, which added mass makes less than a twentieth of gravity.
  const double displaced = std::numbers::pi * 0.01;
  EXPECT_GT(rows[rows.size() / 2 + 3], displaced);
  EXPECT_LT(rows[rows.size() / 2 + 3], 1.1 * displaced);
}

// With sound the errors of the divergence add up in a constant that nobody takes out. A body that moves in one of two
// chambers leaves that of the other: the force on the wall between them grew to 3.8.
TEST(EnclosedLiquidFlow, OneOfTwoChambersWithSoundKeepsItsPressure) {
  Simulation run(
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [2.25, 1]\n" + closed +
      "[resolution]\nspacing = 0.05\n[fluid]\ndensity = 1\nsound_speed = 10\n[[liquid]]\nupper = [2.25, "
      "1]\nvelocity = [\"sin(pi*x)*cos(pi*y)\", \"-cos(pi*x)*sin(pi*y)\"]\n[[body]]\nshape = \"box\"\nsize = [0.25, "
      "1.5]\nposition = [1.125, 0.5]\n[[body]]\nshape = \"ball\"\nradius = 0.15\nposition = [1.75, "
      "0.5]\ndisplacement = [\"0.001*sin(t)\", \"0\"]\n[time]\nend = 2\nmax_step = 0.02\n");
  double sum = 0;
  int rows_of_half = 0;
  while (run.method.time() < 2) {
    run.steps(1, run.method.step_limit().dt);
    if (run.method.time() < 1) continue;
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    sum += rows[2];
    ++rows_of_half;
  }
  // A tenth of the dynamic pressure of the vortices, on a wall of length 1.
  EXPECT_NEAR(sum / rows_of_half, 0, 0.1);
}

// The top is open, but a lid closes off all liquid: no method takes the constant out, and the force on it went from
// -0.44 to 1 in this time.
TEST(EnclosedLiquidFlow, LiquidBelowALidWithSoundKeepsItsPressure) {
  Simulation run(
      replaced(water_below("[1.6, 1.3]", "0.04", "0.56"), "gravity = 1\n", "gravity = 1\nsound_speed = 15\n") +
      "[[body]]\nshape = \"box\"\nsize = [1.58, 0.3]\nposition = [0.8, 0.71]\n");
  const auto force = [&] {
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    return rows[3];
  };
  run.steps(20, 0.02);
  const double before = force();
  run.steps(30, 0.02);
  EXPECT_NEAR(force(), before, 0.05);
}

// A factorisation knows as many constants as there are parts; the iterative solver leaves a millionth of the weight.
TEST(EnclosedLiquidFlow, FactorsOfTheMatrixAgreeWithIterations) {
  const std::string text = les_sph("[2.25, 1]") + wall;
  LesSphRun iterated(text), factorised(replaced(text, "[time]", "[pressure]\nsolver = \"direct\"\n[time]"));
  for (int step = 0; step < 5; ++step) {
    iterated.steps(1, 0.01);
    factorised.steps(1, 0.01);
  }
  const double energy = factorised.series()["kinetic_energy"];
  EXPECT_NEAR(iterated.series()["kinetic_energy"], energy, 1e-3 * energy);
  double behind = 0;
  const auto& flow = factorised.flow();
  for (std::size_t i = 0; i < flow.size(); ++i)
    if ((*flow.particles.position[0])[i] > 1.1) behind = std::max(behind, std::abs((*flow.particles.velocity[0])[i]));
  EXPECT_LT(behind, 1e-12);
}

}  // namespace spume::test
