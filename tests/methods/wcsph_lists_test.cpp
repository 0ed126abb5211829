// SPDX-License-Identifier: MIT
// Lists of neighbours of wcsph live on while particles go together; they name everybody within the support all the
// same.
#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

const std::string collapse = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1.6, 1]
left = "free-slip"
right = "free-slip"
bottom = "no-slip"
[resolution]
spacing = 0.04
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1000
viscosity = 0.5
[[region]]
phase = "water"
upper = [0.5, 0.7]
[time]
end = 1
)toml";

const std::string vortices_in_stream = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.0333333333333333333
[[phase]]
name = "liquid"
density = 1
viscosity = 0.001
[[region]]
phase = "liquid"
velocity = ["0.8 + 0.3*sin(2*pi*x)*cos(2*pi*y)", "-0.3*cos(2*pi*x)*sin(2*pi*y)"]
[time]
end = 1
)toml";

const std::string channel = R"toml(method = "wcsph"
[domain]
lower = [0, 0, 0]
upper = [1, 1, 0.8]
x = "periodic"
y = "periodic"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.1
[[phase]]
name = "heavy"
density = 2
viscosity = 0.01
[[phase]]
name = "light"
density = 1
viscosity = 0.01
[[region]]
phase = "light"
velocity = ["1", "0.03*sin(2*pi*x)", "0"]
[[region]]
phase = "heavy"
velocity = ["1", "0", "0"]
centre = [0.5, 0.5, 0.4]
radius = 0.25
[time]
end = 1
)toml";

// Of all particles and all their copies beyond one side of every axis, where the last step has left them.
std::size_t neighbours_of(const wcsph::Flow& flow, std::size_t i, double support_radius) {
  const ImageRules rules = flow.boundary.image_rules(support_radius);
  std::size_t count = 0;
  for (std::size_t j = 0; j < flow.size(); ++j)
    for (int path = 0; path < (flow.dimensions == 3 ? 27 : 9); ++path) {
      double squares = 0;
      bool exists = i != j || path > 0;
      for (int axis = 0, digits = path; axis < flow.dimensions; ++axis, digits /= 3) {
        const int side = digits % 3 - 1;
        double x = (*flow.particles.position[axis])[j];
        if (side >= 0) {
          const ImageKind kind = rules.sides[axis][side];
          exists = exists && kind != ImageKind::none;
          if (kind == ImageKind::mirror)
            x = 2 * (side == 0 ? rules.lower[axis] : rules.upper[axis]) - x;
          else
            x += (side == 0 ? -1 : 1) * (rules.upper[axis] - rules.lower[axis]);
        }
        const double distance = x - (*flow.particles.position[axis])[i];
        squares += distance * distance;
      }
      if (exists && squares < support_radius * support_radius) ++count;
    }
  return count;
}

// A batch that is not full repeats its first neighbour.
std::size_t listed_neighbours_of(const wcsph::Flow& flow, std::size_t i, double support_radius) {
  const NeighbourList& list = flow.arrangement.list;
  std::set<std::int32_t> points;
  if (list.narrow()) {
    const NarrowBatches batches = list.batches(i);
    for (std::size_t b = 0; b < batches.size; ++b)
      for (std::size_t l = 0; l < simd::pair_lanes; ++l)
        points.insert(batches.base[b] / entry_scale + batches.code[b * simd::pair_lanes + l]);
  } else {
    for (const std::int32_t point : list.of(i)) points.insert(point);
  }
  return static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](std::int32_t point) {
    double squares = 0;
    for (int axis = 0; axis < flow.dimensions; ++axis) {
      const double distance = double{list.coordinate(axis)[point]} - list.coordinate(axis)[i];
      squares += distance * distance;
    }
    return squares < support_radius * support_radius;
  }));
}

class WcsphListsOf : public ::testing::TestWithParam<std::string> {};

TEST_P(WcsphListsOf, NameEverybodyWithinTheSupportForLongerThanHalfASkin) {
  WcsphRun run(GetParam());
  const wcsph::Flow& flow = run.method.flow();
  // Those on the edge of the support, where the kernel is nought, may be on either side of it in float coordinates.
  const double edge = 1e-5 * flow.resolution.spacing;
  double longest = 0;
  for (int step = 0; step < 60; ++step) {
    const std::int64_t builds = flow.list_builds;
    run.steps(1, run.method.step_limit().dt);
    for (std::size_t i = 0; i < flow.size(); ++i) {
      if (step % (flow.dimensions == 3 ? 5 : 3) == 0) {
        ASSERT_GE(listed_neighbours_of(flow, i, flow.resolution.support_radius + edge),
                  neighbours_of(flow, i, flow.resolution.support_radius))
            << "particle " << i << " after step " << step;
      }
      for (int axis = 0; axis < flow.dimensions && flow.list_builds == builds; ++axis)
        longest = std::max(longest, std::abs((*flow.particles.position[axis])[i] - flow.listed_at(axis, i)));
    }
  }
  EXPECT_GT(longest, 1.1 * flow.skin / 2) << "the lists were made anew as if particles went alone";
}

