// SPDX-License-Identifier: MIT
// What keeps a run from going wrong without a word: stable explicit diffusion, walls that the step knows, energy that
// cannot appear, a start within the method's validity.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

using testing::HasSubstr;

const std::string still_pool = R"(
method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 5
froude = 1
[[liquid]]
upper = [1, 0.5]
[initial]
jitter = 0.1
[time]
end = 1
)";

void advance(Simulation& run, int steps) {
  for (int k = 0; k < steps; ++k) run.steps(1, run.method.step_limit().dt);
}

// The largest speed of any step until `end`.
double fastest_until(Simulation& run, double end) {
  double fastest = 0;
  while (run.method.time() < end) {
    advance(run, 1);
    fastest = std::max(fastest, run.series()["max_speed"]);
  }
  return fastest;
}

// div(2 nu S) by explicit steps of 0.2 h^2 / nu, beyond its limit of 0.11, made a speed of order one within 40 steps.
TEST(LesSphStability, AViscousPoolStaysAtRestWithTheStepsThatItAllows) {
  Simulation run(still_pool);
  ASSERT_EQ(run.method.step_limit().limited_by, "viscous");
  advance(run, 80);
  EXPECT_LT(run.series()["max_speed"], 0.05);  // a twentieth of sqrt(g h): what the jitter relaxes with
}

TEST(LesSphStability, TheStepLimitKnowsTheSpeedOfAMovingWall) {
  Simulation run(cavity, {"domain.wall_velocity.top=[\"2\", \"0\"]", "fluid.reynolds=1e4"});
  advance(run, 1);
  const StepLimit limit = run.method.step_limit();
  EXPECT_EQ(limit.limited_by, "courant");
  EXPECT_LE(limit.dt, 0.2 * 1.3 * 0.05 / 2 * (1 + 1e-6));
  advance(run, 40);
  EXPECT_LT(run.series()["max_speed"], 2.5);  // the lid drags; nothing is faster but for the noise of the corners
}

TEST(LesSphStability, EnergyFromNothingIsRefused) {
  Simulation run(taylor_green);
  run.steps(1, 0.005);
  const double kinetic = run.series()["kinetic_energy"];
  les_sph::Flow& flow = const_cast<les_sph::Flow&>(run.method.flow());
  for (int axis = 0; axis < 2; ++axis)
    for (double& u : *flow.particles.velocity[axis]) u *= 1.3;
  EXPECT_NO_THROW(run.steps(1, 0.001));  // 1.69 times the energy: below twice the supply
  for (int axis = 0; axis < 2; ++axis)
    for (double& u : *flow.particles.velocity[axis]) u *= 1.3;
  try {
    run.steps(1, 0.001);
    FAIL() << "energy grew from " << kinetic << " to " << run.series()["kinetic_energy"];
  } catch (const StepFailure& failure) {
    EXPECT_THAT(failure.details().cause, HasSubstr("kinetic energy"));
    EXPECT_GE(failure.details().particle, 0);
  }
}

