// SPDX-License-Identifier: MIT
// wcsph beside walls of bodies: still water stays still, no particle passes, forces and probes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "methods/method_run.hpp"
#include "spume/methods/wcsph/wcsph.hpp"

namespace spume::test {
namespace {

using BodiesRun = MethodRun<wcsph::Wcsph>;

std::string still(const std::string& upper, double spacing, double depth, bool air, const std::string& bodies) {
  const bool flat = std::count(upper.begin(), upper.end(), ',') == 1;
  const std::string lower = flat ? "[0, 0]" : "[0, 0, 0]";
  const std::string top = upper.substr(0, upper.rfind(',') + 1) + std::to_string(depth) + "]";
  return "method = \"wcsph\"\n[domain]\nlower = " + lower + "\nupper = " + upper +
         "\nleft = \"free-slip\"\nright = \"free-slip\"\n" +
         (flat ? "" : "front = \"free-slip\"\nback = \"free-slip\"\n") +
         "bottom = \"free-slip\"\ntop = \"free-slip\"\n[resolution]\nspacing = " + std::to_string(spacing) +
         "\n[fluid]\ngravity = 1\n[[phase]]\nname = \"water\"\ndensity = 1000\nviscosity = 1\n" +
         (air ? "[[phase]]\nname = \"air\"\ndensity = 1\nviscosity = 0.01\n[[region]]\nphase = \"air\"\n" : "") +
         "[[region]]\nphase = \"water\"\nupper = " + top + "\n" + bodies + "[time]\nend = 2\n";
}

// As the program does, with half of a step that is refused. The largest speed on the way.
double run_to(BodiesRun& run, double end) {
  double fastest = 0;
  while (run.method.time() < end - 1e-12) {
    double dt = std::min(run.method.step_limit().dt, end - run.method.time());
    for (int attempt = 0;; ++attempt, dt /= 2) try {
        run.steps(1, dt);
        break;
      } catch (const StepFailure&) {
        if (attempt == 3) throw;
      }
    fastest = std::max(fastest, run.method.flow().largest_speed);
  }
  return fastest;
}

std::string body(const std::string& text) {
  return "[[body]]\n" + text;
}
const std::string wedge = body("shape = \"outline\"\npoints = [[0.5, -0.1], [1, 0.5], [1.5, -0.1]]\n");

// Tanks are filled by whole sites, as many as the volume holds. A slot of 13 sites holds none: neither are these
// counted where they stand in it, nor is its room filled elsewhere.
TEST(WcsphBodies, ASlotTakesNoParticlesFromATankAndGivesItNone) {
  const double spacing = 0.05, width = 0.65, height = 0.3;
  for (const double slot : {0.2, 0.45}) {
    const BodiesRun run(still("[2, 1]", spacing, 1, false,
                              body("shape = \"box\"\nsize = [0.65, 0.3]\nposition = [1, " +
                                   std::to_string(slot * spacing + height / 2) + "]\n")));
    const double sites = (2 - width * (height + slot * spacing)) / (spacing * spacing);
    EXPECT_NEAR(static_cast<double>(run.method.flow().size()), sites, 2) << slot;
  }
}

// Particles go round periodic sides when lists are made, and what a wall pushes them along these stays.
TEST(WcsphBodies, APostInAPeriodicChannelHoldsWhatMeetsIt) {
  const BodiesRun run(
      "method = \"wcsph\"\n[domain]\nlower = [0, 0]\nupper = [1, 0.8]\nx = \"periodic\"\nbottom = \"free-slip\"\n"
      "top = \"free-slip\"\n[resolution]\nspacing = 0.04\n[[phase]]\nname = \"water\"\ndensity = 1\n"
      "viscosity = 1e-4\n[[region]]\nphase = \"water\"\n[[body]]\nshape = \"ball\"\n"
      "radius = 0.15\nposition = [0.84, 0.42]\n[compressibility]\nmax_speed = 1\n[time]\nend = 1\n");
  const wcsph::Flow& flow = run.method.flow();
  const BodyWalls& bodies = *flow.boundary.bodies();
  int beyond = 0, before = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const Vec3 from = vector_at(flow.particles.position, 2, i), normal = bodies.normal(from);
    const double distance = bodies.distance(from);
    if (!(distance < 0.04)) continue;
    // Into the post, and for those to the right of it by the image of the place one period on.
    const double period = normal[0] > 0.5 ? 1 : 0;
    Vec3 place = subtract(from, multiply(distance + 0.004, normal)), velocity = multiply(-1, normal);
    place[0] += period;
    flow.hold(i, place, velocity);
    place[0] -= period;
    EXPECT_GT(bodies.distance(place), 0.004 - 1e-9);
    EXPECT_NEAR(dot(velocity, normal), 0, 0.02);
    ++(period > 0 ? beyond : before);
  }
  EXPECT_GT(beyond, 3);
  EXPECT_GT(before, 3);
}

// The weight of the column of one kernel support above a wall drives what its arrangement does not balance: speeds stay
// below those of a fall through the support radius, 2.6 spacings, times the tenth of the weight that a step of a
// staircase of particles along the wall is off by at most.
TEST(WcsphBodies, StillWaterStaysStillOverThem) {
  struct Scene {
    const char* name;
    std::string text;
    double spacing;
  };
  const double s = 0.05;
  for (const Scene& scene : {Scene{"a wedge", still("[2, 1.2]", s, 0.8, false, wedge), s},
                             Scene{"a box off the lattice",
                                   still("[2, 1.2]", s, 0.8, false,
                                         body("shape = \"box\"\nsize = [0.513, 0.387]\nposition = [1.013, 0.417]\n"
                                              "rotation = [17]\n")),
                                   s},
                             Scene{"boxes that touch",
                                   still("[2, 1.2]", s, 0.8, false,
                                         body("shape = \"box\"\nsize = [0.5, 0.4]\nposition = [0.8, 0.2]\n") +
                                             body("shape = \"box\"\nsize = [0.4, 0.25]\nposition = [1.25, 0.125]\n"
                                                  "wall = \"no-slip\"\n")),
                                   s},
                             Scene{"air over water with a disc",
                                   still("[2, 1.2]", s, 0.6, true,
                                         body("shape = \"ball\"\nradius = 0.3\nposition = [1, 0.6]\n"
                                              "wall = \"no-slip\"\n")),
                                   s},
                             Scene{"a ball, in three dimensions",
                                   still("[0.8, 0.8, 0.9]", 0.1, 0.6, false,
                                         body("shape = \"ball\"\nradius = 0.2\nposition = [0.41, 0.4, 0.3]\n")),
                                   0.1}}) {
    SCOPED_TRACE(scene.name);
    BodiesRun run(scene.text);
    const wcsph::Flow& flow = run.method.flow();
    run_to(run, 1);
    double speed = 0;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      const Vec3 r = vector_at(flow.particles.position, flow.dimensions, i);
      EXPECT_GT(run.loaded.scene.walls.distance(r), 0);
      if (flow.phase_of(i) == 0)
        speed = std::max(speed, std::sqrt(squared_norm(flow.particles.velocity, flow.dimensions, i)));
    }
    EXPECT_LT(speed, std::sqrt(2 * 2.6 * scene.spacing * 0.1));
    EXPECT_LT(run.series().at("density_change_water"), 0.01);
  }
}

