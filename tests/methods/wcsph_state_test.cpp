// SPDX-License-Identifier: MIT
// wcsph between steps: saved and restored to the bit, untouched by a refused step, the same for any number of threads;
// what it conserves, and what its plan says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <numbers>

#include "methods/uncounted_stages.hpp"
#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

using testing::HasSubstr;
// Water that falls in a tank of air, with walls of both kinds, one of which slides.
const std::string column_in_air = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [2, 1]
left = "free-slip"
right = "free-slip"
bottom = "no-slip"
top = "no-slip"
[domain.wall_velocity]
top = ["0.1*sin(t)", "0"]
[resolution]
spacing = 0.05
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1000
viscosity = 1
[[phase]]
name = "air"
density = 1
viscosity = 0.01
[[region]]
phase = "air"
[[region]]
phase = "water"
upper = [0.5, 0.5]
[compressibility]
max_speed = 1.5
[time]
end = 1
)toml";

const std::string ball_in_stream = periodic_cube("wcsph", "0.0833333333333333333") + R"toml([[phase]]
name = "outside"
density = 1
viscosity = 0.05
[[phase]]
name = "ball"
density = 20
viscosity = 0.5
[[region]]
phase = "outside"
velocity = ["sin(2*pi*y)", "0", "0.1"]
[[region]]
phase = "ball"
centre = [0.5, 0.5, 0.5]
radius = 0.3
[time]
end = 1
)toml";

const std::string periodic_vortices = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.03125
[[phase]]
name = "liquid"
density = 1
viscosity = 0.05
[[region]]
phase = "liquid"
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
[time]
end = 1
)toml";

// A no-slip paddle that turns across the surface of water, beside a wedge.
const std::string paddle = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
[resolution]
spacing = 0.05
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1000
viscosity = 1
[[phase]]
name = "air"
density = 1
viscosity = 0.01
[[body]]
shape = "box"
size = [0.16, 0.4]
position = [0.5, 0.6]
wall = "no-slip"
angle = "40*sin(6*t)"
[[body]]
shape = "outline"
points = [[0.1, -0.1], [0.3, 0.2], [0.5, -0.1]]
[[region]]
phase = "air"
[[region]]
phase = "water"
upper = [1, 0.6]
[compressibility]
max_speed = 1.5
[time]
end = 1
)toml";

// Discs that grow in water with a free surface, one after another, rise and are taken away.
const std::string bubbles = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
bottom = "no-slip"
[resolution]
spacing = 0.05
[fluid]
froude = 1
[[phase]]
name = "water"
density = 1
viscosity = 0.001
[[region]]
phase = "water"
upper = [1, 0.6]
[[body]]
shape = "ball"
radius = 0.1
position = [0.93, 0.25]
displacement = ["0.1*t", "0.5*t"]
release_interval = 0.3
release_duration = 0.7
release_growth = 0.5
[time]
end = 1
)toml";

// A drop between a wall and a mirror, four times as dense as what surrounds it.
const std::string drop = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
left = "free-slip"
right = "free-slip"
y = "periodic"
[resolution]
spacing = 0.05
[[phase]]
name = "outside"
density = 1
viscosity = 0.05
[[phase]]
name = "drop"
density = 4
viscosity = 0.1
[interface]
surface_tension = 1
[[region]]
phase = "outside"
[[region]]
phase = "drop"
centre = [0.4, 0.5]
radius = 0.3
[time]
end = 1
)toml";

class WcsphState : public ::testing::TestWithParam<std::string> {};

// Saved between two builds of the lists: the order of the neighbours must come back too.
TEST_P(WcsphState, ARestoredRunContinuesToTheSameBits) {
  for (const Overrides& set :
       {Overrides{}, Overrides{"compressibility.density_filter=\"shepard\"", "compressibility.filter_interval=3"}}) {
    WcsphRun straight(GetParam(), set);
    straight.steps(1, straight.method.step_limit().dt);
    const double dt = 0.8 * straight.method.step_limit().dt;
    std::int64_t builds = straight.method.flow().list_builds;
    while (straight.method.flow().list_builds < builds + 2) straight.steps(1, dt);
    straight.steps(1, dt);
    builds = straight.method.flow().list_builds;
    MemoryState saved;
    straight.method.save(saved);
    straight.steps(1, dt);
    EXPECT_EQ(straight.method.flow().list_builds, builds) << "the test wants a step on old lists";
    straight.steps(20, dt);
    WcsphRun restored(GetParam(), set);
    restored.method.load(saved);
    restored.series();  // who looks at a state does not change it
    restored.steps(21, dt);
    EXPECT_EQ(restored.method.time(), straight.method.time());
    EXPECT_EQ(restored.saved_state(), straight.saved_state());
    EXPECT_EQ(restored.method.step_limit().dt, straight.method.step_limit().dt);
    EXPECT_EQ(restored.series(), straight.series());
  }
}

