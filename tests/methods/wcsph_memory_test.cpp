// SPDX-License-Identifier: MIT
// What a particle of wcsph takes without its lists.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

const std::string box = periodic_cube("wcsph", "0.05") + R"toml([compressibility]
shifting = "off"
[[phase]]
name = "liquid"
density = 1
viscosity = 0.001
[[region]]
phase = "liquid"
velocity = ["sin(2*pi*x)*cos(2*pi*y)", "-cos(2*pi*x)*sin(2*pi*y)", "0"]
[time]
end = 1
)toml";

TEST(WcsphMemory, OfOnePhaseIsWhatAStepNeeds) {
  WcsphRun run(box, {"resolution.spacing=0.02"});  // fewer images than half the particles
  while (run.method.flow().list_builds < 4) run.steps(1, run.method.step_limit().dt);
  std::map<std::string, double> bytes;
  for (const ArrayInfo& array : run.method.arrays()) bytes[array.name] = array.bytes;
  const auto n = static_cast<double>(run.method.flow().size());
  const auto images = static_cast<double>(run.method.flow().arrangement.images.size());
  const auto cells = static_cast<double>(run.method.flow().arrangement.grid.cell_count());
  EXPECT_FALSE(bytes.contains("phase"));
  // Where cells begin, and what a sort keeps of each slab; no number of a particle.
  EXPECT_LT(bytes["cell table"], 4 * (cells + 1) + 8192);
  // Places in double, sources and paths, with the quarter that arrays may grow by, and a table of cells.
  EXPECT_LT(bytes["images"], 1.25 * (24 + 4 + 4) * images + 4 * (cells + 1) + 8192);
  // Places and excesses in double, seven numbers in float; a sort borrows of them.
  EXPECT_LT(2 * images, n);
  EXPECT_LE(bytes["leased within a step"], (24 + 8 + 7 * 4) * n);
}

TEST(WcsphMemory, SnapshotsNumberTheOnePhaseThatHasNoNumbers) {
  WcsphRun run(box);
  run.steps(1, run.method.step_limit().dt);
  const ParticleSnapshot seen = run.method.snapshot()[0];
  const auto phase = std::find_if(seen.fields.begin(), seen.fields.end(),
                                  [](const ParticleField& field) { return field.name == "phase"; });
  ASSERT_NE(phase, seen.fields.end());
  ASSERT_EQ(phase->i64.size(), 1U);
  for (std::size_t i = 0; i < seen.size; ++i) ASSERT_EQ(phase->i64[0][i], 0);
}

}  // namespace
}  // namespace spume::test