// What the method says against the vortices with one more option; "" when it takes them.
std::string refusal_of(const std::string& option, std::vector<std::string> others = {}) {
  others.push_back(option);
  try {
    Simulation run(taylor_green, others);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LesSphStability, AStartNearTheSoundSpeedIsRefusedInWords) {
  EXPECT_EQ(refusal_of("fluid.mach=0.3"), "");
  EXPECT_THAT(refusal_of("fluid.mach=0.8"), HasSubstr("of the sound speed 1.25"));
}

TEST(LesSphStability, AShiftThatWouldStirTheParticlesIsRefused) {
  EXPECT_EQ(refusal_of("shifting.coefficient=0.41"), "");
  EXPECT_THAT(refusal_of("shifting.coefficient=0.42"), HasSubstr("shifting.coefficient is 0.42; above 0.416"));
  // What neighbours share of the shift stays in it where it is not taken off, and in full tanks with a body that moves.
  EXPECT_THAT(refusal_of("shifting.remove_drift=false", {"shifting.coefficient=0.36"}), HasSubstr("above 0.349"));
  const auto in_a_full_tank = [](const std::string& coefficient) {
    const std::string tank =
        "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nleft = \"no-slip\"\nright = \"no-slip\"\n"
        "bottom = \"no-slip\"\ntop = \"no-slip\"\n[resolution]\nspacing = 0.05\n[fluid]\nreynolds = 100\n[[liquid]]\n"
        "[[body]]\nshape = \"box\"\nsize = [0.3, 0.3]\nposition = [0.5, 0.5]\nangle = \"90*t\"\n[time]\nend = 1\n";
    try {
      Simulation run(tank, {"shifting.coefficient=" + coefficient, "shifting.remove_drift=true"});
      run.steps(1, 1e-3);
      std::string texts;
      for (const Remark& one : run.method.take_remarks()) texts += one.text;
      return texts;
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_THAT(in_a_full_tank("0.36"), HasSubstr("above 0.349"));
  EXPECT_THAT(in_a_full_tank("0.25"), HasSubstr("shifting.remove_drift = true has no effect"));
}

// Shifts in proportion to the step would pass what a lattice stands at courant 0.34: this wave gained a quarter of its
// kinetic energy from them, against 0.05 at any shift below, which its 50 particles a wavelength leave.
TEST(LesSphStability, LongStepsDoNotStirAWave) {
  const std::string wave = wave_tank + R"toml([[liquid]]
where = "0.0525*cos(2*pi*x) + 0.0087*cos(4*pi*x) - y"
velocity = ["0.139*cos(2*pi*x)*exp(2*pi*y)", "0.139*sin(2*pi*x)*exp(2*pi*y)"]
conform = true
[time]
end = 2
courant = 0.4
)toml";
  Simulation run(wave);
  const double start = run.series()["total_energy"], kinetic = run.series()["kinetic_energy"];
  double largest = start;
  while (run.method.time() < 1.5) {
    advance(run, 1);
    largest = std::max(largest, run.series()["total_energy"]);
  }
  EXPECT_LT(largest - start, 0.1 * kinetic);
}

// Nearly uniform flow: Germano's identity divides rounding by rounding.
TEST(LesSphStability, DynamicClosuresStartInAFlowThatHardlyShears) {
  for (const char* model : {"dynamic-shepard", "dynamic-lagrangian"}) {
    Simulation run(taylor_green, {std::string("turbulence.model=\"") + model + "\"", "fluid.reynolds=1e6",
                                  "liquid.0.velocity=[\"1+1e-5*sin(2*pi*y)\", \"0\"]"});
    EXPECT_NO_THROW(advance(run, 3)) << model;
    EXPECT_LT(run.method.flow().max_eddy_viscosity, 1e-4) << model;  // C_s = 0.5: 0.25 Delta^2 |S| is below 1e-6
  }
}

// Where backscatter cancels the viscosity, rounding to float left diffusivities of either sign, whose harmonic mean is
// unbounded: accelerations of 1e7 in the first step.
TEST(LesSphStability, BackscatterThatCancelsTheViscosityAcceleratesNobody) {
  Simulation run(taylor_green, {"turbulence.model=\"dynamic-shepard\"", "fluid.reynolds=43489.75",
                                "initial.jitter=0.25", "resolution.smoothing_ratio=1.5"});
  const double before = run.series()["max_speed"];
  advance(run, 2);
  EXPECT_LT(run.series()["max_speed"], 1.2 * before);
}

// A column of liquid runs out into the edge of two no-slip walls. Rates of volume that knew their friction, which the
// pressure gradient does not, made its tip twice as fast as it can fall within 20 steps.
TEST(LesSphStability, LiquidInAnEdgeOfNoSlipWallsIsNoFasterThanItFalls) {
  Overrides no_slip;
  for (const char* side : {"left", "right", "front", "back", "bottom"})
    no_slip.push_back("domain." + std::string(side) + "=\"no-slip\"");
  Simulation run(dam_break_3d, no_slip);
  const double fastest = fastest_until(run, 0.8);
  // A dry front runs at 2 sqrt(g H).
  EXPECT_LT(fastest, 2 * std::sqrt(0.8));
  EXPECT_GT(fastest, 0.5);
}

// Particles that approach a wall closely are carried away from it by the shift; their speed must not grow by that.
TEST(LesSphStability, ShiftsAwayFromAWallGiveNoSpeed) {
  Simulation run(cavity, {"fluid.reynolds=1000", "resolution.spacing=0.025"});
  const double fastest = fastest_until(run, 1.5);
  EXPECT_LT(fastest, 1);  // nobody is faster than the lid
  EXPECT_GT(fastest, 0.5);
}

// A jet one particle thick leaves the lid along the wall and opens a void beside it. Where neighbours are missing the
// correction of the pressure gradient exceeded 2, of which the matrix of the pressure knows nothing: the projection
// threw the particles to a speed of 88 by t = 2.2.
TEST(LesSphStability, AVoidInAClosedLiquidGainsNoEnergy) {
  Simulation run(cavity, {"fluid.reynolds=3200"});
  const double fastest = fastest_until(run, 3);
  EXPECT_LT(fastest, 1);  // nobody is faster than the lid
  EXPECT_GT(fastest, 0.3);
}

// A cavity whose walls are a body: its jet opens voids along the right wall. Fits there that amplified what particles
// carry, and a gradient that did not fade, gave 90 times the speed of the lid at t = 0.66 and 300 times at t = 0.76.
TEST(LesSphStability, TheJetInACavityOfABodyIsNoFasterThanItsLid) {
  for (const auto& [reynolds, end] : {std::pair("1000", 1.2), std::pair("3200", 2.0)}) {
    Simulation run(
        replaced(replaced(cavity, "lower = [0, 0]\nupper = [1, 1]", "lower = [-0.15, -0.15]\nupper = [1.15, 1.15]"),
                 "[domain.wall_velocity]\ntop = [\"1\", \"0\"]\n", "") +
            "[[body]]\nshape = \"box\"\nsize = [1, 1]\nposition = [0.5, 0.5]\ninside = false\nwall = "
            "\"no-slip\"\nvelocity = [\"y > 0.9999\", \"0\"]\n",
        {"resolution.spacing=0.025", std::string("fluid.reynolds=") + reynolds});
    EXPECT_LT(fastest_until(run, end), 1.5) << "Re = " << reynolds;
  }
}

// Between two pistons that hold it, of one speed, liquid moves with them. The projection is approximate, and leaves a
// twentieth of what remains every ten steps: 1e-4 of the speed after fifty, as between pistons that slip.
TEST(LesSphStability, PistonsOfNoSlipPushTheLiquid) {
  Simulation run(R"(
method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 0.5]
left = "no-slip"
right = "no-slip"
y = "periodic"
[domain.wall_velocity]
left = ["0.1", "0"]
right = ["0.1", "0"]
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
[[liquid]]
[time]
end = 1
)");
  run.steps(50, 0.01);
  for (const Vec3& u : run.state().velocity) {
    EXPECT_NEAR(u[0], 0.1, 2e-5);
    EXPECT_NEAR(u[1], 0, 1e-6);
  }
}

// A force that varies in space and rises from nothing at rest: nothing but the force limits the step, which grew from
// 5e-5 to 0.05 at once. Twice the step before, and never further than the force drives over a smoothing length.
TEST(LesSphStability, AForceThatSetsInLimitsTheStep) {
  Simulation run(taylor_green, {"liquid.0.velocity=[\"0\", \"0\"]",
                                "forces.body=[\"10*t*sin(2*pi*x)*cos(2*pi*y)\", \"-10*t*cos(2*pi*x)*sin(2*pi*y)\"]"});
  const double h = run.method.flow().resolution.smoothing_length, courant = run.loaded.options.time.courant;
  double last = run.method.step_limit().dt;
  for (int k = 0; k < 30; ++k) {
    run.steps(1, last);
    const double next = run.method.step_limit().dt;
    EXPECT_LE(next, 2 * last * (1 + 1e-12));
    // Particles are within half a spacing of the most forced point: cos(2 pi dr / 2)^2 = 0.976 of 10 t.
    EXPECT_LE(next, courant * std::sqrt(h / (9.76 * run.method.time())));
    last = next;
  }
}

// A particle in free flight may be faster than the liquid; refused for it, every step was computed twice.
TEST(LesSphStability, TheStepLimitKnowsTheFastestSpray) {
  Simulation run(still_pool + "[[liquid]]\nlower = [0.5, 0.8]\nupper = [0.55, 0.85]\nvelocity = [\"0\", \"8\"]\n",
                 {"fluid.reynolds=1e5", "liquid.1.velocity=[\"8\", \"0\"]"});
  run.steps(1, 0.001);
  for (int k = 0; k < 5; ++k) {
    const StepLimit limit = run.method.step_limit();
    EXPECT_EQ(limit.limited_by, "spray");
    EXPECT_NO_THROW(run.steps(1, limit.dt));
  }
}

// A slab that falls 0.2 m and runs out over the floor: what splashes meets the floor with 2 m/s and leaves with no more
// than twice as much. Spray that met the floor kept its speed and fell on, where it lay: 8.6 m/s in the end.
TEST(LesSphStability, SprayThatMeetsAWallStops) {
  Simulation run(
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [3, 0.9]\nbottom = \"free-slip\"\n[resolution]\nspacing "
      "= "
      "0.02\n[fluid]\ndensity = 998\nviscosity = 1e-6\ngravity = 9.81\nsound_speed = 40\n[[liquid]]\nlower = [1.2, "
      "0.2]\nupper = [1.6, 0.24]\n[time]\nend = 1\n");
  while (run.method.time() < 0.8) {
    run.steps(1, run.method.step_limit().dt);
    ASSERT_LT(run.series()["max_speed"], 2 * std::sqrt(2 * 9.81 * 0.24));
  }
}

std::string cause_of_failure(Simulation& run, StepFailure::Details& details) {
  try {
    run.steps(1, 0.005);
  } catch (const StepFailure& failure) {
    details = failure.details();
  }
  return details.cause;
}

TEST(LesSphStability, AForceOrAWallThatIsNoNumberIsNamed) {
  StepFailure::Details details;
  Simulation forced(still_pool, {"forces.body=[\"0\", \"y<0.3 ? 0 : sqrt(0-1)\"]"});
  EXPECT_THAT(cause_of_failure(forced, details), HasSubstr("body force is not a finite number"));
  EXPECT_GE(details.particle, 0);
  EXPECT_GE(details.position[1], 0.3);
  EXPECT_EQ(details.option, "forces.body");
  Simulation driven(cavity, {"domain.wall_velocity.top=[\"sqrt(0-1)\", \"0\"]"});
  EXPECT_THAT(cause_of_failure(driven, details), HasSubstr("velocity of a wall is not a finite number"));
}

// The closure does not depend on the frame: the same eddies between walls at rest and between walls that move along.
// Velocities of images enter its products; those of the sources, in their place, made an error of the moving frame's
// velocity times a change over h.
TEST(LesSphStability, DynamicClosuresDoNotDependOnTheFrame) {
  const auto eddy_viscosity =
      [](const std::string& model, double frame) {
        const std::string u = std::to_string(frame);
        Simulation run(R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
bottom = "no-slip"
top = "no-slip"
[domain.wall_velocity]
bottom = [")toml" + u + R"toml(", "0"]
top = [")toml" + u + R"toml(", "0"]
[resolution]
spacing = 0.05
[fluid]
reynolds = 1e5
[[liquid]]
velocity = [")toml" + u +
                       R"toml( + sin(2*pi*y)*cos(2*pi*x)", "-cos(2*pi*y)*sin(2*pi*x)"]
[turbulence]
model = ")toml" + model +
                       R"toml("
[time]
end = 1
)toml");
        run.steps(1, 1e-5);
        std::vector<double> by_identifier(run.method.flow().size());
        for (std::size_t i = 0; i < by_identifier.size(); ++i)
          by_identifier[static_cast<std::size_t>((*run.method.flow().particles.identifier)[i])] =
              run.method.flow().eddy_viscosity_of(i);
        return by_identifier;
      };
  for (const std::string model : {"dynamic-shepard", "dynamic-lagrangian"}) {
    const auto at_rest = eddy_viscosity(model, 0), moving = eddy_viscosity(model, 5);
    const double largest = *std::max_element(at_rest.begin(), at_rest.end());
    ASSERT_GT(largest, 0);
    // Filtered velocities are floats of 5: 5e-7 beside changes of 0.4 over h.
    for (std::size_t i = 0; i < at_rest.size(); ++i) EXPECT_NEAR(moving[i], at_rest[i], 1e-3 * largest) << model << i;
  }
}

}  // namespace
// The same of water let go in a narrow tank, which had 1.06 times its energy at t = 0.44.
TEST(LesSphStability, WaterLetGoBetweenNoSlipWallsGainsNoEnergy) {
  Simulation run(
      "method = \"les-sph\"\n[domain]\nlower = [0, 0, 0]\nupper = [0.9, 0.124, 0.5]\nleft = \"no-slip\"\n"
      "right = \"no-slip\"\nfront = \"no-slip\"\nback = \"no-slip\"\nbottom = \"no-slip\"\n[resolution]\n"
      "spacing = 0.0155\n[fluid]\ndensity = 990\nviscosity = 1e-6\ngravity = 9.81\n[[liquid]]\n"
      "upper = [0.3, 0.124, 0.24]\n[time]\nend = 0.45\n");
  run.steps(1, 1e-6);
  const double before = run.series()["total_energy"];
  double most = before, kinetic = 0;
  while (run.method.time() < 0.45) {
    run.steps(1, run.method.step_limit().dt);
    const auto row = run.series();
    most = std::max(most, row.at("total_energy"));
    kinetic = std::max(kinetic, row.at("kinetic_energy"));
  }
  EXPECT_LT(most - before, 0.01 * kinetic);  // the bound of the verdict
}

}  // namespace spume::test
