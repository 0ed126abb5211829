// SPDX-License-Identifier: MIT
// Liquids in full tanks: exchanges, layers at rest, energies, bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

// 28 spacings deep, sqrt(gH) = 1; `brine`: where the heavier one is.
std::string two_liquids(double heavier, double lighter, const std::string& brine, double spacing = 0.00357) {
  return "method = \"wcsph\"\n[domain]\nlower = [0, 0]\nupper = [0.2, 0.1]\nleft = \"free-slip\"\nright = "
         "\"free-slip\"\nbottom = \"free-slip\"\ntop = \"free-slip\"\n[resolution]\nspacing = " +
         std::to_string(spacing) +
         "\n[fluid]\ngravity = 9.81\n[[phase]]\nname = \"brine\"\ndensity = " + std::to_string(heavier) +
         "\nviscosity = 0.001\n[[phase]]\nname = \"oil\"\ndensity = " + std::to_string(lighter) +
         "\nviscosity = 0.001\n[[region]]\nphase = \"oil\"\n[[region]]\nphase = \"brine\"\n" + brine +
         "\n[time]\nend = 4\n";
}

// How far the middle of the brine is from that of the tank.
double lean(const WcsphRun& run) {
  const wcsph::Flow& flow = run.method.flow();
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    if (flow.phase_of(i) != 0) continue;
    sum += (*flow.particles.position[0])[i] - 0.1;
    ++count;
  }
  return sum / count;
}

// The interface 0.07 steep: half a period of the wave later it leans to the other side, less what its mode of half a
// wavelength loses; by the method of finite differences -0.99. Without shifting it came to -0.64, by the whole pressure
// it stopped at 0.02 of the start; a lattice has no wave of its own that long.
TEST(WcsphLiquids, ALeaningInterfaceSwingsThrough) {
  WcsphRun run(two_liquids(1100, 900, "where = \"0.05 + 0.07*(x - 0.1) - y\""));
  const double start = lean(run), k = std::numbers::pi / 0.2,
               frequency = std::sqrt(200 * 9.81 * k * std::tanh(0.05 * k) / 2000);
  until(run, std::numbers::pi / frequency);
  EXPECT_LT(lean(run), -0.7 * start);
  EXPECT_GT(lean(run), -1.02 * start);
}

// Side by side, one of them 5 % heavier: they turn over in half of the slow swing that buoyancy drives. By the method
// of finite differences, as fine, to -0.888 of the start at t = 2.5; unshifted particles, which resist it as a solid,
// came to -0.43.
TEST(WcsphLiquids, ThoseSideBySideTurnOver) {
  WcsphRun run(two_liquids(1050, 1000, "upper = [0.1, 0.1]", 0.005));
  EXPECT_TRUE(run.method.flow().features.shifting);
  const double start = lean(run);
  until(run, 2.46);
  EXPECT_NEAR(lean(run), -0.888 * start, 0.03 * std::abs(start));
}

// Beside bodies they are not shifted by themselves, and what they lose by that is said; shifted, or alone, nothing is.
TEST(WcsphLiquids, ThatAreNotShiftedBesideBodiesAreRemarkedOn) {
  const std::string post = "[[body]]\nshape = \"box\"\nsize = [0.03, 0.03]\nposition = [0.1, 0.05]\n",
                    liquids = two_liquids(1050, 1000, "upper = [0.1, 0.1]", 0.005);
  const auto remarks = [](const std::string& text, const std::vector<std::string>& options = {}) {
    WcsphRun run(text, options);
    std::size_t found = 0;
    for (const Remark& one : run.method.take_remarks()) found += one.text == wcsph::uneven_liquids ? 1 : 0;
    EXPECT_TRUE(run.method.take_remarks().empty());
    return found;
  };
  EXPECT_EQ(remarks(liquids + post), 1U);
  EXPECT_EQ(remarks(liquids + post, {"compressibility.shifting=on"}), 0U);
  EXPECT_EQ(remarks(liquids), 0U);
}

// The most that the energy of the verdict has grown by, over its scale, until `end`.
double energy_growth(WcsphRun& run, double end) {
  const std::vector<Invariant> invariants = run.method.invariants();
  const Invariant& growth = invariants.back();
  EXPECT_EQ(growth.quantity, "energy_growth");
  double least = INFINITY, most = 0, scale = 0;
  for (int row = 1; row <= 40; ++row) {
    until(run, row * end / 40);
    const double now = run.series().at(growth.column) + growth.beside();
    least = std::min(least, now);
    most = std::max(most, now - least);
    scale = std::max(scale, growth.scale());
  }
  return most / (scale + growth.scale_floor);
}

