// SPDX-License-Identifier: MIT
// Scalars that the liquid of les-sph carries: exact solutions, amounts, bounds, state.
#include <gtest/gtest.h>

#include <numbers>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

using std::numbers::pi;

std::string with_scalar(const std::string& text, const std::string& initial, const std::string& more = "") {
  return text + "[[scalar]]\nname = \"dye\"\ninitial = \"" + initial + "\"\n" + more;
}

// A periodic square at rest.
const std::string still = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.025
[fluid]
reynolds = 100
[[liquid]]
[time]
end = 1
)toml";

struct Range {
  double least = 1e300, largest = -1e300;
};
Range range(const Scalars& scalars, std::size_t scalar = 0) {
  Range range;
  for (const double c : scalars.values(scalar)) {
    range.least = std::min(range.least, c);
    range.largest = std::max(range.largest, c);
  }
  return range;
}

// On a lattice at rest a sine is a mode of the pair sum: its rate is 4 pi^2 D but for the error of the sum, which is of
// second order, (k h)^2 / 8 at most for the Wendland kernel, whose fourth moment is 0.5 h^2 of the second; explicit
// steps add D k^2 dt / 2.
TEST(LesSphScalars, ASineModeDecaysAtItsRate) {
  Simulation run(with_scalar(still, "1 + sin(2*pi*x)", "diffusivity = 0.02\n"));
  const double dt = 0.01, rate = 0.02 * 4 * pi * pi, h = 1.3 * 0.025;
  run.steps(50, dt);
  const Range after = range(*run.method.flow().scalars);
  const double amplitude = (after.largest - after.least) / 2;
  const double first = range(*Simulation(with_scalar(still, "1 + sin(2*pi*x)")).method.flow().scalars).largest - 1;
  const double measured = -std::log(amplitude / first) / (50 * dt);
  EXPECT_NEAR(measured / rate, 1, std::pow(2 * pi * h, 2) / 8 + rate * dt);
}

// u . grad c = 0 for a function of the stream function, and cos cos is an eigenfunction of the Laplacian: exact in
// vortices that stir the particles. taylor_green holds 20 particles across: the velocity there is held to 4 %.
TEST(LesSphScalars, AScalarOnTheStreamlinesOfVorticesDecaysByDiffusionAlone) {
  Simulation run(with_scalar(taylor_green, "cos(2*pi*x)*cos(2*pi*y)", "diffusivity = 0.01\n"));
  while (run.method.time() < 0.5) run.steps(1, run.method.step_limit().dt);
  const les_sph::Flow& flow = run.method.flow();
  double error = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const Vec3 r = vector_at(flow.particles.position, 2, i);
    const double exact = std::exp(-8 * pi * pi * 0.01 * flow.time) * std::cos(2 * pi * r[0]) * std::cos(2 * pi * r[1]);
    error += std::pow(flow.scalars->values(0)[i] - exact, 2) / static_cast<double>(flow.size());
  }
  EXPECT_LT(std::sqrt(error), 0.04);
}

// Each step adds the rounding of n doubles and of their sum.
TEST(LesSphScalars, AmountsStayToTheRoundingOfDoublesAndNoValuePassesTheOthers) {
  for (const std::string& text : {taylor_green, taylor_green_3d, closed_box, dam_break, dam_break_3d}) {
    Simulation run(with_scalar(text, "x < 0.3 ? 1 : 0", "diffusivity = 0.01\nturbulent_schmidt = 0.5\n"),
                   {"turbulence.model=\"smagorinsky\""});
    const Scalars& scalars = *run.method.flow().scalars;
    const double before = run.series()["amount_of_dye"];
    EXPECT_GT(before, 0);
    constexpr int steps = 10;
    run.steps(steps, std::min(run.method.step_limit().dt, 0.005));
    EXPECT_NEAR(run.series()["amount_of_dye"] / before, 1, steps * 64 * std::numeric_limits<double>::epsilon());
    const Range after = range(scalars);
    EXPECT_GE(after.least, 0);
    EXPECT_LE(after.largest, 1 + 1e-6);  // values are floats beside the least one
    EXPECT_GT(run.method.snapshot()[0].fields.size(), 0U);
  }
}

TEST(LesSphScalars, DiffusionDividesTheStepInsteadOfLimitingIt) {
  Simulation plain(still), run(with_scalar(still, "x < 0.5 ? 1 : 0", "diffusivity = 1\n"));
  EXPECT_EQ(run.method.step_limit().dt, plain.method.step_limit().dt);
  run.steps(1, 0.01);
  EXPECT_GT(run.series()["scalar_substeps"], 10);
  const Range after = range(*run.method.flow().scalars);
  EXPECT_GE(after.least, 0);
  EXPECT_LE(after.largest, 1 + 1e-6);
}

TEST(LesSphScalars, FlowsAreTheSameBitsWithAndWithoutThem) {
  Simulation plain(dam_break), run(with_scalar(dam_break, "x", "diffusivity = 0.01\n"));
  plain.steps(5, 0.004);
  run.steps(5, 0.004);
  EXPECT_TRUE(plain.state() == run.state());
  EXPECT_EQ(plain.method.flow().scalars, nullptr);
}

TEST(LesSphScalars, ARestoredRunAndAnyNumberOfThreadsGiveTheSameBits) {
  const std::string text = with_scalar(taylor_green, "x", "diffusivity = 0.01\n");
  Simulation straight(text);
  straight.steps(3, 0.004);
  MemoryState saved;
  straight.method.save(saved);
  straight.steps(2, 0.004);
  const OneThread one;
  Simulation restored(text);
  restored.method.load(saved);
  restored.steps(2, 0.004);
  const Array<double>&a = straight.method.flow().scalars->values(0), &b = restored.method.flow().scalars->values(0);
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
}

}  // namespace
}  // namespace spume::test
