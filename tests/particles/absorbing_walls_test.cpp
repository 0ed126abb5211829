// SPDX-License-Identifier: MIT
// What an absorbing wall answers to the elevation beside it.
#include "spume/particles/absorbing_walls.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "methods/method_run.hpp"
#include "spume/core/error.hpp"

namespace spume {
namespace {

Domain domain(const AbsorptionLaw& law, int side) {
  Domain made;
  made.dimensions = 2;
  made.upper = {10, 2, 0};
  made.sides[0][static_cast<std::size_t>(side)].absorption = WaveAbsorption{law, 1, nullptr};
  return made;
}

// u' = (-gain e - u) / smoothing, X' = v = u - X / drift: of e = a cos wt the velocity is that of the transfer
// function.
TEST(AbsorbingWalls, FollowTheLaw) {
  const AbsorptionLaw law{.gain = 1.3, .smoothing = 0.2, .drift = 3};
  const double w = 1.7, a = 0.1;
  const std::complex<double> s(0, w);
  const std::complex<double> answer = -law.gain * a / (1.0 + s * law.smoothing) * s * law.drift / (1.0 + s * law.drift);
  for (const int side : {0, 1}) {
    const Domain of = domain(law, side);
    AbsorbingWalls walls(of, 0.1);
    const double inwards = side == 0 ? 1 : -1;
    double t = 0, place = 0;
    for (int n = 0; n < 40000; ++n) {
      const double dt = n % 2 == 0 ? 0.0008 : 0.0012;
      walls.measure({0, 10}, t, [&](const Vec3& at) {
        EXPECT_NEAR(std::abs(at[0] - (side == 0 ? 0 : 10)), 0.15, 0.1 + 1e-12);
        return 1 + a * std::cos(w * (t + dt / 2));
      });
      walls.advance(t, dt);
      // The way is the integral of a velocity that is linear in time, and displacement the sum of ways.
      EXPECT_NEAR(walls.way(side), dt * walls.velocity(side, t + dt / 2), 1e-15);
      const double end = walls.velocity(side, t + dt);
      place += walls.way(side);
      walls.accept();
      t += dt;
      walls.advance(t, 0);
      EXPECT_NEAR(walls.velocity(side, t), end, 1e-15);
      if (t > 30) {
        EXPECT_NEAR(inwards * end, std::real(answer * std::exp(s * t)), 1e-3 * std::abs(answer)) << t;
      }
    }
    EXPECT_NEAR(inwards * place, walls.displacement(side), 1e-12);
    EXPECT_EQ(walls.velocity(1 - side, t), 0);
  }
}

TEST(AbsorbingWalls, AMeanElevationMovesThemByItsGainTimesTheReturn) {
  const AbsorptionLaw law{.gain = 0.5, .smoothing = 0.1, .drift = 2};
  const Domain of = domain(law, 0);
  AbsorbingWalls walls(of, 0.1);
  for (int n = 0; n < 4000; ++n) {
    walls.measure({0, 10}, 0.01 * n, [](const Vec3&) { return 1.2; });
    walls.advance(0.01 * n, 0.01);
    walls.accept();
  }
  EXPECT_NEAR(walls.displacement(0), -0.5 * 0.2 * 2, 1e-6);
  EXPECT_NEAR(walls.velocity(0, 40), 0, 1e-6);
}

// A level that stays off takes it half a domain away, where it says so.
TEST(AbsorbingWalls, StopWhereTheyWouldLeaveTheDomain) {
  const Domain of = domain({.gain = 0.5, .smoothing = 0.1, .drift = 200}, 0);
  AbsorbingWalls walls(of, 0.1);
  const auto flood = [&] {
    for (int n = 0; n < 4000; ++n) {
      walls.measure({0, 10}, 0.1 * n, [](const Vec3&) { return 1.2; });
      walls.advance(0.1 * n, 0.1);
      walls.accept();
    }
  };
  EXPECT_THROW(flood(), StepFailure);
  EXPECT_NEAR(walls.displacement(0), -5, 0.02);
}

TEST(AbsorbingWalls, ARefusedStepLeavesTheStateAndItIsSaved) {
  const Domain of = domain({.gain = 0.5, .smoothing = 0.1, .drift = 2}, 0);
  AbsorbingWalls walls(of, 0.1), other(of, 0.1);
  const auto high = [](const Vec3&) { return 1.2; };
  for (int n = 0; n < 3; ++n) {
    walls.measure({0, 10}, 0.01 * n, high);
    walls.advance(0.01 * n, 0.01);
    walls.accept();
  }
  test::MemoryState saved;
  walls.save(saved);
  walls.measure({0, 10}, 0.03, high);
  walls.advance(0.03, 0.02);  // refused
  walls.advance(0.03, 0.01);
  other.load(saved, 0.03);
  EXPECT_EQ(other.velocity(0, 0.03), walls.velocity(0, 0.03));
  other.measure({0, 10}, 0.03, high);
  other.advance(0.03, 0.01);
  EXPECT_EQ(other.velocity(0, 0.04), walls.velocity(0, 0.04));
  EXPECT_EQ(other.way(0), walls.way(0));
  EXPECT_NE(other.way(0), 0);
}

}  // namespace
}  // namespace spume
