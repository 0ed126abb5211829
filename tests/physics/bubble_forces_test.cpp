// SPDX-License-Identifier: MIT
// Motion of one bubble: terminal velocity, the two integrators, braking below a surface.
#include <gtest/gtest.h>

#include <cmath>

#include "spume/physics/bubbles/forces.hpp"
#include "spume/physics/bubbles/population.hpp"
#include "spume/physics/bubbles/surface_interaction.hpp"

namespace spume::bubbles {
namespace {

// Water and air as in King's plume: Re = 1e6, Fr = 1 / sqrt(9.81).
Gas plume_gas() {
  Gas gas;
  gas.viscosity = 1e-6;
  gas.gravity = {0, 0, -9.81};
  return gas;
}

// The balance of King (2.7a) and (2.7d) as printed, solved by bisection.
double balanced_speed(double radius) {
  const double beta = 1000 / 1.2, reynolds = 1e6, inverse_froude2 = 9.81;
  double low = 1e-9, high = 10;
  for (int k = 0; k < 200; ++k) {
    const double w = 0.5 * (low + high), re = 2 * radius * w * reynolds;
    const double cd = re > 1000 ? 0.44 : 24 / re * (1 + 0.15 * std::pow(re, 0.687));
    const double drag = 0.5 * cd * beta * M_PI * radius * radius * w * w;
    const double buoyancy = (beta - 1) * inverse_froude2 * 4 * M_PI / 3 * std::pow(radius, 3);
    (drag < buoyancy ? low : high) = w;
  }
  return 0.5 * (low + high);
}

double length(const Vec3& v) {
  return std::hypot(v[0], v[1], v[2]);
}

class TerminalVelocity : public ::testing::TestWithParam<double> {};

TEST_P(TerminalVelocity, IsTheRootOfTheBalanceOfForcesForAnyStep) {
  const Gas gas = plume_gas();
  const double radius = GetParam(), exact = balanced_speed(radius);
  EXPECT_NEAR(terminal_speed(gas, radius), exact, 1e-9 * exact);
  for (const double steps : {0.1, 1.0, 100.0}) {
    const double dt = steps * relaxation_time(gas, radius);
    Vec3 u{};
    for (int k = 0; k < 2000 && k * dt < 1000 * relaxation_time(gas, radius); ++k)
      u = advance_stable(gas, radius, {}, u, dt, {});
    EXPECT_NEAR(u[2], exact, 1e-4 * exact) << "dt = " << steps << " relaxation times";
    EXPECT_EQ(u[0], 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Radii, TerminalVelocity, ::testing::Values(1e-4, 2e-4, 5e-4, 1e-3, 1.5e-3, 2e-3, 4e-3));

TEST(TerminalVelocity, OfAMillimetreInWater) {
  EXPECT_NEAR(terminal_speed(plume_gas(), 1e-3), 0.20823, 1e-5);
}

TEST(Drag, KeepsTheJumpOfTheLaw) {
  EXPECT_NEAR(drag_coefficient(1000), 0.438, 5e-4);
  EXPECT_DOUBLE_EQ(drag_coefficient(1000.001), 0.44);
  // drag_rate is 3/8 C_d w / a.
  for (const double w : {1e-4, 0.01, 0.3, 2.0})
    EXPECT_NEAR(drag_rate(w, 1e-3, 1e-6), 0.375 * drag_coefficient(2e-3 * w / 1e-6) * w / 1e-3, 1e-12 / 1e-6);
}

// A bubble thrown into a shear flow that accelerates: forces in all directions.
Surroundings shear_flow() {
  return {{0.3, -0.1, 0.05}, {2.0, 5.0, -3.0}, {0.5, 1.0, -2.0}};
}

Vec3 after(double time, int steps, bool stable, double radius) {
  const Gas gas = plume_gas();
  Vec3 u{1, 0.5, -0.7};
  for (int k = 0; k < steps; ++k)
    u = stable ? advance_stable(gas, radius, shear_flow(), u, time / steps, {})
               : advance_substepped(gas, radius, shear_flow(), u, time / steps, radius, {});
  return u;
}

double distance(const Vec3& a, const Vec3& b) {
  return length({a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

TEST(Integrators, AgreeAsTheStepFalls) {
  const double radius = 8e-4, time = 0.02;
  const Vec3 fine = after(time, 4000, true, radius);
  const double explicit_32 = distance(after(time, 3200, false, radius), fine);
  const double explicit_64 = distance(after(time, 6400, false, radius), fine);
  EXPECT_LT(explicit_64, 2e-3);
  EXPECT_NEAR(explicit_32 / explicit_64, 2, 0.2);  // first order
  const double stable_10 = distance(after(time, 10, true, radius), fine);
  const double stable_20 = distance(after(time, 20, true, radius), fine);
  const double stable_40 = distance(after(time, 40, true, radius), fine);
  EXPECT_GT(stable_20 / stable_40, 3.2) << stable_10;  // second order
  EXPECT_LT(stable_40, 1e-3);
}

TEST(Integrators, StableOneKeepsItsBoundAtAHundredRelaxationTimes) {
  const Gas gas = plume_gas();
  for (const double radius : {1e-5, 1e-4, 1e-3}) {
    const double dt = 100 * relaxation_time(gas, radius);
    const Surroundings liquid = shear_flow();
    Vec3 u{5, -3, 8};
    const double start = distance(liquid.velocity, u);
    for (int k = 0; k < 50; ++k) {
      u = advance_stable(gas, radius, liquid, u, dt, {});
      EXPECT_LE(distance(liquid.velocity, u), 1.05 * start);
    }
    // The steady slip is reached, not overshot back and forth.
    EXPECT_NEAR(distance(liquid.velocity, u), distance(liquid.velocity, advance_stable(gas, radius, liquid, u, dt, {})),
                1e-6);
  }
}

// Each step leaves 1 / (1 + x) of what the implicit drag was off, x relaxation times long, and the drag passes on at
// most 0.687 of that to the slip: its exponent.
TEST(Integrators, StableOneForgetsTheStartInTwoLongSteps) {
  const Gas gas = plume_gas();
  for (const double radius : {2e-4, 5e-4, 1e-3}) {
    const double steady = terminal_speed(gas, radius);
    const double relaxation =
        relaxation_time(gas, radius) * drag_rate(0, radius, gas.viscosity) / drag_rate(steady, radius, gas.viscosity);
    for (const double x : {10.0, 20.0, 50.0}) {
      Vec3 u{};
      for (int k = 0; k < 2; ++k) u = advance_stable(gas, radius, {}, u, x * relaxation, {});
      EXPECT_NEAR(u[2] / steady, 1, 0.687 / ((1 + x) * (1 + x))) << "radius " << radius << ", x = " << x;
    }
  }
}

// Without drag to speak of, the slip turns about the vorticity: gamma C_l |omega| per time.
TEST(Integrators, LiftTurnsTheSlipWithoutLengtheningIt) {
  Gas gas = plume_gas();
  gas.gravity = {};
  gas.viscosity = 1e-14;
  const double radius = 10;  // drag rate 0.165 w / a
  const Surroundings liquid{{0, 0, 0}, {0, 0, 1}, {0, 0, 0}};
  Vec3 u{-1e-6, 0, 0};
  const double rate = gas.density_ratio / (1 + 0.5 * gas.density_ratio), time = 0.7;
  u = advance_stable(gas, radius, liquid, u, time, {});
  EXPECT_NEAR(length(u), 1e-6, 1e-12);
  EXPECT_NEAR(std::atan2(-u[1], -u[0]), 0.5 * rate * time, 1e-5);
}

TEST(Reaction, HoldsMomentumOfBubbleAndLiquid) {
  const Gas gas = plume_gas();
  const double volume = 4e-9, dt = 0.01;
  const Vec3 before{0.1, 0, 0}, liquid_velocity{0, 0.2, 0};
  const Surroundings liquid{liquid_velocity, {1, 0, 0}, {0, 0.3, 0}};
  const Vec3 next = advance_stable(gas, 1e-3, liquid, before, dt, {});
  const Vec3 force =
      reaction(gas, volume, liquid, {next[0] - before[0], next[1] - before[1], next[2] - before[2]}, dt, false);
  // Bubble and liquid together gain what gravity and the hydrostatic pressure give: (1 - beta)/beta V g.
  for (std::size_t a = 0; a < 3; ++a) {
    const double gained = volume / gas.density_ratio * (next[a] - before[a]) / dt + force[a];
    EXPECT_NEAR(gained, volume * (1 - gas.density_ratio) / gas.density_ratio * gas.gravity[a], 1e-12 * volume);
  }
}

// At rest below a surface that holds it a bubble gives nothing to the liquid; on its way there it gives what (3.31)
// leaves for drag, lift and virtual mass.
TEST(Reaction, LeavesOutWhatTheSurfaceBears) {
  const Gas gas = plume_gas();
  const double volume = 4e-9, dt = 0.01, per_mass = 1 / gas.density_ratio + gas.virtual_mass;
  const Vec3 up{0, 0, 1}, rest{};
  for (const double radius : {1e-4, 3e-3}) {
    const Braking held{1, up, dt};
    const Vec3 next = advance_stable(gas, radius, {}, rest, dt, held);
    EXPECT_EQ(next, rest);
    const Vec3 borne = braking_force(gas, radius, {}, next, 0, dt, held),
               given = reaction(gas, volume, {}, {}, dt, false);
    EXPECT_NEAR(given[2] + volume * borne[2], 0, 1e-15 * volume * length(gas.gravity));
  }
  const double radius = 3e-3, small = 1e-6;
  const Surroundings liquid{{0.1, 0, 0.2}, {1, 2, 0}, {0, 0.3, 0.5}};
  const Vec3 u{0.05, 0, 0.3}, slip{0.05, 0, -0.1};
  const Braking braking{0.7, up, 0.02};
  const Vec3 next = advance_stable(gas, radius, liquid, u, small, braking);
  const Vec3 borne = braking_force(gas, radius, liquid, next, slip[2], small, braking);
  // Lift w x curl u_l along the normal.
  const double lift = gas.lift * (slip[0] * liquid.vorticity[1] - slip[1] * liquid.vorticity[0]);
  const double force = drag_rate(length(slip), radius, gas.viscosity) * slip[2] + lift +
                       gas.virtual_mass * liquid.acceleration[2] - (1 - 1 / gas.density_ratio) * gas.gravity[2];
  EXPECT_NEAR(per_mass * (next[2] - u[2]) / small, force + borne[2], 1e-4 * length(gas.gravity));
}

// Relaxation over the time left stops the bubble after half the way that its slip would have taken it.
TEST(Braking, BringsTheNormalSlipToZeroAtTheMergeTime) {
  const Gas gas = plume_gas();
  for (const bool stable : {true, false}) {
    const double radius = 1e-3, spacing = 0.01, dt = 1e-3;
    double t = 0, depth = 0, merge = not_merging;
    Vec3 u{0, 0, terminal_speed(gas, radius)};
    const SurfaceModel model{spacing, 100};
    const Vec3 up{0, 0, 1};
    for (int k = 0; k < 500; ++k) {
      t += dt;
      const auto contact = approach_surface(model, 1.0, up, {-u[0], -u[1], -u[2]}, radius, 1.0, merge, t, dt);
      merge = contact.merge_time;
      EXPECT_FALSE(contact.bursts);
      depth += dt * u[2];
      u = stable ? advance_stable(gas, radius, {}, u, dt, contact.braking)
                 : advance_substepped(gas, radius, {}, u, dt, spacing, contact.braking);
    }
    EXPECT_NEAR(u[2], 0, 1e-3);
    EXPECT_GT(depth, 0.4 * spacing);
    EXPECT_LT(depth, spacing);
  }
}

TEST(SurfaceContact, WaitsForTheAgeThatKeepsNewBubbles) {
  const SurfaceModel model{0.01, 1};
  const Vec3 up{0, 0, 1}, slip{0, 0, -0.2};
  EXPECT_EQ(approach_surface(model, 0.5, up, slip, 1e-3, 0.049, not_merging, 1, 1e-3).merge_time, not_merging);
  EXPECT_NEAR(approach_surface(model, 0.5, up, slip, 1e-3, 0.051, not_merging, 1, 1e-3).merge_time, 1.05, 1e-12);
  // Far from the surface a bubble forgets it.
  EXPECT_EQ(approach_surface(model, 0.05, up, slip, 1e-3, 1, 1.05, 1, 1e-3).merge_time, not_merging);
  EXPECT_TRUE(approach_surface(model, 0.5, up, slip, 1e-3, 1, 1.05, 1.05 + std::sqrt(1e-3) + 1e-9, 1e-3).bursts);
  EXPECT_FALSE(approach_surface(model, 0.5, up, slip, 1e-3, 1, 1.05, 1.05 + std::sqrt(1e-3) - 1e-9, 1e-3).bursts);
}

// King (3.34) in groups: We^(3/4) / Re Fr^(1/2) Sc sqrt(a); any other unit of length and time gives the same in them.
TEST(SurfaceContact, PersistenceHasTheUnitsOfTime) {
  const double we = 1.4e4, re = 1e6, fr = 1 / std::sqrt(9.81), sc = 700;
  const double groups = std::pow(we, 0.75) / re * std::sqrt(fr) * sc;
  EXPECT_NEAR(persistence_unit(1 / we, 1 / re, 1 / (fr * fr), sc), groups, 1e-12 * groups);
  const double length = 0.37, time = 2.1;  // units of the groups in others
  const double other = persistence_unit(std::pow(length, 3) / (time * time) / we, length * length / time / re,
                                        length / (time * time) / (fr * fr), sc) *
                       std::sqrt(length);
  EXPECT_NEAR(other, time * groups, 1e-12 * time * groups);
}

}  // namespace
}  // namespace spume::bubbles
