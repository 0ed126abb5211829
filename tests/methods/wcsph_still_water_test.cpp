// SPDX-License-Identifier: MIT
// Water at rest below a free surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

// sqrt(gH) = 1.05.
const std::string still_plane = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1.6, 1.3]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.04
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1
viscosity = 1e-4
[[region]]
phase = "water"
upper = [1.6, 1.1]
[time]
end = 20
)toml";
const std::string still_space =
    replaced(replaced(replaced(replaced(still_plane, "lower = [0, 0]", "lower = [0, 0, 0]"), "upper = [1.6, 1.3]",
                               "upper = [1.6, 1.2, 1.3]\nfront = \"free-slip\"\nback = \"free-slip\""),
                      "spacing = 0.04", "spacing = 0.1"),
             "upper = [1.6, 1.1]", "upper = [1.6, 1.2, 1.1]");

const std::string still_ellipse =
    "[[body]]\nshape = \"ellipsoid\"\nposition = [0.8619, 0.37]\nsemi_axes = [0.3812, 0.2877]\nrotation = [11.8]\n";

double largest_speed_of_still(const std::string& text, double end) {
  WcsphRun run(text);
  double largest = 0;
  while (run.method.time() < end - 1e-12) {
    run.steps(1, std::min(run.method.step_limit().dt, end - run.method.time()));
    largest = std::max(largest, run.method.flow().largest_speed);
  }
  return largest;
}

// From the lattice it reached 0.052 sqrt(gH) by t = 5, when that breaks up.
TEST(WcsphStillWater, StaysStill) {
  EXPECT_LT(largest_speed_of_still(still_plane, 5), 1e-3);
}

// From the lattice that the bodies cut: 0.17, 0.13, 5.6 and 0.19.
TEST(WcsphStillWater, StaysStillAroundBodies) {
  const std::string turned =
                        "[[body]]\nshape = \"box\"\nposition = [0.9, 0.42]\nsize = [0.45, 0.31]\nrotation = [31]\n",
                    through_the_wall =
                        "[[body]]\nshape = \"box\"\nposition = [0.2188, 0.3342]\nsize = [0.668, 0.6349]\n"
                        "rotation = [55.46]\n";
  EXPECT_LT(largest_speed_of_still(still_plane + still_ellipse, 2), 1e-3);
  EXPECT_LT(largest_speed_of_still(still_plane + turned, 2), 1e-3);
  EXPECT_LT(largest_speed_of_still(still_plane + through_the_wall, 5), 1e-3);
  const std::string ball = "[[body]]\nshape = \"ball\"\nposition = [0.83, 0.57, 0.52]\nradius = 0.31\n";
  EXPECT_LT(largest_speed_of_still(still_space + ball, 3), 1e-3);
}

// With extrapolated velocities of wall points in the rate of density, which were not adjoint to their pressures, sound
// grew in wedges between a body and the floor: 0.456 and 0.0089. Where pressure pressed particles into a wedge that
// none fits in, 6 g in the third scene, settling did not end: 0.023.
TEST(WcsphStillWater, StaysStillInAcuteWedges) {
  const std::string outline =
      "[[body]]\nshape = \"outline\"\npoints = [[-0.4, -0.3], [0.4, -0.3], [0.3, 0.1], [0.0, 0.35], [-0.35, 0.2]]\n";
  const auto ellipse = [](const std::string& place) { return "[[body]]\nshape = \"ellipsoid\"\n" + place; };
  EXPECT_LT(
      largest_speed_of_still(
          still_plane + ellipse("position = [0.6406, 0.2282]\nsemi_axes = [0.2158, 0.338]\nrotation = [155.411]\n") +
              outline + "position = [1.3834, 0.3469]\nrotation = [108.3905]\n",
          5),
      1e-3);
  EXPECT_LT(
      largest_speed_of_still(
          still_plane + ellipse("position = [0.4003, 0.2408]\nsemi_axes = [0.2856, 0.3768]\nrotation = [84.9222]\n"),
          5),
      1e-3);
  EXPECT_LT(largest_speed_of_still(still_plane + outline + "position = [0.3052, 0.3098]\nrotation = [119.1169]\n", 2),
            1e-3);
}

// A full tank, whose particles are shifted: under the whole weight of the water that stirred it by 0.05, with the speed
// of a fall by 0.004.
TEST(WcsphStillWater, StaysStillInAFullTank) {
  const std::string full = replaced(
      replaced(still_plane, "upper = [1.6, 1.3]", "upper = [1.6, 1.3]\ntop = \"free-slip\""), "upper = [1.6, 1.1]", "");
  EXPECT_LT(largest_speed_of_still(full, 20), 1e-3);
}