TEST_P(WcsphState, DoesNotDependOnTheNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<std::map<std::string, std::vector<double>>> states;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    WcsphRun run(GetParam());
    run.steps(15, 0.7 * run.method.step_limit().dt);
    states.push_back(run.saved_state());
  }
  omp_set_num_threads(before);
  EXPECT_EQ(states[0], states[1]);
  EXPECT_EQ(states[0], states[2]);
}

// A step so long that particles leave their lists.
TEST_P(WcsphState, ARefusedStepLeavesIt) {
  WcsphRun run(GetParam());
  const double dt = 0.7 * run.method.step_limit().dt;
  run.steps(5, dt);
  const auto before = run.saved_state();
  EXPECT_THROW(run.steps(1, 1e4 * dt), StepFailure);
  const auto after = run.saved_state();
  for (const char* name : {"velocity_x", "velocity_y", "acceleration_x", "density_excess", "scalars"})
    EXPECT_EQ(after.at(name), before.at(name)) << name;
  run.steps(1, dt);
}

// Liquid without viscosity that runs together with the speed of its sound, until its density would rise by more than
// half, which is seen when the forces have been found.
TEST(WcsphState, NothingOfARefusedStepIsInTheNext) {
  const std::string text = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.05
[[phase]]
name = "water"
density = 1000
viscosity = 0
[[region]]
phase = "water"
velocity = ["x < 0.5 ? 1 : -1", "0"]
[compressibility]
max_speed = 0.1
shifting = "off"
[time]
end = 1
)toml";
  WcsphRun refused(text), other(text);
  const double dt = 0.5 * other.method.step_limit().dt;
  std::string cause;
  int steps = 0;
  for (; steps < 100 && cause.empty(); ++steps) {
    try {
      refused.steps(1, dt);
    } catch (const StepFailure& failure) {
      cause = failure.details().cause;
    }
  }
  ASSERT_THAT(cause, HasSubstr("the density has changed"));
  refused.steps(1, 0.1 * dt);
  other.steps(steps - 1, dt);
  other.steps(1, 0.1 * dt);
  // Lists made anew for the refused step have another order: sums in float of some twenty terms.
  const auto after = refused.saved_state(), expected = other.saved_state();
  for (const char* name : {"velocity_x", "acceleration_x", "density_excess"}) {
    double largest = 0, worst = 0;
    for (std::size_t i = 0; i < expected.at(name).size(); ++i) {
      largest = std::max(largest, std::abs(expected.at(name)[i]));
      worst = std::max(worst, std::abs(after.at(name)[i] - expected.at(name)[i]));
    }
    EXPECT_GT(largest, 0) << name;
    EXPECT_LT(worst, 20 * 0x1p-24 * largest) << name;
  }
}

// Water that settles around a disc before the floor drags it.
const std::string water_at_rest = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
bottom = "no-slip"
[domain.wall_velocity]
bottom = ["1", "0"]
[resolution]
spacing = 0.05
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1
viscosity = 0.05
[[region]]
phase = "water"
upper = [1, 0.8]
[[body]]
shape = "ball"
position = [0.5, 0.3]
radius = 0.17
[time]
end = 1
)toml";

std::string name_of_case(const ::testing::TestParamInfo<std::string>& info) {
  const char* const names[] = {"Column2D", "Ball3D", "Vortices2D", "Paddle2D", "Bubbles2D", "Drop2D", "AtRest2D"};
  return names[info.index];
}

INSTANTIATE_TEST_SUITE_P(Cases, WcsphState,
                         ::testing::Values(column_in_air, ball_in_stream, periodic_vortices, paddle, bubbles, drop,
                                           water_at_rest),
                         name_of_case);

TEST(WcsphAllocations, ASteadyRunAllocatesNothing) {
  const OneThread alone;
  for (const std::string& text : {column_in_air, ball_in_stream, periodic_vortices, drop}) {
    WcsphRun run(text);
    const double dt = 0.7 * run.method.step_limit().dt;
    run.steps(40, dt);
    const auto before = array_statistics();
    run.steps(5, dt);
    EXPECT_EQ(array_statistics().allocations, before.allocations) << text;
  }
}

