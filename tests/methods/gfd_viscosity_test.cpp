// SPDX-License-Identifier: MIT
// Implicit viscosity of gfd: exact decay, explicit results in the limit of small steps, stability, what the plan says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "methods/gfd_run.hpp"

namespace spume::test {
namespace {

using std::numbers::pi;
const std::string implicitly = "time.viscosity=\"implicit\"", explicitly = "time.viscosity=\"explicit\"";

// A shear wave u = sin(2 pi y) at 20 particles a wave, in a box without sides.
std::string shear_wave(int dimensions) {
  const bool flat = dimensions == 2;
  const std::string text = R"toml(method = "gfd"
[domain]
lower = [0, 0@]
upper = [0.5, 1#]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.05
[[phase]]
name = "one"
density = 2
viscosity = 2
[[region]]
phase = "one"
velocity = ["1e-4*sin(2*pi*y)", "0"%]
[time]
end = 1
)toml";
  std::string made;
  for (const char c : text)
    if (c == '@' || c == '#' || c == '%')
      made += flat ? "" : c == '#' ? ", 0.5" : c == '%' ? ", \"0\"" : ", 0";
    else
      made += c;
  return flat ? made : replaced(made, "y = \"periodic\"", "y = \"periodic\"\nz = \"periodic\"");
}

double amplitude(const GfdRun& run) {
  double sum = 0;
  const gfd::Flow& f = run.flow();
  for (std::size_t i = 0; i < f.size(); ++i)
    sum += (*f.particles.velocity[0])[i] * std::sin(2 * pi * (*f.particles.position[1])[i]);
  return 2 * sum / static_cast<double>(f.size());
}

// What (9) makes of the wave on a lattice, over -k^2: 2 d sum W (1 - cos k y) / sum W r^2, Wendland's W.
double rate_on_a_lattice(int dimensions) {
  const double k = 2 * pi / 20;
  double sum = 0, squares = 0;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y)
      for (int z = dimensions == 3 ? -3 : 0; z <= (dimensions == 3 ? 3 : 0); ++z) {
        const double r2 = x * x + y * y + z * z, q = std::sqrt(r2) / 1.3;
        if (q >= 2) continue;
        const double w = std::pow(1 - q / 2, 4) * (2 * q + 1);
        sum += w * (1 - std::cos(k * y));
        squares += w * r2;
      }
  return 2 * dimensions * sum / squares / (k * k);
}

// Backward Euler takes the wave to 1 / (1 + gamma dt) of itself in a step, whatever its length: the rate that follows
// from the ratio is that of the lattice. The longest step is 250 of the explicit limit, 5e-4 of nu = 1. Residuals of
// 1e-4 of the change are the error of a step; by then the particles have moved by 1e-4 of the wave.
TEST(GfdViscosity, AShearWaveDecaysByBackwardEuler) {
  for (const int dimensions : {2, 3})
    for (const double dt : {5e-4, 0.005, 0.025, 0.125}) {
      GfdRun run(shear_wave(dimensions), {implicitly});
      const double first = amplitude(run);
      run.steps(2, dt);
      const double rate = (std::sqrt(first / amplitude(run)) - 1) / dt;
      EXPECT_NEAR(rate / (4 * pi * pi) / rate_on_a_lattice(dimensions), 1, 2e-4) << dimensions << "-D, dt " << dt;
    }
}

// The difference from a run of much shorter explicit steps falls with the step.
TEST(GfdViscosity, ConvergesToTheExplicitResultAtFirstOrder) {
  const auto speed = [](const std::string& kind, double dt) {
    GfdRun run(drop_in_a_box, {kind, "phase.0.viscosity=0.5", "phase.1.viscosity=5", "fluid.gravity=20",
                               "interface.surface_tension=10"});
    run.steps(static_cast<int>(std::lround(0.04 / dt)), dt);
    return run.series().at("velocity_drop_y");
  };
  const double exact = speed(explicitly, 1.25e-4);
  const double coarse = speed(implicitly, 4e-3) - exact, fine = speed(implicitly, 1e-3) - exact;
  EXPECT_LT(std::abs(fine), 0.02 * std::abs(exact));
  EXPECT_LT(std::abs(fine), std::abs(coarse) / 2.5);  // a quarter, and what the reference is off
}

// Steps of a hundred times the explicit limit at viscosities of 100:1: a flow that nothing drives loses energy in every
// step. At 100:1 split and laplacian gain some in steps of any kind: of rotation-free alone do the terms cancel.
TEST(GfdViscosity, LongStepsAreStableAtAHundredToOne) {
  for (const std::string form : {"split", "rotation-free", "mu-laplacian"}) {
    const std::string outside = form == "split" ? "20" : "1";
    const std::string vortices =
        R"v(["sin(pi*x)^2*sin(2*pi*y)+sin(3*pi*x)^2*sin(6*pi*y)", "-sin(2*pi*x)*sin(pi*y)^2-sin(6*pi*x)*sin(3*pi*y)^2"])v";
    GfdRun run(drop_in_a_box,
               {implicitly, "momentum.diffusion=\"" + form + "\"", "phase.0.viscosity=" + outside, "fluid.gravity=0",
                "phase.1.viscosity=100", "phase.1.density=1", "interface.surface_tension=0",
                "region.0.velocity=" + vortices, "region.1.velocity=" + vortices});
    const double viscous_limit = 0.2 * 0.05 * 0.05 / 100;
    double before = run.series().at("kinetic_energy");
    for (int k = 0; k < 20; ++k) {
      run.steps(1, 100 * viscous_limit);
      const double energy = run.series().at("kinetic_energy");
      EXPECT_LT(energy, before) << form << ", step " << k;
      before = energy;
    }
  }
}

// A drop at rest, a thousand times as dense as what is around it, in steps of ten times the explicit limit for two of
// its capillary times: the speeds that the scatter of the curvature makes die out below the capillary number that
// static_drop allows. A quarter of it, with planes of symmetry.
TEST(GfdViscosity, AHeavyDropRestsInImplicitSteps) {
  GfdRun run(drop_in_a_box, {implicitly, "domain.upper=[0.5,0.5]", "domain.bottom=\"free-slip\"",
                             "domain.top=\"free-slip\"", "resolution.spacing=0.03125", "fluid.gravity=0",
                             "phase.0.viscosity=0.1", "phase.1.density=1000", "region.1.centre=[0,0]", "time.end=8"});
  run.until(8);
  EXPECT_LT(run.method.step_count(), 500);
  EXPECT_LT(0.1 * run.series().at("max_speed"), 1e-3);
}

// Between a wall that holds the liquid and one that moves, with body walls as with sides: steady shear within a step or
// two of a hundred explicit limits.
TEST(GfdViscosity, ATurningTankTakesItsLiquidAlong) {
  GfdRun run(replaced(drop_in_a_turning_tank, "angle = \"90*t*t\"", "velocity = [\"-y\", \"x\"]"),
             {implicitly, "phase.0.viscosity=10", "phase.1.viscosity=100", "interface.surface_tension=0",
              "momentum.diffusion=\"rotation-free\""});
  const double viscous_limit = 0.2 * 0.05 * 0.05 / 10;
  run.steps(40, 100 * viscous_limit);
  const gfd::Flow& f = run.flow();
  double squares = 0;
  for (std::size_t i = 0; i < f.size(); ++i)
    squares += std::pow((*f.particles.velocity[0])[i] + (*f.particles.position[1])[i], 2) +
               std::pow((*f.particles.velocity[1])[i] - (*f.particles.position[0])[i], 2);
  // Of the speed of the wall, 0.5: a particle at a distance of half a spacing from the wall is off by a part of what
  // the fits behind it are, and turns with the next step.
  EXPECT_LT(std::sqrt(squares / static_cast<double>(f.size())), 0.01 * 0.5);
}

std::string reason(const std::string& text, const Overrides& overrides) {
  GfdRun run(text, overrides);
  for (const Stage& stage : run.method.plan())
    if (stage.name == "implicit viscosity") return (stage.on ? "on: " : "off: ") + stage.reason;
  return "";
}

// Without a word the scene decides: by gravity the drop falls at up to sqrt(2), which is courant's 0.2 x 0.065 /
// sqrt(2) = 9.2e-3; its tension of 1 allows 5.2e-3 or less. 0.2 x 0.05^2 / nu is a fifth of that for nu = 0.5.
TEST(GfdViscosity, TheSceneDecidesAndThePlanTells) {
  EXPECT_THAT(reason(drop_in_a_box, {}), testing::StartsWith("off: explicit: the viscous limit is 0.05, beside"));
  EXPECT_THAT(reason(drop_in_a_box, {"phase.0.viscosity=5"}),
              testing::AllOf(testing::StartsWith("on: (12) implicit: the viscous limit is 0.0001, far below"),
                             testing::HasSubstr("capillary")));
  EXPECT_THAT(reason(drop_in_a_box, {"phase.0.viscosity=5", "interface.surface_tension=0"}),
              testing::HasSubstr("courant, at the expected speed"));
  EXPECT_THAT(reason(drop_in_a_box, {"phase.0.viscosity=5", explicitly}), "off: time.viscosity = \"explicit\"");
  EXPECT_THAT(reason(drop_in_a_box, {implicitly}), "on: time.viscosity = \"implicit\"");
  EXPECT_THAT(reason(drop_in_a_box, {"phase.0.viscosity=0", "phase.1.viscosity=0", implicitly}), "off: inviscid");
  GfdRun run(drop_in_a_box, {"phase.0.viscosity=5"});
  EXPECT_NE(run.method.step_limit().limited_by, "viscous");
  GfdRun bound(drop_in_a_box, {"phase.0.viscosity=5", explicitly});
  EXPECT_EQ(bound.method.step_limit().limited_by, "viscous");
}

// The rim of the tank turns with pi at the end of the run, half a length from its axis: what decides on implicit steps
// expects that, where nothing else in the scene moves but by tension.
TEST(GfdViscosity, ExpectsTheSpeedOfGivenMotions) {
  const Overrides no_tension{"interface.surface_tension=0"};
  EXPECT_GE(GfdRun(drop_in_a_turning_tank, no_tension).flow().viscous.speed, M_PI * 0.5);
  Overrides slower = no_tension;
  slower.push_back("body.0.angle=\"9*t*t\"");
  EXPECT_NEAR(GfdRun(drop_in_a_turning_tank, slower).flow().viscous.speed,
              GfdRun(drop_in_a_turning_tank, no_tension).flow().viscous.speed / 10, 1e-6);
}

}  // namespace
}  // namespace spume::test