// Archimedes: the force on a disc in still water is its weight in water. Sums see the wall as a layer of the width of
// a spacing; its perimeter times a quarter of that is the share by which the area may be off.
TEST(WcsphBodies, TheForceOnASubmergedDiscIsItsBuoyancy) {
  const double spacing = 0.05, radius = 0.3, area = std::numbers::pi * radius * radius;
  BodiesRun run(still("[2, 1.2]", spacing, 1, false,
                      body("shape = \"ball\"\nradius = 0.3\nposition = [1, 0.5]\nwall = \"no-slip\"\n")));
  run_to(run, 1);
  double sum = 0;
  const int samples = 20;
  for (int n = 0; n < samples; ++n) {
    run_to(run, 1 + 0.05 * (n + 1));
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    ASSERT_EQ(rows.size(), 8U);
    sum += rows[3] / samples;
  }
  EXPECT_NEAR(sum / (1000 * area), 1, 2 * std::numbers::pi * radius * spacing / 4 / area);
}

// The sampler's linear fit with the hydrostatic part apart: what is left is the noise of the pressures, in the range of
// the waves of the first second, 2 % of the depth.
TEST(WcsphBodies, ProbesReadTheFieldsAtAPoint) {
  BodiesRun run(still("[2, 1.2]", 0.05, 1, false, wedge));
  run_to(run, 1);
  FieldProbes* probes = run.method.field_probes();
  ASSERT_NE(probes, nullptr);
  for (const double y : {0.6, 0.3, 0.12})
    EXPECT_NEAR(probes->sample({0.2, y, 0}).scalars[0], 1000 * (1 - y), 20 + 0.5 * 0.05 * 1000) << y;
  EXPECT_TRUE(std::isnan(probes->sample({1, 0.1, 0}).scalars[0])) << "inside the wedge";
}

