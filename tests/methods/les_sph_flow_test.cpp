// SPDX-License-Identifier: MIT
// Flows whose first steps are known: liquids at rest, in free fall, pushed by a wall or a force.
#include <gtest/gtest.h>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

// The potential of gravity is part of the unknown: at rest its gradient is zero up to the solver's tolerance, here
// 1e-10 of the hydrostatic source. Rounding of float coordinates and pressures enters speeds as 1e-6 g t.
TEST(LesSphFlow, StillLiquidStaysAtRest) {
  for (const std::string& text : {closed_box, tank}) {
    Simulation run(text, {"pressure.tolerance=1e-10"});
    const double dt = 0.005;
    run.steps(5, dt);
    const State after = run.state();
    EXPECT_LT(max_speed(after), 1e-5 * 5 * dt) << text;
    // Hydrostatic pressure, up to the constant of a closed box.
    double mean_error = 0;
    for (std::size_t i = 0; i < after.pressure.size(); ++i)
      mean_error += (after.pressure[i] + after.position[i][1]) / static_cast<double>(after.pressure.size());
    // The pressure belongs to the place before the shift, a fraction of a spacing away at most.
    for (std::size_t i = 0; i < after.pressure.size(); ++i)
      ASSERT_NEAR(after.pressure[i] + after.position[i][1], mean_error, 1e-3);
    if (text == tank) {
      EXPECT_NEAR(mean_error, 1, 1e-3);
    }
  }
}

// The sums of a row, found in one pass, against a loop for each.
TEST(LesSphFlow, TotalsAreSumsOverTheParticles) {
  for (const char* model : {"none", "mixed-scale"}) {
    Simulation run(tank, {std::string("turbulence.model=\"") + model + "\""});
    run.steps(2, 0.005);
    const les_sph::Flow& flow = run.method.flow();
    double kinetic = 0, potential = 0, unresolved = 0;
    Vec3 momentum{};
    for (std::size_t i = 0; i < flow.size(); ++i) {
      kinetic += squared_norm(flow.particles.velocity, 2, i) / 2;
      potential -= flow.scene.fluid.gravity[1] * (*flow.particles.position[1])[i];
      unresolved += flow.eddy_viscosity_of(i) * std::pow((*flow.strain)[i], 2);
      for (int axis = 0; axis < 2; ++axis) momentum[axis] += (*flow.particles.velocity[axis])[i];
    }
    const double mass = flow.particle_mass(), n = static_cast<double>(flow.size());
    const les_sph::FlowTotals totals = flow.totals();
    constexpr double rounding = 1e-13;
    EXPECT_NEAR(totals.kinetic, mass * kinetic, rounding * mass * n);
    EXPECT_NEAR(totals.potential, mass * potential, rounding * mass * n);
    EXPECT_NEAR(totals.unresolved_dissipation, mass * unresolved, rounding * mass * n);
    EXPECT_NEAR(totals.mass, mass * n, rounding * mass * n);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(totals.momentum[axis], mass * momentum[axis], rounding * mass * n);
  }
}

// A compressible liquid starts from its own hydrostatic pressure: without it the first steps are a sound wave.
TEST(LesSphFlow, CompressibleStillLiquidStaysAtRestFromTheFirstStep) {
  for (const std::string& text : {closed_box, tank}) {
    Simulation run(text, {"fluid.mach=0.05", "pressure.tolerance=1e-10"});
    run.steps(1, 0.005);
    EXPECT_LT(max_speed(run.state()), 1e-3 * 0.005) << text;
  }
}

// lap p = -div(u . grad u): p = -(cos 4 pi x + cos 4 pi y) / 4 for the vortices of this sense.
TEST(LesSphFlow, FirstPressureBelongsToTheInitialVelocity) {
  Simulation run(taylor_green);
  run.method.snapshot();  // finds it
  const State s = run.state();
  double error = 0, size = 0;
  for (std::size_t i = 0; i < s.pressure.size(); ++i) {
    const double exact = -(std::cos(4 * M_PI * s.position[i][0]) + std::cos(4 * M_PI * s.position[i][1])) / 4;
    error += std::pow(s.pressure[i] - exact, 2);
    size += exact * exact;
  }
  EXPECT_LT(error, 0.01 * size);  // 10 spacings a wave: a tenth
}

std::string in_the_air(int dimensions, const std::string& liquid) {
  const bool flat = dimensions == 2;
  return std::string("method = \"les-sph\"\n[domain]\n") +
         (flat ? "lower = [0, 0]\nupper = [1, 1]\n" : "lower = [0, 0, 0]\nupper = [1, 1, 1]\n") +
         "bottom = \"free-slip\"\n[resolution]\nspacing = 0.05\n[fluid]\nreynolds = 100\nfroude = 1\n[[liquid]]\n" +
         liquid + "[time]\nend = 1\n";
}

