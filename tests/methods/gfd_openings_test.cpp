// SPDX-License-Identifier: MIT
// gfd with inflows and outflows against exact flows.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "methods/gfd_openings_run.hpp"

namespace spume::test {
namespace {

Vec3 along_x(const Vec3&) {
  return {1, 0, 0};
}
double nothing(const Vec3&) {
  return 0;
}

// Every particle that enters goes on with the lattice: nothing but the rounding of floats disturbs it.
TEST(GfdOpenings, AUniformStreamStaysUniform) {
  for (const std::string& text :
       {gfd_stream,
        replaced(gfd_stream, "[[inflow]]\nside = \"left\"\nvelocity = [\"1\", \"0\"]",
                 "[[inflow]]\nside = \"left\"\nflow_rate = 0.5"),
        gfd_stream_with_air("lower = [0, 0.25]\n") +
            "[[inflow]]\nside = \"left\"\nphase = \"air\"\nvelocity = [\"1\", \"0\"]\nlower = [0, 0.25]\n"}) {
    const bool layers = text.find("air") != std::string::npos;
    GfdRun run(text, layers ? Overrides{"inflow.0.upper=[0, 0.25]"} : Overrides{});
    run.until(1);
    const StreamErrors errors = stream_errors(run, along_x, nothing);
    EXPECT_LT(errors.velocity, 1e-6);
    EXPECT_LT(errors.pressure, 1e-6 * 1000);
    const std::string of = layers ? "_water" : "";
    EXPECT_NEAR(run.series()["volume_in" + of], layers ? 0.25 : 0.5, 0.25 * 0.05 + 1e-12);
    EXPECT_EQ(run.series()["volume_in" + of], run.series()["volume_out" + of]);
  }
}

TEST(GfdOpenings, AUniformStreamStaysUniformInThreeDimensions) {
  std::string text =
      replaced(gfd_stream, "lower = [0, 0]\nupper = [1, 0.5]", "lower = [0, 0, 0]\nupper = [0.8, 0.7, 0.7]");
  text = replaced(text, "bottom", "y = \"periodic\"\nbottom");
  text = replaced(replaced(text, "[\"1\", \"0\"]", "[\"1\", \"0\", \"0\"]"), "[\"1\", \"0\"]", "[\"1\", \"0\", \"0\"]");
  GfdRun run(text, {"resolution.spacing=0.1"});
  run.until(0.5);
  const StreamErrors errors = stream_errors(run, along_x, nothing);
  EXPECT_LT(errors.velocity, 1e-6);
  EXPECT_LT(errors.pressure, 1e-6 * 1000);
}

// Bodies are packed around at the start, near openings too: layers stay behind their sides, and no liquid leaves. What
// enters is a layer of particles at most.
TEST(GfdOpenings, PackingBesideABodyLeavesLayersBehindTheirSides) {
  for (const double x : {0.5, 0.12, 0.9}) {
    GfdRun run(gfd_stream + "[[body]]\nshape = \"ball\"\nradius = 0.09\nposition = [" + std::to_string(x) +
               ", 0.26]\n");
    run.steps(1, 1e-3);
    EXPECT_LE(run.series()["volume_in"], 0.05 * 0.5 + 1e-12) << x;
    EXPECT_LE(run.series()["volume_out"], 0.05 * 0.5 + 1e-12) << x;
    EXPECT_NEAR(run.series()["volume_water"], 0.5 - std::numbers::pi * 0.09 * 0.09, 0.05 * 0.5 + 0.005) << x;
  }
}

// A plug of air, 1000 times as light, goes with the water around it and leaves: what is inside is what the velocity
// tells, to a layer.
TEST(GfdOpenings, APlugOfAirLeaves) {
  GfdRun run(gfd_stream_with_air("lower = [0.4, 0]\nupper = [0.7, 0.5]\n"));
  EXPECT_NEAR(run.series()["volume_air"], 0.15, 1e-12);
  run.until(0.45);
  EXPECT_NEAR(run.series()["volume_air"], 0.15 - 0.5 * 0.15, 0.5 * 0.05);
  EXPECT_LT(stream_errors(run, along_x, nothing).velocity, 1e-6);
  run.until(0.7);
  EXPECT_EQ(run.series()["volume_air"], 0);
  EXPECT_NEAR(run.series()["volume_out_air"], 0.15, 1e-12);
  EXPECT_LT(stream_errors(run, along_x, nothing).velocity, 1e-6);
}

TEST(GfdOpenings, APhaseEntersThatTheSceneDoesNotHave) {
  GfdRun run(replaced(
      replaced(gfd_stream, "[[region]]", "[[phase]]\nname = \"air\"\ndensity = 1\nviscosity = 0.01\n[[region]]"),
      "[[inflow]]", "[[inflow]]\nphase = \"air\""));
  EXPECT_EQ(run.series()["volume_air"], 0);
  run.until(0.5);
  EXPECT_NEAR(run.series()["volume_air"], 0.25, 0.25 * 0.05 + 1e-12);
  EXPECT_NEAR(run.series()["volume_water"], 0.5 - run.series()["volume_out_water"], 1e-12);
  EXPECT_LT(stream_errors(run, along_x, nothing).velocity, 1e-6);
  run.until(1.1);
  EXPECT_EQ(run.series()["volume_water"], 0);
}

// u = 1 + sin(t) / 2: what enters is accelerated, p = rho du/dt (1 - x). Steps have their mean velocity, a dt / 2 off
// that of their end; twice that leaves room for what evening out the density adds, a tenth of the pressure for its
// change from step to step. Without the gradient that the inflow gives the pressure is off by all of itself.
TEST(GfdOpenings, APlugFlowFollowsItsInflow) {
  GfdRun run(gfd_stream, {"inflow.0.velocity=[\"1 + 0.5*sin(t)\", \"0\"]"});
  const double dt = 0.01, acceleration = 0.5 * std::cos(0.5);
  run.steps(50, dt);
  const StreamErrors errors = stream_errors(
      run,
      [](const Vec3&) {
        return Vec3{1 + 0.5 * std::sin(0.5), 0, 0};
      },
      [&](const Vec3& r) { return -1000 * acceleration * (r[0] - 1); });
  EXPECT_LT(errors.velocity, dt * acceleration);
  EXPECT_LT(errors.pressure, 0.1 * 1000 * acceleration / 2);
}

// Two sides with pressures P and 0 outside: liquid from rest there enters with P - rho u^2 / 2, so that
// rho L du/dt = P - rho u^2 / 2, u = U tanh(U t / 2 L), U^2 = 2 P / rho. The head is that of the last step: first order
// in time, dt U / L of U.
TEST(GfdOpenings, LiquidFromRestOutsideEntersByItsPressure) {
  const std::string text = replaced(replaced(gfd_stream, "[[inflow]]\nside = \"left\"\nvelocity = [\"1\", \"0\"]",
                                             "[[outflow]]\nside = \"left\"\npressure = 500"),
                                    "velocity = [\"1\", \"0\"]", "velocity = [\"0\", \"0\"]");
  GfdRun run(text, {"time.max_step=0.01"});
  for (const double t : {0.5, 1.5}) {
    run.until(t);
    const double u = std::tanh(t / 2);
    const StreamErrors errors = stream_errors(
        run,
        [&](const Vec3&) {
          return Vec3{u, 0, 0};
        },
        [&](const Vec3& r) { return (500 - 500 * u * u) * (1 - r[0]); });
    EXPECT_LT(errors.velocity, 0.01) << t;
    EXPECT_LT(errors.pressure, 0.01 * 1000) << t;
  }
  EXPECT_LT(run.series()["volume_out"], 0.05) << "what enters is what has come back";
}

TEST(GfdOpenings, AStreamAslantGoesRoundPeriodicSides) {
  for (const std::string speed : {"0.5", "1"}) {
    std::string text = replaced(gfd_stream, "bottom = \"free-slip\"\ntop = \"free-slip\"", "y = \"periodic\"");
    text = replaced(replaced(text, "[\"1\", \"0\"]", "[\"1\", \"" + speed + "\"]"), "[\"1\", \"0\"]",
                    "[\"1\", \"" + speed + "\"]");
    GfdRun run(text);
    run.until(1);
    const StreamErrors errors = stream_errors(
        run,
        [&](const Vec3&) {
          return Vec3{1, std::stod(speed), 0};
        },
        nothing);
    EXPECT_LT(errors.velocity, 0.01);
    EXPECT_LT(errors.pressure, 0.01 * 1000);
    EXPECT_EQ(run.series()["volume_in"], run.series()["volume_out"]);
  }
}

TEST(GfdOpenings, AStreamUnderGravityKeepsItsHydrostaticPressure) {
  GfdRun run(gfd_stream, {"fluid.gravity=1", "outflow.0.level=0.5"});
  run.until(0.5);
  const StreamErrors errors = stream_errors(run, along_x, [](const Vec3& r) { return 1000 * (0.5 - r[1]); });
  EXPECT_LT(errors.velocity, 1e-6);
  EXPECT_LT(errors.pressure, 1e-6 * 1000);
}

// Pressures outside that are hydrostatic balance the layers inside to the rounding of floats, 6e-8 of 8,800 Pa over
// half a spacing: 0.02 m/s^2 of a thousandth of the density; what is left grows by the disorder that it makes.
TEST(GfdOpenings, LayersStayStillBesideAnOutflow) {
  for (const double density : {800.0, 1.0}) {
    GfdRun run(gfd_layers_beside_an_outflow, {"phase.1.density=" + std::to_string(density)});
    run.until(1);
    const StreamErrors errors = stream_errors(
        run, [](const Vec3&) { return Vec3{}; },
        [&](const Vec3& r) { return 9.81 * (r[1] > 0.5 ? density : 1000) * (0.5 - r[1]); });
    EXPECT_LT(errors.velocity, 1e-3 * std::sqrt(9.81)) << density;
    EXPECT_LT(errors.pressure, 1e-4 * 9810) << density;
    EXPECT_EQ(run.series()["volume_out_water"], 0);
  }
}

// u = 4 y (1 - y), p = 8 nu (1.5 - x), nu = 0.05: with 16 spacings across the velocity errs by 0.2 % of its peak, as it
// does between periodic sides.
TEST(GfdOpenings, APoiseuilleFlowGoesThrough) {
  const std::string text =
      replaced(replaced(replaced(gfd_stream, "upper = [1, 0.5]\nbottom = \"free-slip\"\ntop = \"free-slip\"",
                                 "upper = [1.5, 1]\nbottom = \"no-slip\"\ntop = \"no-slip\""),
                        "density = 1000\nviscosity = 1\n", "density = 1\nviscosity = 0.05\n"),
               "spacing = 0.05", "spacing = 0.0625");
  GfdRun run(text, {"region.0.velocity=[\"4*y*(1-y)\", \"0\"]", "inflow.0.velocity=[\"4*y*(1-y)\", \"0\"]"});
  run.until(1.5);
  const StreamErrors errors = stream_errors(
      run,
      [](const Vec3& r) {
        return Vec3{4 * r[1] * (1 - r[1]), 0, 0};
      },
      [](const Vec3& r) { return 8 * 0.05 * (1.5 - r[0]); });
  EXPECT_LT(errors.velocity, 0.005);
  EXPECT_LT(errors.pressure, 0.04 * 0.6);
  auto series = run.series();
  EXPECT_NEAR(series["volume_in"], 1.5 * 2 / 3.0, 0.0625 * 0.0625 * 8 + 0.005);
  EXPECT_NEAR(series["volume_water"], 1.5 + series["volume_in"] - series["volume_out"], 1e-12);
  EXPECT_NEAR(series["volume_water"], 1.5, 0.015);
}

// Viscosities 1:5 one above the other, a pressure gradient of 1: u = (-y^2 / 2 + b y) / mu + c, b = -1/6, c = 5/6.
TEST(GfdOpenings, APoiseuilleFlowOfTwoLayersGoesThrough) {
  const std::string text = R"toml(method = "gfd"
[constants]
u1 = "10*(-y^2 - y/3) + 5/6"
u2 = "2*(-y^2 - y/3) + 5/6"
[domain]
lower = [0, -0.5]
upper = [1.5, 0.5]
bottom = "no-slip"
top = "no-slip"
[resolution]
spacing = 0.05
[[phase]]
name = "lower"
density = 1
viscosity = 0.05
[[phase]]
name = "upper"
density = 1
viscosity = 0.25
[[region]]
phase = "lower"
velocity = ["u1", "0"]
[[region]]
phase = "upper"
lower = [0, 0]
velocity = ["u2", "0"]
[[inflow]]
side = "left"
upper = [0, 0]
phase = "lower"
velocity = ["u1", "0"]
[[inflow]]
side = "left"
lower = [0, 0]
phase = "upper"
velocity = ["u2", "0"]
[[outflow]]
side = "right"
[time]
end = 1.5
)toml";
  GfdRun run(text);
  run.until(1.5);
  const StreamErrors errors = stream_errors(
      run,
      [](const Vec3& r) {
        return Vec3{(r[1] < 0 ? 10.0 : 2.0) * (-r[1] * r[1] - r[1] / 3) + 5.0 / 6, 0, 0};
      },
      [](const Vec3& r) { return 1.5 - r[0]; });
  EXPECT_LT(errors.velocity, 0.01);
  EXPECT_LT(errors.pressure, 0.02 * 1.5);
}

}  // namespace
}  // namespace spume::test