// Energy is that of the pressures which pairs feel: those over a still liquid, and a background. The sum of kinetic,
// potential and compression energy alone rises by 0.17 of the largest kinetic one in this exchange, unshifted. Under
// the mean of pressures the interface of what lies still makes energy where particles are shifted: the verdict sees it.
TEST(WcsphLiquids, ThatTurnOverGainNoEnergyUnderPressuresByDensities) {
  const std::string exchange = two_liquids(1050, 1000, "upper = [0.1, 0.1]", 0.005) + "[compressibility]\n";
  for (const std::string options : {"", "shifting = \"off\"\n"}) {
    WcsphRun run(exchange + options);
    EXPECT_LT(energy_growth(run, 2), 0.005) << options;
  }
  WcsphRun mean(two_liquids(1000, 250, "upper = [0.2, 0.05]", 0.005) +
                "[compressibility]\nshifting = \"on\"\ninterface_pressure = \"mean\"\n");
  EXPECT_GT(energy_growth(mean, 2), 0.03);
}

// Layers at rest settle unshifted; their noise is that of sound.
TEST(WcsphLiquids, LieStillInLayers) {
  WcsphRun run(two_liquids(1100, 900, "upper = [0.2, 0.05]", 0.005));
  EXPECT_FALSE(run.method.flow().features.shifting);
  run.prepare();
  double fastest = 0;
  while (run.method.time() < 1) {
    until(run, run.method.time() + 0.01);
    fastest = std::max(fastest, run.method.flow().largest_speed);
  }
  EXPECT_LT(fastest, 1e-3);
}

std::string full_tank(const std::string& gravity, const std::string& viscosity, const std::string& bodies) {
  return "method = \"wcsph\"\n[domain]\nlower = [0, 0]\nupper = [1.28, 1.28]\nleft = \"free-slip\"\nright = "
         "\"free-slip\"\nbottom = \"free-slip\"\ntop = \"free-slip\"\n[resolution]\nspacing = 0.04\n[fluid]\n" +
         gravity + "[[phase]]\nname = \"water\"\ndensity = 1\nviscosity = " + viscosity +
         "\n[[region]]\nphase = \"water\"\n" + bodies + "[time]\nend = 6\n";
}

std::vector<double> rows_of_bodies(WcsphRun& run) {
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  return rows;
}

// The pressure of a still liquid is integrated over elements of a spacing: the perimeter of a disc of five spacings is
// a polygon's of 32 sides, whose area is 0.65 % off if its corners lie on the circle. By whole pressures of pairs the
// water reached 0.11 sqrt(gH), and the forces swung.
TEST(WcsphFullTanks, WaterAroundBodiesStaysStillAndLiftsThemByTheirWeight) {
  WcsphRun run(full_tank("gravity = 1\n", "0",
                         "[[body]]\nshape = \"cylinder\"\nradius = 0.2\nposition = [0.61, 0.57]\n[[body]]\nshape = "
                         "\"box\"\nsize = [0.3, 0.2]\nposition = [1.0, 1.0]\nrotation = [30]\n"));
  run.prepare();
  double fastest = 0;
  while (run.method.time() < 6) {
    until(run, run.method.time() + 0.1);
    fastest = std::max(fastest, run.method.flow().largest_speed);
  }
  EXPECT_LT(fastest, 0.01);
  const std::vector<double> rows = rows_of_bodies(run);
  const std::size_t width = rows.size() / 2;
  EXPECT_NEAR(rows[3], 0.04 * std::numbers::pi, 0.0065 * 0.04 * std::numbers::pi);
  EXPECT_NEAR(rows[width + 3], 0.06, 0.005 * 0.06);
}

// A lid that sets out from rest: the scene at its start tells no speed, and particles would not be shifted.
TEST(WcsphFullTanks, ALidThatSetsOutFromRestShiftsWhatItMoves) {
  WcsphRun run(replaced(full_tank("gravity = 1\n", "0.01", ""), "top = \"free-slip\"\n",
                        "top = \"no-slip\"\nwall_velocity.top = [\"0.5*min(1, t)\", \"0\"]\n"));
  run.prepare();
  until(run, 2);
  const wcsph::Flow& flow = run.method.flow();
  EXPECT_EQ(flow.lone_speed, 0);
  double moved = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) moved = std::max(moved, std::abs(double{(*flow.shift[0])[i]}));
  EXPECT_GT(moved, 0);
  EXPECT_LT(moved, 0.5 * 0.5 * 1.05);  // half of the largest speed at most
}

// Gravity moves nothing in a tank that one liquid fills: by whole pressures it made 45 times the kinetic energy of a
// stirrer that turns by 2 degrees in a second.
TEST(WcsphFullTanks, AStirrerMovesTheLiquidAsWithoutGravity) {
  const std::string stirrer =
      "[[body]]\nshape = \"box\"\nsize = [0.6, 0.12]\nposition = [0.64, 0.64]\nangle = \"2*t\"\nwall = \"no-slip\"\n";
  double energy[2], lift[2];
  for (const int k : {0, 1}) {
    WcsphRun run(full_tank(k == 0 ? "" : "gravity = 1\n", "0.001", stirrer));
    run.prepare();
    until(run, 4);
    energy[k] = run.series().at("kinetic_energy");
    lift[k] = rows_of_bodies(run)[3];
  }
  EXPECT_NEAR(energy[1], energy[0], 0.25 * energy[0]);
  EXPECT_NEAR(lift[1] - lift[0], 0.072, 0.03 * 0.072);
}

}  // namespace
}  // namespace spume::test
