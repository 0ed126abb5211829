// SPDX-License-Identifier: MIT
// Surface tension of wcsph: the jump of the pressure, what it costs where a scene has none, and its momentum.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

// A drop in a periodic box, off the lattice.
const std::string periodic_drop = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.03125
[[phase]]
name = "outside"
density = 1
viscosity = 0.1
[[phase]]
name = "drop"
density = 1
viscosity = 0.1
[interface]
surface_tension = 1
[[region]]
phase = "outside"
[[region]]
phase = "drop"
centre = [0.487, 0.509]
radius = 0.25
[time]
end = 1
)toml";

// Means over the drop and over what surrounds it, more than 4 spacings from the interface.
double jump(const WcsphRun& run) {
  const wcsph::Flow& flow = run.method.flow();
  double sum[2]{}, count[2]{}, inside = 0;
  Vec3 centre{};
  for (std::size_t i = 0; i < flow.size(); ++i)
    if (flow.phase_of(i) == 1) {
      ++inside;
      for (int axis = 0; axis < 2; ++axis) centre[axis] += (*flow.particles.position[axis])[i];
    }
  for (double& x : centre) x /= inside;
  const double radius = std::sqrt(inside * flow.particles.volume / std::numbers::pi);
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double away =
        std::hypot((*flow.particles.position[0])[i] - centre[0], (*flow.particles.position[1])[i] - centre[1]) - radius;
    if (std::abs(away) < 4 * flow.scene.spacing) continue;
    const std::size_t side = away < 0 ? 1 : 0;
    sum[side] += flow.law(i).pressure((*flow.excess)[i]);
    ++count[side];
  }
  return (sum[1] / count[1] - sum[0] / count[0]) * radius;
}

// Heavier drops: cases/static_drop.
TEST(WcsphTension, ADropAtRestHasThePressureOfYoungAndLaplace) {
  WcsphRun run(periodic_drop);
  until(run, 0.3);
  EXPECT_NEAR(jump(run), 1, 0.02);
}

// The start adds the pressure of the interface: once, also where a run goes on from its first checkpoint.
TEST(WcsphTension, GoesOnBitForBitFromBeforeTheFirstStep) {
  WcsphRun first(periodic_drop), second(periodic_drop);
  first.prepare();
  EXPECT_NEAR(first.series()["surface_energy"], 2 * std::numbers::pi * 0.25, 0.05);
  MemoryState saved;
  first.method.save(saved);
  second.method.load(saved);
  for (WcsphRun* run : {&first, &second})
    for (int n = 0; n < 3; ++n) {
      Ledger ledger;
      run->method.step(1e-4, ledger);
    }
  EXPECT_EQ(first.saved_state(), second.saved_state());
}

TEST(WcsphTension, ItsEnergyIsThatOfTheCircle) {
  WcsphRun run(periodic_drop);
  run.steps(1, run.method.step_limit().dt);
  EXPECT_NEAR(run.series().at("surface_energy") / (2 * std::numbers::pi * 0.25), 1, 0.02);
}

TEST(WcsphTension, WithoutItNothingOfItExists) {
  const WcsphRun run(periodic_drop, {"interface.surface_tension=0", "compressibility.max_speed=1"});
  EXPECT_EQ(run.method.flow().tension, nullptr);
  for (const Stage& stage : run.method.plan())
    if (stage.name == "surface tension" || stage.name == "first tension") {
      EXPECT_FALSE(stage.on);
    }
  for (const ArrayInfo& array : run.method.arrays()) EXPECT_NE(array.name, "interfaces");
}

// sigma kappa n integrates to nothing over a closed interface, and to 2 pi sigma in modulus. The curvature is within
// 1 % (tests/operators/interface_test.cpp), and so is the sum over particles.
TEST(WcsphTension, MomentumInAPeriodicBoxStaysSmall) {
  WcsphRun run(periodic_drop);
  until(run, 0.2);
  const std::map<std::string, double> series = run.series();
  const double modulus = 2 * std::numbers::pi * run.method.time();
  for (const char* axis : {"x", "y"}) {
    const double inside = series.at(std::string("velocity_drop_") + axis),
                 outside = series.at(std::string("velocity_outside_") + axis);
    const double share = std::numbers::pi * 0.25 * 0.25;
    EXPECT_LT(std::abs(share * inside + (1 - share) * outside), 0.01 * modulus);
  }
}

}  // namespace
}  // namespace spume::test