TEST(LesSphFlow, AnIsolatedParticleFallsFreely) {
  for (const int d : {2, 3}) {
    Simulation run(in_the_air(d, d == 2 ? "lower = [0.5, 0.5]\nupper = [0.55, 0.55]\n"
                                        : "lower = [0.5, 0.5, 0.5]\nupper = [0.55, 0.55, 0.55]\n"));
    ASSERT_EQ(run.method.particle_count(), 1U);
    const double dt = 0.01;
    const double start = run.state().position[0][d - 1];
    run.steps(10, dt);
    const State s = run.state();
    EXPECT_NEAR(s.velocity[0][d - 1], -10 * dt, 1e-7);
    EXPECT_NEAR(start - s.position[0][d - 1], 0.5 * 0.1 * 0.1, 1e-8);
    for (int axis = 0; axis + 1 < d; ++axis) EXPECT_EQ(s.velocity[0][axis], 0);
  }
}

// The Laplacian of a linear potential is not zero where the support is cut just below the surface, and makes a pressure
// of some per cent of the hydrostatic one over a spacing.
TEST(LesSphFlow, ADropFallsFreelyAndNearlyKeepsItsShape) {
  for (const int d : {2, 3}) {
    Simulation run(
        in_the_air(d, d == 2 ? "centre = [0.5, 0.6]\nradius = 0.2\n" : "centre = [0.5, 0.5, 0.6]\nradius = 0.2\n"),
        {"shifting.on=false"});
    ASSERT_GT(run.method.particle_count(), 20U);
    const double dt = 0.005;
    run.steps(5, dt);
    const State s = run.state();
    for (std::size_t i = 0; i < s.velocity.size(); ++i) {
      ASSERT_NEAR(s.velocity[i][d - 1], -5 * dt, 0.05 * 5 * dt);
      for (int axis = 0; axis + 1 < d; ++axis) ASSERT_NEAR(s.velocity[i][axis], 0, 0.05 * 5 * dt);
    }
    double mean = 0;
    for (const Vec3& u : s.velocity) mean += u[d - 1] / static_cast<double>(s.velocity.size());
    EXPECT_NEAR(mean, -5 * dt, 0.01 * 5 * dt);
  }
}

TEST(LesSphFlow, ALidDragsTheLiquidWithIt) {
  Simulation run(closed_box, {"fluid.reynolds=10", "domain.wall_velocity.top=[\"1\", \"0\"]"});
  run.steps(5, 0.002);
  const State s = run.state();
  double upper = 0, rest = 0;
  int count = 0;
  for (std::size_t i = 0; i < s.velocity.size(); ++i) {
    const bool under_the_lid = s.position[i][1] > 0.95 && std::abs(s.position[i][0] - 0.5) < 0.3;
    if (!under_the_lid && s.position[i][1] > 0.5) continue;
    (under_the_lid ? upper : rest) += s.velocity[i][0];
    count += under_the_lid;
  }
  // Diffusion over sqrt(nu t) = 0.03: the uppermost row has gained a good part of the lid's speed, the depth none.
  EXPECT_GT(upper / count, 0.1);
  EXPECT_LT(upper / count, 1);
  EXPECT_LE(rest, 0) << "the return flow below runs the other way";
}

TEST(LesSphFlow, WallsAtRestSlowAStreamAndSlippingOnesDoNot) {
  for (const std::string wall : {"no-slip", "free-slip"}) {
    Simulation run(channel, {"domain.top=\"" + wall + "\"", "domain.bottom=\"" + wall + "\""});
    run.steps(3, 0.005);
    const State s = run.state();
    for (std::size_t i = 0; i < s.velocity.size(); ++i) {
      const double wall_distance = std::min(s.position[i][1], 1 - s.position[i][1]);
      if (wall == "free-slip") {
        EXPECT_NEAR(s.velocity[i][0], 1, 1e-5);
      } else if (wall_distance < 0.03) {
        EXPECT_LT(s.velocity[i][0], 0.95);
      }
    }
  }
}

void run_around_a_solid(const std::string& mach) {
  Simulation run(closed_box + "[[solid]]\nlower = [0.35, 0.35]\nupper = [0.65, 0.65]\nwall = \"no-slip\"\n",
                 {"domain.wall_velocity.top=[\"1\", \"0\"]", "fluid.mach=" + mach});
  run.steps(20, 0.005);
  EXPECT_LT(max_speed(run.state()), 1);
  EXPECT_GT(max_speed(run.state()), 0.1);
}

TEST(LesSphFlow, ALidDrivesACompressibleBoxAroundASolid) {
  run_around_a_solid("0.05");
}