// Water that a piston of a body pushes is as fast as it, and none gets past it.
TEST(WcsphBodies, APistonTakesTheLiquidAlong) {
  BodiesRun run(still("[1.5, 1]", 0.05, 0.4, false,
                      body("shape = \"box\"\nsize = [0.4, 2]\nposition = [0.1, 0.5]\ndisplacement = [\"0.2*t*t\", "
                           "\"0\"]\n")));
  run_to(run, 0.5);
  const wcsph::Flow& flow = run.method.flow();
  double beside = 0, count = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double x = (*flow.particles.position[0])[i];
    EXPECT_GT(x, 0.35 - 1e-9);
    if (x > 0.4) continue;
    beside += (*flow.particles.velocity[0])[i];
    ++count;
  }
  ASSERT_GT(count, 0);
  EXPECT_NEAR(beside / count, 0.2, 0.02);
}

std::string growing_disc(const std::string& way) {
  return still("[2, 2]", 0.05, 0.8, false,
               body("shape = \"ball\"\nradius = 0.15\nposition = [1.01, 0.3]\ndisplacement = [\"0\", \"" + way +
                    "\"]\nrelease_interval = 6\nrelease_duration = 2.4\nrelease_growth = 0.4\n"));
}

double mean_height(const wcsph::Flow& flow) {
  double sum = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) sum += (*flow.particles.position[1])[i];
  return sum / static_cast<double>(flow.size());
}

// A disc that has grown in water lifts the water's centre of mass by its area times how deep it is, over the area of
// the water. Its surface is as good as half a spacing. The lift is averaged over the sloshing, of period 2 (width 2,
// depth 0.8, second mode).
TEST(WcsphBodies, AGrowingBodyDisplacesItsVolume) {
  BodiesRun run(growing_disc("0"));
  const wcsph::Flow& flow = run.method.flow();
  EXPECT_EQ(std::lround(2 * 0.8 / (0.05 * 0.05)), flow.size());
  const double before = mean_height(flow);
  double lift = 0;
  for (int n = 0; n < 20; ++n) {
    run_to(run, 0.4 + 0.1 * n);
    lift += (mean_height(flow) - before) / 20;
  }
  const double area = std::numbers::pi * 0.15 * 0.15, expected = area * (0.8 - 0.3) / (2 * 0.8);
  EXPECT_NEAR(lift, expected, expected * 0.05 / 0.15);
}