// Forces are antisymmetric: what is left is the rounding of float sums of some eighty terms, about 80 2^-24 = 5e-6 of
// their moduli, which are several times the force that they leave.
TEST(WcsphConservation, MomentumStaysInAPeriodicBox) {
  WcsphRun run(ball_in_stream);
  const auto momentum = [&] {
    const wcsph::Flow& flow = run.method.flow();
    Vec3 sum{};
    for (std::size_t i = 0; i < flow.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) sum[axis] += flow.mass(i) * (*flow.particles.velocity[axis])[i];
    return sum;
  };
  const Vec3 before = momentum();
  const double ball_before = run.series().at("velocity_ball_z");
  until(run, 0.05);
  EXPECT_GT(std::abs(run.series().at("velocity_ball_z") - ball_before), 1e-5) << "the phases exchange momentum";
  const Vec3 after = momentum();
  const wcsph::Flow& flow = run.method.flow();
  for (int axis = 0; axis < 3; ++axis) {
    double impulse = 0;
    for (std::size_t i = 0; i < flow.size(); ++i)
      impulse += flow.mass(i) * std::abs((*flow.acceleration[axis])[i]) * run.method.time();
    EXPECT_LT(std::abs(after[axis] - before[axis]), 5e-5 * impulse);
  }
}

// u = sin(k y), k = 2 pi: the kinetic energy decays as exp(-2 k^2 nu t), with the k^2 that the sum of Morris gives on a
// lattice, sum_j 2 g (1 - cos k d_y). Kernel gradients are such that sum_j g d^2 = 2, with which this is k^2 to second
// order in k h = 0.26; without, it is 2.6 % below. The lattice shears by k t, which changes its even sums by the square
// of that.
TEST(WcsphAccuracy, AShearWaveDecaysAtTheExactRateOfALongWave) {
  WcsphRun run(replaced(periodic_vortices, "velocity = [\"-cos(2*pi*x)*sin(2*pi*y)\", \"sin(2*pi*x)*cos(2*pi*y)\"]",
                        "velocity = [\"sin(2*pi*y)\", \"0\"]"));
  const double spacing = 1.0 / 32, h = 1.3 * spacing, k = 2 * std::numbers::pi, nu = 0.05;
  double k2 = 0, second_moment = 0;
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j) {
      const double d = std::hypot(i, j) * spacing;
      const double g = -spacing * spacing * WendlandC2::normalisation(2) / std::pow(h, 4) * WendlandC2::f(d / h);
      k2 += 2 * g * (1 - std::cos(k * j * spacing));
      second_moment += g * d * d;
    }
  EXPECT_NEAR(second_moment, 1.948, 1e-3);
  k2 *= 2 / second_moment;
  EXPECT_NEAR(k2 / (k * k), 1, std::pow(k * h, 2) / 10);
  const double first = run.series().at("kinetic_energy");
  const double end = 0.01;
  until(run, end);
  const double rate = std::log(first / run.series().at("kinetic_energy")) / end;
  EXPECT_NEAR(rate / (2 * k2 * nu), 1, std::pow(k * end, 2));
}

// Vortices stretch the lattice that they begin on, which must not resist: cases/taylor_green_wcsph, whose bound of 2 %
// with 64 particles per side is 8 % with 32 at second order. Without shifting the rate is three times too high.
TEST(WcsphAccuracy, VorticesDecayAtTheExactRate) {
  WcsphRun run(replaced(periodic_vortices, "viscosity = 0.05", "viscosity = 0.01"));
  double t_sum = 0, log_sum = 0, t2_sum = 0, product = 0;
  const int samples = 50;
  for (int n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n) / samples, energy = std::log(run.series().at("kinetic_energy"));
    t_sum += t;
    log_sum += energy;
    t2_sum += t * t;
    product += t * energy;
    until(run, static_cast<double>(n + 1) / samples);
  }
  const double slope = (samples * product - t_sum * log_sum) / (samples * t2_sum - t_sum * t_sum);
  EXPECT_NEAR(-slope / (16 * std::numbers::pi * std::numbers::pi * 0.01), 1, 0.08);
  // The flux that goes with the shift is antisymmetric: what is left is rounding, of the speed 1.
  EXPECT_LT(std::abs(run.series().at("velocity_liquid_x")), 1e-6);
  EXPECT_LT(std::abs(run.series().at("velocity_liquid_y")), 1e-6);
}

