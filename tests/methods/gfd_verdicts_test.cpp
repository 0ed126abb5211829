// SPDX-License-Identifier: MIT
// What gfd says of momentum and energy that it makes from nothing.
#include <gtest/gtest.h>

#include <map>

#include "methods/gfd_run.hpp"
#include "spume/run/verdicts.hpp"

namespace spume::test {
namespace {

const std::string drop_in_a_wind = R"toml(method = "gfd"
[domain]
lower = [0, 0]
upper = [4, 2]
x = "periodic"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.0625
[[phase]]
name = "gas"
density = 1
viscosity = 0.002
[[phase]]
name = "drop"
density = 1
viscosity = 0.002
[interface]
surface_tension = 0.05
[[region]]
phase = "gas"
velocity = ["1", "0"]
[[region]]
phase = "drop"
centre = [1, 1]
radius = 0.35
[time]
end = 1
)toml";

std::map<std::string, Verdict> verdicts_of(GfdRun& run, double end) {
  const std::vector<SeriesColumn> columns = run.method.series_columns();
  InvariantWatch watch(run.method.invariants(), columns);
  std::vector<double> row(columns.size());
  const auto observe = [&] {
    run.method.series_values(row);
    watch.observe(row);
  };
  observe();
  while (run.method.time() < end) {
    run.until(run.method.time() + end / 8);
    observe();
  }
  std::map<std::string, Verdict> found;
  for (const Verdict& verdict : watch.verdicts()) found.emplace(verdict.quantity, verdict);
  return found;
}

// Mass that the filter of the density passes on takes its momentum along. Without, a drop a hundred times as dense as
// the wind gains a fifth of the momentum that its energy could have, one a thousand times as dense a quarter, and half
// of its energy.
TEST(GfdVerdicts, HeavyDropsKeepMomentumAndEnergy) {
  for (const char* const density : {"1", "100", "1000"}) {
    GfdRun run(drop_in_a_wind, {std::string("phase.1.density=") + density, "phase.1.viscosity=0.02"});
    const auto found = verdicts_of(run, 0.5);
    EXPECT_TRUE(found.at("momentum_x_change").pass()) << density << ": " << found.at("momentum_x_change").value;
    EXPECT_EQ(found.count("momentum_y_change"), 0U);  // walls push along y
    EXPECT_TRUE(found.at("energy_growth").pass()) << density << ": " << found.at("energy_growth").value;
  }
}

// Two fluids that change places in a narrow tank slide along its walls faster than a spacing resolves. By the gradient
// between fluid and image the shift gave them 0.07 of their largest energy, and on a lattice half as wide the run
// ended.
TEST(GfdVerdicts, AnExchangeAlongNoSlipWallsMakesNoEnergy) {
  std::string text = "method = \"gfd\"\n[domain]\nlower = [0, 0, 0]\nupper = [0.6, 0.14, 0.3]\n";
  for (const char* const side : {"left", "right", "front", "back", "bottom", "top"})
    text += std::string(side) + " = \"no-slip\"\n";
  text +=
      "[resolution]\nspacing = 0.02\n[fluid]\ngravity = 9.81\n"
      "[[phase]]\nname = \"light\"\ndensity = 500\nviscosity = 1e-3\n"
      "[[phase]]\nname = \"heavy\"\ndensity = 1000\nviscosity = 1e-3\n"
      "[[region]]\nphase = \"light\"\n[[region]]\nphase = \"heavy\"\nupper = [0.3, 0.14, 0.3]\n"
      "[time]\nend = 1.2\n";
  GfdRun run(text);
  const Verdict verdict = verdicts_of(run, 1.2).at("energy_growth");
  EXPECT_TRUE(verdict.pass()) << verdict.value;
}

// A drop of four spacings still gains momentum where the densities of its outer particles are blends.
TEST(GfdVerdicts, MomentumFromNothingIsSaid) {
  GfdRun coarse(drop_in_a_wind, {"phase.1.density=2000", "phase.1.viscosity=0.02", "resolution.spacing=0.16"});
  const Verdict verdict = verdicts_of(coarse, 2).at("momentum_x_change");
  EXPECT_FALSE(verdict.pass()) << verdict.value;
}

TEST(GfdVerdicts, AreLeftOutWhereSomethingActs) {
  GfdRun driven(drop_in_a_wind, {"forces.body=[\"0.1\",\"0\"]"}), held(drop_in_a_wind, {"domain.top=\"no-slip\""}),
      falling(drop_in_a_wind, {"fluid.gravity=1"});
  EXPECT_EQ(verdicts_of(driven, 0.02).count("momentum_x_change"), 0U);
  EXPECT_EQ(verdicts_of(driven, 0.02).count("energy_growth"), 0U);
  EXPECT_EQ(verdicts_of(held, 0.02).count("momentum_x_change"), 0U);
  EXPECT_EQ(verdicts_of(held, 0.02).count("energy_growth"), 1U);
  EXPECT_EQ(verdicts_of(falling, 0.02).count("momentum_x_change"), 1U);
}

// The columns are the sums over the particles, at the densities of their phases and the velocities that they have
// behind the first exchange of mass.
TEST(GfdVerdicts, ColumnsOfTheMomentumAreThoseOfTheParticles) {
  GfdRun run(ball_in_a_box);
  const std::vector<SeriesColumn> columns = run.method.series_columns();
  std::vector<double> row(columns.size());
  run.method.series_values(row);
  const gfd::Flow& flow = run.flow();
  ASSERT_NE(flow.densities[0], flow.densities[1]);
  Vec3 sum{};
  for (std::size_t i = 0; i < flow.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      sum[axis] += flow.particles.volume * flow.densities[flow.phase[i]] * (*flow.particles.velocity[axis])[i];
  const std::array<std::string, 3> names{"momentum_x", "momentum_y", "momentum_z"};
  int found = 0;
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (columns[c].name == names[axis]) {
        EXPECT_NEAR(row[c], sum[axis], 1e-12);
        ++found;
      }
  EXPECT_EQ(found, 3);
}

// Two liquids in a tank that is shaken and turned: all that they have is the work of its walls, which the verdict takes
// off; a run that is continued goes on with it. Belts do work that forces at rest do not tell.
TEST(GfdVerdicts, TheEnergyHasTheWorkOfMovingBodies) {
  const std::string tank =
      "method = \"gfd\"\n[domain]\nlower = [-1.6, -1.1]\nupper = [1.6, 1.1]\nleft = \"free-slip\"\nright = "
      "\"free-slip\"\nbottom = \"free-slip\"\ntop = \"free-slip\"\n[resolution]\nspacing = 0.05\n"
      "[[phase]]\nname = \"heavy\"\ndensity = 2\nviscosity = 1e-3\n[[phase]]\nname = \"light\"\ndensity = 1\n"
      "viscosity = 1e-3\n[[region]]\nphase = \"heavy\"\n[[region]]\nphase = \"light\"\nlower = [-1.6, 0]\n"
      "upper = [1.6, 1.1]\n[time]\nend = 1\n[[body]]\nshape = \"box\"\nsize = [1, 0.8]\ninside = false\n";
  const std::string shaken = tank + "displacement = [\"0.25*t^2\", \"0\"]\nangle = \"90*t^2\"\n";
  GfdRun straight(shaken), restored(shaken);
  const auto to_next_row = [](GfdRun& run) {
    run.until(run.method.time() + 0.01);
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
  };
  const auto beside = [](const GfdRun& run) {
    for (const Invariant& one : run.method.invariants())
      if (one.quantity == "energy_growth") return one.beside();
    return std::nan("");
  };
  std::vector<double> rows;
  straight.method.table_rows("bodies", rows);
  const double before = beside(straight);
  for (int row = 0; row < 30; ++row) to_next_row(straight);
  MemoryState saved;
  straight.method.save(saved);
  restored.method.load(saved);
  for (int row = 0; row < 20; ++row) to_next_row(straight), to_next_row(restored);
  const double energy = straight.flow().kinetic_energy(), now = beside(straight);
  EXPECT_GT(energy, 0.01);
  EXPECT_LT(energy + now - before, 0.05 * energy);
  EXPECT_NEAR(energy + now, before, 0.25 * energy);
  EXPECT_EQ(beside(restored), now);
  EXPECT_TRUE(std::isnan(beside(GfdRun(tank + "velocity = [\"1\", \"0\"]\n"))));
}

}  // namespace
}  // namespace spume::test