// A stream carries sin(2 pi x) along, so that v = 0.1 sin(2 pi (x - t)) for any viscosity this small.
TEST(WcsphLists, WhoLooksSeesParticlesInsideAndAllAroundPeriodicSides) {
  std::string text = vortices_in_stream;
  const std::string before = "[\"0.8 + 0.3*sin(2*pi*x)*cos(2*pi*y)\", \"-0.3*cos(2*pi*x)*sin(2*pi*y)\"]";
  text.replace(text.find(before), before.size(), "[\"1\", \"0.1*sin(2*pi*x)\"]");
  text.replace(text.find("0.001"), 5, "1e-5");
  WcsphRun run(text);
  double outside = 0, error = 0;
  for (int step = 0; step < 60; ++step) {
    run.steps(1, run.method.step_limit().dt);
    for (const double x : (*run.method.flow().particles.position[0])) outside = std::max(outside, x - 1);
    const ParticleSnapshot seen = run.method.snapshot_on_demand()[0];
    for (std::size_t i = 0; i < seen.size; ++i) {
      ASSERT_GE(seen.position[0][i], 0);
      ASSERT_LE(seen.position[0][i], 1);
    }
    // Thirty columns, one of which may have gone round: half a spacing off the middle at most.
    EXPECT_NEAR(run.series().at("centre_liquid_x"), 0.5, 0.51 / 30);
    FieldProbes* const probes = run.method.field_probes();
    for (const double x : {0.001, 0.105, 0.115, 0.125, 0.999})
      error = std::max(error, std::abs(probes->sample({x, 0.51, 0}).velocity[1] -
                                       0.1 * std::sin(2 * std::numbers::pi * (x - run.method.time()))));
  }
  EXPECT_GT(outside, 2 * run.method.flow().skin) << "nobody has gone far enough for the test to see anything";
  // A linear fit to a wave of 30 spacings misses h^2 v'' / 2 of it at most, 0.037.
  EXPECT_LT(error, 0.1 * 0.037);
}

// Two drops that run into each other have to have new lists as soon as one has gone half a skin: after some vain looks
// there are fewer of them. A stream keeps on looking.
TEST(WcsphLists, TheBoundIsNotAskedForWhereItDoesNotHelp) {
  WcsphRun drops(R"toml(method = "wcsph"
[domain]
lower = [-1, -0.6]
upper = [1, 0.6]
[resolution]
spacing = 0.04
[[phase]]
name = "water"
density = 1000
viscosity = 0.5
[[region]]
phase = "water"
centre = [-0.4, 0.02]
radius = 0.3
velocity = ["1", "0"]
[[region]]
phase = "water"
centre = [0.4, -0.02]
radius = 0.3
velocity = ["-1", "0"]
[time]
end = 1
)toml");
  for (int step = 0; step < 400; ++step) drops.steps(1, 0.4 * drops.method.step_limit().dt);
  // In vain in the lists 1, 3, 7, 15, ...: of the first 31 in five.
  const std::int64_t lists = drops.method.flow().list_builds;
  EXPECT_GT(lists, 31);
  EXPECT_LT(drops.method.flow().list_life.asked(), 5 + lists / 8);
  WcsphRun stream(vortices_in_stream);
  std::int64_t before = 0;
  for (int step = 0; step < 40; ++step) {
    const std::int64_t builds = stream.method.flow().list_builds;
    stream.steps(1, stream.method.step_limit().dt);
    const std::int64_t asked = stream.method.flow().list_life.asked();
    if (step > 0 && stream.method.flow().list_builds > builds) EXPECT_GT(asked, before) << "without a question";
    before = asked;
  }
}

// What the lists have in hand is then the bound's, and so is when they end.
TEST(WcsphLists, ALifeThatTheBoundProlongsIsRestored) {
  WcsphRun straight(vortices_in_stream);
  const wcsph::Flow& flow = straight.method.flow();
  const auto longest_way = [&] {
    double longest = 0;
    for (std::size_t i = 0; i < flow.size(); ++i)
      for (int axis = 0; axis < 2; ++axis)
        longest = std::max(longest, std::abs((*flow.particles.position[axis])[i] - flow.listed_at(axis, i)));
    return longest;
  };
  do {
    straight.steps(1, straight.method.step_limit().dt);
    ASSERT_LT(straight.method.time(), 1) << "no list lives for longer than half a skin";
  } while (longest_way() <= flow.skin);
  MemoryState saved;
  straight.method.save(saved);
  WcsphRun restored(vortices_in_stream);
  restored.method.load(saved);
  const std::int64_t builds = flow.list_builds;
  for (int step = 0; step < 30; ++step) {
    const double dt = straight.method.step_limit().dt;
    straight.steps(1, dt);
    restored.steps(1, dt);
    // The first of the restored are those that were there.
    EXPECT_EQ(restored.method.flow().list_builds - 1, flow.list_builds - builds) << step;
  }
  EXPECT_GT(flow.list_builds, builds + 1);
  EXPECT_EQ(restored.saved_state(), straight.saved_state());
}

// A single particle is moved by nothing but the force, which is known between the sides. It goes on outside them until
// its lists end.
TEST(WcsphLists, ForcesActWhereAParticleIsBetweenPeriodicSides) {
  std::string text = vortices_in_stream;
  text.replace(text.find("0.0333333333333333333"), 21, "0.1");
  text.replace(text.find("velocity ="), text.find("\n[time]") - text.find("velocity ="),
               "lower = [0.8, 0.5]\nupper = [0.9, 0.6]\nvelocity = [\"1\", \"0\"]");
  text.replace(text.find("[resolution]"), 12, "[forces]\nbody = [\"0\", \"x\"]\n[resolution]");
  WcsphRun run(text);
  double outside = 0;
  for (int step = 0; step < 60; ++step) {
    run.steps(1, run.method.step_limit().dt);
    const wcsph::Flow& flow = run.method.flow();
    const double x = (*flow.particles.position[0])[0];
    outside = std::max(outside, x - 1);
    EXPECT_NEAR((*flow.acceleration[1])[0], x >= 1 ? x - 1 : x, 1e-6) << x;
  }
  EXPECT_GT(outside, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Scenes, WcsphListsOf, ::testing::Values(collapse, vortices_in_stream, channel));

}  // namespace
}  // namespace spume::test