TEST(WcsphPlan, ShiftingIsForOnePhaseOrTensionWithoutASurface) {
  const auto shifts = [](const std::string& text, const Overrides& set = {}) {
    return WcsphRun(text, set).method.flow().features.shifting;
  };
  EXPECT_TRUE(shifts(periodic_vortices));
  EXPECT_FALSE(shifts(periodic_vortices, {"compressibility.shifting=\"off\""}));
  EXPECT_FALSE(shifts(column_in_air));
  EXPECT_FALSE(shifts(ball_in_stream));
  EXPECT_TRUE(shifts(drop));
  EXPECT_TRUE(shifts(ball_in_stream, {"compressibility.shifting=\"on\""}));
}

TEST(WcsphPlan, EveryStageCountsItsTraffic) {
  const Overrides shepard{"compressibility.density_filter=\"shepard\"", "compressibility.filter_interval=2"};
  for (const std::string& text : {column_in_air, periodic_vortices, paddle, bubbles, drop})
    for (const Overrides& set : {Overrides{}, shepard}) {
      WcsphRun run(text, set);
      run.steps(4, 0.5 * run.method.step_limit().dt);
      EXPECT_EQ(uncounted_stages(run.method, run.ledger), "");
    }
}

// Equal stiffness makes sound 14 times as fast in air as in water.
TEST(WcsphPlan, SoundFollowsTheExpectedSpeedAndIsSaid) {
  const WcsphRun run(column_in_air);
  EXPECT_NEAR(run.method.flow().laws[0].sound_speed, 15, 1e-12);
  EXPECT_NEAR(run.method.flow().laws[1].sound_speed, 15 * std::sqrt(1.4 * 1000 / 7), 1e-9);
  std::string said;
  for (const Stage& stage : run.method.plan()) said += stage.reason + "\n";
  EXPECT_THAT(said, HasSubstr("sound in water 15 m/s (exponent 7)"));
  const WcsphRun given(column_in_air, {"phase.1.sound_speed=50", "phase.0.exponent=1"});
  EXPECT_EQ(given.method.flow().laws[1].sound_speed, 50);
  EXPECT_EQ(given.method.flow().laws[0].exponent, 1);
}

std::string refused(const std::string& text, const Overrides& overrides = {}) {
  try {
    WcsphRun run(text, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

// The step asks few particles of the gas for the power in their sound speed; the sum that limits it is the largest of
// all.
TEST(WcsphStep, IsLimitedByTheLargestSignalOfAllParticles) {
  WcsphRun run(column_in_air);
  for (int k = 0; k < 30; ++k) {
    run.steps(1, run.method.step_limit().dt);
    const wcsph::Flow& flow = run.method.flow();
    double largest = 0;
    for (std::size_t i = 0; i < flow.size(); ++i)
      largest = std::max(
          largest, flow.law(i).local_sound_speed((*flow.excess)[i]) + length(vector_at(flow.particles.velocity, 2, i)));
    ASSERT_NEAR(flow.signal / largest, 1, 1e-12) << k;
  }
}

TEST(WcsphCases, WhatItCannotDoIsRefusedWithTheFix) {
  EXPECT_THAT(refused(column_in_air, {"resolution.kernel=\"quintic-spline\""}), HasSubstr("wendland-c2"));
  EXPECT_THAT(refused(paddle, {"interface.surface_tension=1"}), HasSubstr("beside walls of [[body]]"));
  EXPECT_THAT(refused(replaced(column_in_air, "\"0.1*sin(t)\", \"0\"", "\"0\", \"1\"")), HasSubstr("along its normal"));
  EXPECT_THAT(refused(replaced(column_in_air, "[time]", "[[solid]]\nlower = [1, 0]\nupper = [1.2, 0.3]\n[time]")),
              HasSubstr("as [[body]]"));
  EXPECT_THAT(
      refused(replaced(column_in_air, "[[region]]\nphase = \"air\"\n", ""), {"compressibility.shifting=\"on\""}),
      HasSubstr("expected phases that fill the domain"));
  EXPECT_THAT(refused(replaced(periodic_vortices,
                               "velocity = [\"-cos(2*pi*x)*sin(2*pi*y)\", \"sin(2*pi*x)*cos(2*pi*y)\"]", "")),
              HasSubstr("set compressibility.max_speed"));
}

}  // namespace
}  // namespace spume::test
