// SPDX-License-Identifier: MIT
// Averages over planes: exact for linear fields, over the liquid alone.
#include <gtest/gtest.h>
#include <omp.h>

#include <array>
#include <cmath>

#include "methods/les_sph_simulation.hpp"
#include "spume/core/parallel.hpp"

namespace spume::test {
namespace {

// A linear shear between walls at rest and in motion is linear in the mirrored liquid too.
TEST(LesSphPlanes, AverageALinearVelocityExactly) {
  Simulation run(channel, {"domain.wall_velocity.top=[\"2\", \"0\"]", "liquid.0.velocity=[\"2*y\", \"0\"]"});
  for (const double y : {0.0, 0.2, 0.5, 1.0}) {
    const PlaneSample level = run.method.plane_average(1, y);
    EXPECT_NEAR(level.area, 0.5, 1e-12);
    EXPECT_NEAR(level.velocity[0], 2 * y, 1e-12);
    EXPECT_NEAR(level.velocity[1], 0, 1e-12);
  }
  const PlaneSample across = run.method.plane_average(0, 0.21);
  EXPECT_NEAR(across.area, 1, 1e-12);
  EXPECT_NEAR(across.velocity[0], 1, 1e-12);
}

TEST(LesSphPlanes, AverageTheHydrostaticPressure) {
  Simulation run(closed_box, {"domain.left=\"free-slip\"", "domain.right=\"free-slip\""});
  run.steps(2, 0.005);
  const double middle = run.method.sample({0.5, 0.5, 0}).scalars[0];
  // The solve's tolerance of 1e-6, over a box of 1.
  for (const double x : {0.0, 0.3, 1.0}) EXPECT_NEAR(run.method.plane_average(0, x).scalars[0], middle, 2e-5) << x;
  for (const double y : {0.0, 0.4, 1.0})
    EXPECT_NEAR(run.method.plane_average(1, y).scalars[0] - middle, 0.5 - y, 2e-5) << y;
}

// The area of a vertical plane is the depth, wherever the surface lies between two samples. Kernel sums of a lattice
// differ from 1 by less than 1 % and grow from 0.25 to 0.75 over a spacing: 2 % of one. As much comes from the line
// between two samples in place of their curve, by an eighth of its second difference of at most 0.1.
TEST(LesSphPlanes, FollowTheSurfaceBetweenTheCells) {
  for (const char* depth : {"0.96", "0.97", "0.985", "1", "1.01"}) {
    Simulation run(tank, {"liquid.0.where=\"" + std::string(depth) + " - y\""});
    EXPECT_NEAR(run.method.plane_average(0, 0.31).area, std::stod(depth), 0.05 * 0.05) << depth;
  }
}

// A plate half a spacing thick between two levels: on each side a point sees the liquid of its own alone. The pressure
// is hydrostatic below the level that whole particles of one volume make, which is off by up to a tenth of a spacing.
TEST(LesSphPlanes, PointsDoNotSeeThroughAPlate) {
  std::string text = tank;
  text.replace(text.find("[[liquid]]"), std::string::npos,
               "[[liquid]]\nupper = [0.5, 1]\n[[liquid]]\nlower = [0.5, 0]\nupper = [1, 0.5]\n"
               "[[solid]]\nlower = [0.5, 0]\nupper = [0.525, 1.5]\n[time]\nend = 1\n");
  Simulation run(text);
  run.steps(2, 0.005);
  for (const double x : {0.4, 0.48, 0.5}) {
    EXPECT_NEAR(run.method.sample({x, 0.2, 0}).scalars[0], 0.8, 5e-3) << x;
    EXPECT_NEAR(run.method.sample({x, 0.2, 0}).coverage, 1, 0.05) << x;
    EXPECT_NEAR(run.method.elevation({x, 0, 0}), 1, 0.025) << x;
  }
  for (const double x : {0.525, 0.545, 0.6}) {
    EXPECT_NEAR(run.method.sample({x, 0.2, 0}).scalars[0], 0.3, 5e-3) << x;
    EXPECT_NEAR(run.method.elevation({x, 0, 0}), 0.5, 0.025) << x;
    EXPECT_TRUE(std::isnan(run.method.sample({x, 0.7, 0}).scalars[0])) << x;
  }
}

// In the air there is nothing to measure; beside a solid that liquid covers there is, with half a support of particles.
TEST(LesSphPlanes, PointsInTheAirHaveNoValues) {
  Simulation run(tank +
                 "[[solid]]\nlower = [0.3, 0]\nupper = [0.7, 0.4]\n[[solid]]\nlower = [0, 1.2]\nupper = [0.2, 1.5]\n");
  run.steps(1, 0.005);
  for (const Vec3 dry : {Vec3{0.5, 1.3, 0}, Vec3{0.5, 1.02, 0}, Vec3{0.2, 1.35, 0}}) {
    EXPECT_TRUE(std::isnan(run.method.sample(dry).scalars[0])) << dry[1];
    EXPECT_TRUE(std::isnan(run.method.sample(dry).velocity[1])) << dry[1];
  }
  for (const Vec3 wet : {Vec3{0.5, 0.4, 0}, Vec3{0.7, 0.2, 0}, Vec3{0.7, 0, 0}, Vec3{0.5, 0.98, 0}})
    EXPECT_TRUE(std::isfinite(run.method.sample(wet).scalars[0])) << wet[0] << ' ' << wet[1];
}

// Water of depth 1 in a tank 1 wide and 1.5 high.
TEST(LesSphPlanes, MeasureTheLiquidAlone) {
  Simulation run(tank);
  EXPECT_NEAR(run.method.plane_average(1, 0.5).area, 1, 1e-12);
  const PlaneSample air = run.method.plane_average(1, 1.3);
  EXPECT_EQ(air.area, 0);
  EXPECT_TRUE(std::isnan(air.scalars[0]));
  EXPECT_TRUE(std::isnan(air.velocity[0]));
  // A mean over the liquid half way down, not over liquid and air.
  run.steps(1, 0.005);
  EXPECT_NEAR(run.method.plane_average(0, 0.31).scalars[0], 0.5, 0.01);

  Simulation column(dam_break_3d);
  // Free sides as above, with a length below 1, and a corner between two of them that is rounded over a spacing.
  constexpr double spacing = 0.1;
  EXPECT_NEAR(column.method.plane_average(0, 0.25).area, 0.7 * 0.8, 0.05 * spacing);
  EXPECT_NEAR(column.method.plane_average(1, 0.35).area, 0.5 * 0.8, 0.05 * spacing + spacing * spacing);
  EXPECT_NEAR(column.method.plane_average(2, 0.4).area, 0.5 * 0.7, 0.05 * spacing);
  EXPECT_EQ(column.method.plane_average(0, 0.9).area, 0);
}

// The liquid is mirrored within a box: its images are not the liquid.
TEST(LesSphPlanes, LeaveOutSolids) {
  Simulation run(closed_box + "[[solid]]\nlower = [0.3, 0]\nupper = [0.7, 0.4]\n");
  EXPECT_NEAR(run.method.plane_average(0, 0.5).area, 0.6, 1e-12);
  EXPECT_NEAR(run.method.plane_average(1, 0.21).area, 0.6, 1e-12);
  EXPECT_NEAR(run.method.plane_average(1, 0.6).area, 1, 1e-12);
}

// Off the cells, to the error of a distance that is linear over a cell; a circle of 0.3 is cut by cells of 0.05.
TEST(LesSphPlanes, LeaveOutBodies) {
  Simulation box(closed_box +
                 "[[body]]\nshape = \"box\"\nsize = [0.41, 0.33]\nposition = [0.52, 0.47]\nwall = \"no-slip\"\n");
  EXPECT_NEAR(box.method.plane_average(0, 0.5).area, 0.67, 1e-12);
  EXPECT_NEAR(box.method.plane_average(1, 0.4).area, 0.59, 1e-12);
  Simulation ball(closed_box + "[[body]]\nshape = \"ball\"\nradius = 0.3\nposition = [0.5, 0.5]\nwall = \"no-slip\"\n");
  EXPECT_NEAR(ball.method.plane_average(0, 0.5).area, 0.4, 1e-12);
}

TEST(LesSphPlanes, AreTheSameForAnyNumberOfThreads) {
  Simulation run(dam_break_3d);
  run.steps(1, 0.002);
  const int threads = thread_count();
  omp_set_num_threads(1);
  const PlaneSample one = run.method.plane_average(0, 0.25);
  omp_set_num_threads(3);
  const PlaneSample three = run.method.plane_average(0, 0.25);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.scalars[0], three.scalars[0]);
  EXPECT_EQ(one.velocity, three.velocity);
}

// Each of several scalars keeps its own place in the fits, which take four fields at a time: linear along x, exact at a
// point and over a plane across it, between walls that mirror y.
TEST(LesSphPlanes, AverageSeveralScalars) {
  constexpr std::size_t scalars = 7;
  Simulation run(closed_box);
  run.steps(1, 0.002);
  const les_sph::Flow& flow = run.method.flow();
  std::array<Array<double>, scalars> values;
  SampledState state{&flow.arrangement, &flow.boundary, &flow.particles, &flow.resolution};
  for (std::size_t k = 0; k < scalars; ++k) {
    values[k].resize(flow.size());
    for (std::size_t i = 0; i < flow.size(); ++i)
      values[k][i] =
          1 + static_cast<double>(k) + (*flow.particles.position[0])[i] * std::pow(2.0, static_cast<double>(k));
    state.scalars.push_back({&values[k]});
  }
  PointSampler sampler;
  const PointSample point = sampler.update(state).sample({0.4, 0.5, 0});
  const PlaneSample plane = sampler.plane_average(0, 0.5);
  ASSERT_EQ(point.scalars.size(), scalars);
  ASSERT_EQ(plane.scalars.size(), scalars);
  for (std::size_t k = 0; k < scalars; ++k) {
    const double slope = std::pow(2.0, static_cast<double>(k));
    EXPECT_NEAR(point.scalars[k], 1 + static_cast<double>(k) + 0.4 * slope, 1e-12 * slope);
    EXPECT_NEAR(plane.scalars[k], 1 + static_cast<double>(k) + 0.5 * slope, 1e-12 * slope);
  }
}

}  // namespace
}  // namespace spume::test