// The pressure has no level, and only a symmetric matrix makes a right-hand side without mean solvable.
TEST(LesSphFlow, ALidDrivesAnIncompressibleBoxAroundASolid) {
  run_around_a_solid("0");
}

struct ShiftBounds {
  double longest = 0, along_normal = 0, at_surface = 0;  // in h
};

ShiftBounds shifts_of_a_dam_break(const std::vector<std::string>& overrides = {}) {
  Simulation run(dam_break, overrides);
  ShiftBounds bounds;
  for (int k = 0; k < 20; ++k) {
    run.steps(1, 0.004);
    auto& flow = const_cast<les_sph::Flow&>(run.method.flow());
    // The shift has released the smoothed normals.
    flow.surface->find(flow.arrangement, flow.particles, flow.moments, flow.boundary, flow.intermediate_position);
    const double h = flow.resolution.smoothing_length;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      double length2 = 0, normal2 = 1e-30, along = 0;
      for (int axis = 0; axis < 2; ++axis) {
        const double s = (*flow.shift->displacement[axis])[i], n = flow.surface->smoothed_normal[axis][i];
        length2 += s * s;
        normal2 += n * n;
        along += s * n;
      }
      bounds.longest = std::max(bounds.longest, std::sqrt(length2) / h);
      if (flow.surface->at_surface[i] == 0) continue;
      bounds.along_normal = std::max(bounds.along_normal, std::abs(along) / std::sqrt(normal2) / h);
      bounds.at_surface = std::max(bounds.at_surface, std::sqrt(length2) / h);
    }
  }
  return bounds;
}

TEST(LesSphFlow, AShiftIsShorterThanItsLimit) {
  const ShiftBounds bounds = shifts_of_a_dam_break();
  EXPECT_LE(bounds.longest, 0.1 * (1 + 1e-6));
  EXPECT_GT(bounds.longest, 0);
}

// Removing the drift may move surface particles across the surface, with their neighbours; the shift itself does not.
TEST(LesSphFlow, AShiftFollowsTheSurface) {
  const ShiftBounds bounds = shifts_of_a_dam_break({"shifting.remove_drift=false"});
  EXPECT_LE(bounds.along_normal, 1e-5) << "of a largest shift of " << bounds.at_surface << " h";
}

// A uniform force along a periodic axis accelerates everything alike.
TEST(LesSphFlow, AUniformForceAlongAPeriodicAxisAcceleratesAll) {
  Simulation run(taylor_green, {"liquid.0.velocity=[\"0\", \"0\"]", "forces.body=[\"0.5\", \"-0.25\"]"});
  run.steps(4, 0.005);
  for (const Vec3& u : run.state().velocity) {
    EXPECT_NEAR(u[0], 0.01, 1e-8);
    EXPECT_NEAR(u[1], -0.005, 1e-8);
  }
}

// The spinning square keeps its angular momentum and its centre; the closed box keeps its particles inside.
TEST(LesSphFlow, ASpinningSquareRunsOn) {
  Simulation run(square_patch);
  const auto angular = [](const State& s) {
    double sum = 0;
    for (std::size_t i = 0; i < s.velocity.size(); ++i)
      sum += s.position[i][0] * s.velocity[i][1] - s.position[i][1] * s.velocity[i][0];
    return sum;
  };
  const State before = run.state();
  run.steps(10, 0.01);
  const State after = run.state();
  EXPECT_NEAR(angular(after), angular(before), 0.02 * std::abs(angular(before)));
  Vec3 centre{};
  for (const Vec3& r : after.position)
    for (int axis = 0; axis < 2; ++axis) centre[axis] += r[axis] / static_cast<double>(after.position.size());
  EXPECT_NEAR(centre[0], 0, 1e-3);
  EXPECT_NEAR(centre[1], 0, 1e-3);
  EXPECT_LT(max_speed(after), 1);
}

TEST(LesSphFlow, ParticlesStayInsideWallsAndOutsideSolids) {
  Simulation run(dam_break + "[[solid]]\nlower = [0.6, 0]\nupper = [1, 0.3]\n");
  for (int k = 0; k < 60; ++k) run.method.step(std::min(run.method.step_limit().dt, 0.02), run.ledger);
  const State s = run.state();
  double farthest = 0;
  for (const Vec3& r : s.position) {
    EXPECT_GT(r[0], 0);
    EXPECT_LT(r[0], 2);
    EXPECT_GT(r[1], 0);
    EXPECT_FALSE(r[0] > 0.6 && r[0] < 1 && r[1] < 0.3) << r[0] << ' ' << r[1];
    farthest = std::max(farthest, r[0]);
  }
  EXPECT_GT(farthest, 0.55) << "the column has begun to collapse";
}

}  // namespace
}  // namespace spume::test