// The mean pressure of what lies below the height of 0.5.
double mean_pressure_of_pool(const wcsph::Flow& flow) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    if ((*flow.particles.position[1])[i] > 0.5) continue;
    sum += flow.pressure_at((*flow.excess)[i], i);
    ++count;
  }
  return sum / count;
}

// The pool below a drop settles, the drop falls as it is. The relaxation of its density stirs both, by 9e-3 and 3e-3;
// where it took the kernel sums of the lattice for those at rest, the pressure of the pool rose by 5 %.
TEST(WcsphStillWater, ADropAboveItFalls) {
  WcsphRun run(replaced(still_plane, "upper = [1.6, 1.1]", "upper = [1.6, 0.4]") +
               "[[region]]\nphase = \"water\"\ncentre = [0.8, 0.9]\nradius = 0.2\n");
  const wcsph::Flow& flow = run.method.flow();
  const double end = 0.4;
  run.prepare();
  const double at_rest = mean_pressure_of_pool(flow);
  until(run, end);
  EXPECT_NEAR(mean_pressure_of_pool(flow), at_rest, 0.005 * at_rest);
  double drop = 0, pool = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const Vec3 u = vector_at(flow.particles.velocity, 2, i);
    if ((*flow.particles.position[1])[i] > 0.5)
      drop = std::max(drop, std::hypot(u[0], u[1] + end));
    else
      pool = std::max(pool, std::hypot(u[0], u[1]));
  }
  EXPECT_LT(drop, 0.02);
  EXPECT_LT(pool, 5e-3);
}

// The step that settled them recorded the lattice before, and a potential energy of 0.2 % more.
TEST(WcsphStillWater, SettlesBeforeAnythingIsRecorded) {
  WcsphRun run(still_plane + still_ellipse);
  const double of_lattice = run.series()["potential_energy"];
  std::vector<std::string> told;
  run.method.prepare(run.ledger, [&](const HowFar& how_far) {
    told.push_back(how_far.words);
    return told.size() < 300;
  });
  EXPECT_EQ(told.size(), 300U);  // 380 rounds when nobody ends it
  EXPECT_EQ(told[9].substr(0, 25), "round 10 of at most 4000,");
  const double settled = run.series()["potential_energy"];
  EXPECT_GT(settled - of_lattice, 1e-3);
  run.method.step(run.method.step_limit().dt, run.ledger);
  EXPECT_NEAR(run.series()["potential_energy"], settled, 1e-6 * std::abs(settled));
}

TEST(WcsphStillWater, StartsAsFilledWhereNobodyAsksForMore) {
  WcsphRun run(still_plane, {"compressibility.settling_rounds=0"});
  EXPECT_FALSE(run.method.flow().features.rest.settles);
  EXPECT_EQ(run.method.flow().features.rest.reason, "compressibility.settling_rounds = 0");
  const double filled = run.series()["potential_energy"];
  run.prepare();
  EXPECT_NEAR(run.series()["potential_energy"], filled, 1e-14 * filled);  // summed in another order
}

// Particles move by up to two spacings while they settle.
TEST(WcsphStillWater, CarriesItsScalarsWhereItHasSettled) {
  WcsphRun run(still_plane + still_ellipse + "[[scalar]]\nname = \"height\"\ninitial = \"y\"\n");
  run.prepare();
  const wcsph::Flow& flow = run.method.flow();
  const Array<double>& height = flow.solutes.scalars->values(0);
  for (std::size_t i = 0; i < flow.size(); ++i) ASSERT_EQ(height[i], (*flow.particles.position[1])[i]);
}

// What cannot rest is said, with its place: a chamber that two particles fit in, which change places for ever.
TEST(WcsphStillWater, SaysWhatCannotRest) {
  WcsphRun run(
      still_plane +
      "[[body]]\nshape = \"box\"\nposition = [0.1165, 0.2162]\nsize = [0.5193, 0.3909]\nrotation = [158.4134]\n"
      "[[body]]\nshape = \"ellipsoid\"\nposition = [0.8864, 0.2152]\nsemi_axes = [0.2753, 0.4507]\n"
      "rotation = [78.0637]\n");
  run.steps(1, 1e-4);
  const std::vector<Remark> remarks = run.method.take_remarks();
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_TRUE(remarks[0].text.find("not at rest at the start: the particle at (") != std::string::npos);
  EXPECT_TRUE(run.method.take_remarks().empty());
}

}  // namespace
}  // namespace spume::test