// It rises through the surface and is taken away, twice; nothing is left in it, and nothing where it waits. A fall
// through the depth gives 1.3; particles between the disc and the surface reached 4.5 to 6.7 where the stress at its
// wall followed their pressure.
TEST(WcsphBodies, AReleasedBodyLeavesThroughTheSurfaceAndComesBack) {
  BodiesRun run(growing_disc("0.5*(t - 0.2*(1 - exp(-5*t)))"));
  const wcsph::Flow& flow = run.method.flow();
  ASSERT_EQ(flow.scene.bodies.size(), 1U);
  const std::size_t particles = flow.size();
  for (const double start : {0.0, 6.0}) {
    for (const double t : {0.02, 0.3, 0.6, 1.2, 1.8, 2.3}) {
      EXPECT_LT(run_to(run, start + t), 3);
      for (std::size_t i = 0; i < particles; ++i) {
        const Vec3 r = vector_at(flow.particles.position, 2, i);
        EXPECT_GT(flow.boundary.bodies()->distance(r), 0) << t;
        EXPECT_TRUE(r[0] > 0 && r[0] < 2 && r[1] > 0 && r[1] < 2) << t;
      }
    }
    run_to(run, start + 5.9);
    EXPECT_EQ(flow.boundary.bodies()->distance({1.01, 0.3, 0}), infinite);
    double there = 0;
    for (std::size_t i = 0; i < particles; ++i) {
      const Vec3 r = vector_at(flow.particles.position, 2, i);
      if (std::hypot(r[0] - 1.01, r[1] - 0.3) < 0.15) ++there;
    }
    // Water again: the disc has room for 28 particles.
    EXPECT_NEAR(there * 0.05 * 0.05, std::numbers::pi * 0.15 * 0.15, std::numbers::pi * 0.15 * 0.05);
  }
  EXPECT_EQ(flow.size(), particles);
}

// Mirrors hold none of the particles that an impact presses against them: without the stress (8) seven in a hundred
// rest within a fiftieth of a spacing of a side at t = 6, and every fiftieth at t = 2.
TEST(WcsphBodies, ParticlesLeaveTheSidesAfterAnImpact) {
  const double spacing = 1.0 / 12;
  BodiesRun run(
      replaced(still("[3.2, 1, 2]", spacing, 1, false, ""), "upper = [3.2, 1,1.000000]", "upper = [1, 1, 1]"));
  const wcsph::Flow& flow = run.method.flow();
  ASSERT_EQ(flow.size(), 1728U);
  for (const double t : {2.0, 3.0}) {
    run_to(run, t);
    double stuck = 0;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      const Vec3 r = vector_at(flow.particles.position, 3, i);
      double gap = INFINITY;
      for (std::size_t axis = 0; axis < 3; ++axis)
        gap = std::min({gap, r[axis], flow.scene.domain.upper[axis] - r[axis]});
      if (gap < spacing / 50) ++stuck;
    }
    EXPECT_LT(stuck / 1728, 0.01) << "at t = " << t;
  }
}

}  // namespace
// Water 1 m deep on the left of a plate one spacing thick and 0.5 m on the right. Sound goes to and fro in both, so the
// force is a mean over time: that of hydrostatics within 0.2 %, and 2 % off when the two sides act on each other.
TEST(WcsphBodies, TwoLevelsBesideAThinPlateDoNotActOnEachOther) {
  BodiesRun run(still("[1.6, 1.3]", 0.05, 1, false,
                      "[[region]]\nphase = \"water\"\nlower = [0.85, 0]\nupper = [1.6, 0.5]\n" +
                          body("shape = \"box\"\nsize = [0.05, 4]\nposition = [0.825, 0.5]\nwall = \"no-slip\"\n")),
                {"region.0.upper=[0.8, 1]"});
  double sum = 0;
  constexpr int samples = 200;
  run_to(run, 2);
  for (int k = 0; k < samples; ++k) {
    run_to(run, 2 + 2.0 * (k + 1) / samples);
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    sum += rows[2] / samples;
  }
  EXPECT_NEAR(sum, 375, 0.005 * 375);
}

}  // namespace spume::test
