// SPDX-License-Identifier: MIT
// Bodies across a periodic side are what they are in the middle of the domain.
#include <gtest/gtest.h>

#include <algorithm>

#include "methods/les_sph_simulation.hpp"
#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

std::string round_channel(const std::string& method, const std::string& liquid) {
  return "method = \"" + method +
         "\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nx = \"periodic\"\nbottom = \"no-slip\"\ntop = "
         "\"no-slip\"\n[resolution]\nspacing = 0.04\n" +
         liquid + "[time]\nend = 1\nmax_step = 0.02\n";
}

template <class Run>
std::vector<double> row_after(const std::string& text, int steps, double dt) {
  Run run(text);
  run.steps(steps, dt);
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  return rows;
}

}  // namespace

// The wall had the velocity of a point a period away from it: the torque was +0.06 for -0.009.
TEST(PeriodicBodies, ASpinningBallHasTheSameTorqueByLesSph) {
  const std::string water =
      round_channel("les-sph", "[fluid]\ndensity = 1\nviscosity = 0.01\n[[liquid]]\nupper = [1, 1]\n");
  const auto ball = [](const std::string& x) {
    return "[[body]]\nshape = \"ball\"\nradius = 0.2\nposition = [" + x +
           ", 0.5]\nwall = \"no-slip\"\nangle = \"60*t\"\n";
  };
  // The lattice lies around both alike.
  const std::vector<double> middle = row_after<Simulation>(water + ball("0.48"), 10, 0.02),
                            across = row_after<Simulation>(water + ball("0"), 10, 0.02);
  EXPECT_LT(middle[7], -0.005);
  EXPECT_NEAR(across[7], middle[7], 0.02 * std::abs(middle[7]));
  for (const int column : {2, 3, 4, 5}) EXPECT_NEAR(across[column], middle[column], 0.02 * std::abs(middle[7]));
}

// Pairs of particles and wall points are counted from the pivot: the torque of a box at rest was 0.145.
TEST(PeriodicBodies, ABoxAtRestHasTheSameTorqueByWcsph) {
  const std::string water = round_channel("wcsph",
                                          "[fluid]\ngravity = 1\n[[phase]]\nname = \"water\"\ndensity = 1\nviscosity = "
                                          "0.001\n[[region]]\nphase = \"water\"\nupper = [1, 0.8]\n");
  const std::string open = replaced(water, "top = \"no-slip\"\n", "");
  for (const std::string motion : {"", "angle = \"0*t\"\n"}) {
    SCOPED_TRACE(motion);
    const auto box = [&](const std::string& x) {
      return "[[body]]\nshape = \"box\"\nsize = [0.4, 0.3]\nposition = [" + x + ", 0.4]\n" + motion;
    };
    const std::vector<double> middle = row_after<WcsphRun>(open + box("0.48"), 20, 5e-4),
                              across = row_after<WcsphRun>(open + box("0"), 20, 5e-4);
    EXPECT_NEAR(middle[3], 0.12, 0.12 * 0.12);  // from the lattice the pairs scatter by as much
    // From other random starts liquid settles to forces of 0.119 to 0.125 (24 runs, both places).
    EXPECT_NEAR(across[3], middle[3], 0.05 * middle[3]);
    // About the origin.
    EXPECT_NEAR(middle[6], 0.48 * middle[3], 1e-3);
    EXPECT_NEAR(across[6], 0, 1e-3);
  }
}

// Gravity works on a body along a periodic axis, and on nothing across: the verdict on the energy of one that sinks
// failed with 0.9.
TEST(PeriodicBodies, TheEnergyOfABallThatSinksAroundTheDomainHasTheWorkOfGravity) {
  Simulation run(
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nx = \"periodic\"\ny = "
      "\"periodic\"\n[resolution]\nspacing = 0.04\n[fluid]\ndensity = 1\ngravity = 1\nviscosity = "
      "0.01\n[[liquid]]\nupper = [1, 1]\n[forces]\nbody = [\"0\", \"1.05\"]\n[[body]]\nshape = \"ball\"\nradius = "
      "0.16\nposition = [0.5, 0.5]\ndensity = 1.5\nfree = [\"x\", \"y\", \"turn\"]\n[time]\nend = 2\nmax_step = "
      "0.02\n");
  run.steps(1, 1e-6);
  const auto energy = [&] {
    const std::vector<Invariant> invariants = run.method.invariants();
    const auto one = std::find_if(invariants.begin(), invariants.end(),
                                  [](const Invariant& invariant) { return invariant.quantity == "energy_growth"; });
    EXPECT_NE(one, invariants.end());
    return run.series()["total_energy"] + one->beside();
  };
  const double before = energy();
  run.steps(30, 0.02);
  const double moved = run.series()["kinetic_energy"];
  EXPECT_GT(moved, 0);
  EXPECT_LT(energy() - before, 0.05 * moved);
}

}  // namespace spume::test
