// SPDX-License-Identifier: MIT
// Sea beds that an expression gives, in channels without ends: water stands still over them, and they bear its weight.
#include <gtest/gtest.h>

#include "methods/gfd_run.hpp"
#include "methods/les_sph_simulation.hpp"
#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

struct Bed {
  const char* sides;
  std::string size, upper, height;  // of the domain without the last axis, the water's last entry, and the bed
  double spacing;
};
const Bed wavy_bed{"x = \"periodic\"", "2", "y", "0.3 + 0.1*sin(pi*x)", 0.05},
    hollow{"x = \"periodic\"", "2", "y", "0.2 + 0.1*(x - 1)^2", 0.05},
    dunes{"x = \"periodic\"\ny = \"periodic\"", "2, 1", "z", "0.3 + 0.1*sin(pi*x)*cos(2*pi*y)", 0.1},
    ridges{"x = \"periodic\"\nfront = \"free-slip\"\nback = \"free-slip\"", "2, 1", "z", "0.3 + 0.1*cos(pi*x)", 0.1};

// Water a unit deep from the floor on, below a lid or a surface.
std::string channel_over(const Bed& bed, const std::string& method, bool lid, const std::string& liquid) {
  const std::string zeros = bed.size.find(',') == std::string::npos ? "[0, 0]" : "[0, 0, 0]";
  return "method = \"" + method + "\"\n[domain]\nlower = " + zeros + "\nupper = [" + bed.size +
         (lid ? ", 1]\ntop = \"free-slip\"\n" : ", 1.3]\n") + bed.sides +
         "\nbottom = \"free-slip\"\n[resolution]\nspacing = " + std::to_string(bed.spacing) +
         "\n[fluid]\ngravity = 1\n" + liquid + "upper = [" + bed.size + ", 1]\n[[body]]\nwhere = \"" + bed.height +
         " - " + bed.upper + "\"\n[time]\nend = 20\nmax_step = 0.02\n";
}
const std::string one_phase =
    "[[phase]]\nname = \"water\"\ndensity = 1\nviscosity = 0.001\n[[region]]\nphase = \"water\"\n";

// With what presses on the water from above. Elements of a spacing and fits err by half a hundredth, shares of cells
// that the bed cuts by a thousandth.
template <class Run>
void expect_to_bear(Run& run, double volume, double above = 0) {
  const auto& particles = run.loaded.scene.particles;
  EXPECT_NEAR(static_cast<double>(particles.size()) * particles.volume, volume, 1e-3 * volume);
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  EXPECT_NEAR(rows[static_cast<std::size_t>(run.loaded.scene.domain.dimensions) + 1], -volume - above, 5e-3 * volume);
  EXPECT_NEAR(rows[2], 0, 1e-3 * volume);
}

}  // namespace

TEST(PeriodicBeds, HoldStillWaterByLesSph) {
  for (const auto& [bed, volume] :
       {std::pair{wavy_bed, 1.4}, {hollow, 2 * (0.8 - 0.1 / 3)}, {dunes, 1.4}, {ridges, 1.4}}) {
    SCOPED_TRACE(bed.height);
    Simulation run(channel_over(bed, "les-sph", false, "density = 1\n[[liquid]]\n"));
    while (run.method.time() < 2) run.steps(1, run.method.step_limit().dt);
    EXPECT_LT(run.series()["max_speed"], 1e-3);
    expect_to_bear(run, volume);
  }
}

TEST(PeriodicBeds, HoldStillWaterByGfd) {
  GfdRun run(channel_over(wavy_bed, "gfd", true, one_phase));
  run.until(0.5);
  EXPECT_LT(run.max_speed(), 1e-3);
  expect_to_bear(run, 1.4, -0.5 * 2);  // in the middle of the domain the pressure is none
}

TEST(PeriodicBeds, HoldStillWaterByWcsph) {
  WcsphRun run(channel_over(wavy_bed, "wcsph", false, one_phase));
  until(run, 0.5);
  EXPECT_LT(run.series()["max_speed"], 1e-3);
  expect_to_bear(run, 1.4);
}

}  // namespace spume::test
