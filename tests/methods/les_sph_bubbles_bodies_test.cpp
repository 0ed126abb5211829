// SPDX-License-Identifier: MIT
// Bubbles beside walls of bodies: what they exchange with the liquid there, and that they stay in it.
#include <gmock/gmock.h>
#include <omp.h>

#include "methods/les_sph_simulation.hpp"
#include "reference/gas_exchange.hpp"
#include "spume/physics/bubbles/coupling.hpp"

namespace spume::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Gas and liquid between a round wall and a ball that moves: sources, breakup and entrainment at work.
const std::string round_stirred_tank = R"toml(method = "les-sph"
[domain]
lower = [-0.7, -0.7, 0]
upper = [0.7, 0.7, 1.5]
bottom = "no-slip"
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e4
froude = 1
mach = 0.05
[[liquid]]
where = "0.8 - z"
velocity = ["-2*y", "2*x", "0"]
[[body]]
shape = "cylinder"
radius = 0.65
length = 4
inside = false
wall = "no-slip"
[[body]]
name = "stirrer"
shape = "ball"
radius = 0.25
position = [0, 0, 0.4]
displacement = ["0.1*sin(10*t)", "0", "0.05*sin(10*t)"]
wall = "free-slip"
[turbulence]
model = "mixed-scale"
[bubbles]
weber = 1e4
entrainment = true
breakup = true
fluctuations = true
[[sparger]]
position = [0.45, 0, 0.1]
rate = "0.05*t"
sizes = "log-normal"
bubble_radius = 0.01
deviation = 0.4
[[bubble_cloud]]
lower = [-0.4, -0.4, 0.1]
upper = [0.4, 0.4, 0.7]
number = 300
bubble_radius = 0.03
[time]
end = 1
)toml";

// Under a plank that rises to the right by 30 degrees, a bubble.
const std::string sloping_plank = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [2, 0.8, 1.8]
left = "free-slip"
right = "free-slip"
y = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e4
froude = 1
mach = 0.05
[[liquid]]
where = "1.6 - z"
[[body]]
shape = "box"
size = [1.2, 4, 0.6]
position = [0.8, 0.4, 0.9]
rotation = [0, -30, 0]
wall = "free-slip"
[bubbles]
weber = 1e3
[[bubble_cloud]]
centre = [0.8, 0.4, 0.5]
bubble_radius = 0.005
[time]
end = 10
)toml";

// A uniform swarm between two walls, as far as the corners: of bodies, or with their planes as sides of the domain.
std::string swarm_in_corner(bool bodies) {
  return std::string(R"toml(method = "les-sph"
[domain]
)toml") + (bodies ? "lower = [-0.4, -0.4, 0]\n" : "lower = [0, 0, 0]\nleft = \"free-slip\"\nfront = \"no-slip\"\n") +
         R"toml(upper = [0.8, 0.8, 0.8]
right = "free-slip"
back = "free-slip"
z = "periodic"
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e3
mach = 0.05
[[liquid]]
lower = [0, 0, 0]
upper = [0.8, 0.8, 0.8]
)toml" +
         (bodies ? R"toml([[body]]
shape = "half-space"
normal = [1, 0, 0]
wall = "free-slip"
[[body]]
shape = "half-space"
normal = [0, 1, 0]
wall = "no-slip"
)toml"
                 : "") +
         R"toml([bubbles]
weber = 1e3
[[bubble_cloud]]
lower = [0, 0, 0]
upper = [0.8, 0.8, 0.8]
number = 4000
bubble_radius = 0.015
[time]
end = 1
)toml";
}

const bubbles::BubbleCoupling& swarm_of(const Simulation& run) {
  return *run.method.flow().bubbles;
}

Vec3 bubble_place(const Simulation& run, std::size_t b) {
  return vector_at(swarm_of(run).population().position, 3, b);
}

double received_by_liquid(const Simulation& run, int axis) {
  const les_sph::Flow& flow = run.method.flow();
  double sum = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) sum += (*flow.bubbles->exchange()[axis])[i];
  return sum * flow.particles.volume;
}

std::vector<std::vector<double>> saved_of(const Simulation& run) {
  std::vector<std::vector<double>> state;
  for (const auto& [name, values] : run.saved_state()) state.push_back(values);
  return state;
}

TEST(BubblesBesideBodies, GiveTheLiquidWhatItReceives) {
  for (const std::string& text : {round_stirred_tank, swarm_in_corner(true)}) {
    Simulation run(text, {"fluid.froude=1"});
    for (int k = 0; k < 5; ++k) {
      run.steps(1, 0.004);
      const Vec3 given = swarm_of(run).total_reaction();
      double size = 0;
      for (const double component : given) size += std::abs(component);
      ASSERT_GT(size, 0);
      // Float weights: a few roundings each.
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(received_by_liquid(run, axis), given[axis], 2e-6 * size);
    }
  }
}

// The same bubbles beside planes of bodies and of the domain: the same share of gas in all and in the layer at each
// wall, and the same velocities. The particles are not the same: those beside bodies are evened out.
TEST(BubblesBesideBodies, SeeAPlaneAsASideOfTheDomain) {
  const Overrides gravity = {"fluid.froude=1", "forces.body=[\"0\",\"0\",\"1\"]"};
  Simulation body(swarm_in_corner(true), gravity), side(swarm_in_corner(false), gravity);
  body.steps(3, 0.004);
  side.steps(3, 0.004);
  const auto mean_gas = [](const Simulation& run, const Vec3& lower, const Vec3& upper) {
    const les_sph::Flow& flow = run.method.flow();
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      const Vec3 r = vector_at(flow.particles.position, 3, i);
      if (r[0] < lower[0] || r[1] < lower[1] || r[0] > upper[0] || r[1] > upper[1]) continue;
      sum += 1 - flow.bubbles->volume_fraction()[i];
      ++count;
    }
    return sum / count;
  };
  const double whole = mean_gas(side, {0, 0}, {1, 1});
  EXPECT_NEAR(mean_gas(body, {0, 0}, {1, 1}), whole, 0.02 * whole);
  // Without reflections a quarter is missing in the layer at a wall.
  EXPECT_NEAR(mean_gas(body, {0, 0.3}, {0.1, 1}), mean_gas(side, {0, 0.3}, {0.1, 1}), 0.03 * whole);
  EXPECT_NEAR(mean_gas(body, {0.3, 0}, {1, 0.1}), mean_gas(side, {0.3, 0}, {1, 0.1}), 0.03 * whole);
  double rise[2] = {};
  for (const Simulation* run : {&body, &side})
    for (std::size_t b = 0; b < 4000; ++b) rise[run == &body ? 0 : 1] += (*swarm_of(*run).population().velocity[2])[b];
  EXPECT_NEAR(rise[0] / rise[1], 1, 0.01);
}

// Along the plank it has the slip of gravity times sin 30, exactly, and does not leave it.
TEST(BubblesBesideBodies, SlideAlongASlope) {
  Simulation run(sloping_plank);
  const BodyWalls& wall = *run.method.flow().boundary.bodies();
  const double steepness = 0.5;
  int touching = 0;
  for (int k = 0; k < 160; ++k) {
    run.steps(1, 0.02);
    const Vec3 r = bubble_place(run, 0);
    ASSERT_GT(wall.distance(r), 0);
    if (wall.distance(r) > 1.1e-4) continue;  // the gap is a thousandth of a spacing
    const Vec3 u = vector_at(swarm_of(run).population().velocity, 3, 0), normal = wall.normal(r);
    EXPECT_NEAR(u[0] * normal[0] + u[2] * normal[2], 0, 1e-3 * std::hypot(u[0], u[2]));
    if (++touching < 10) continue;
    const bubbles::Gas less{.density_ratio = run.loaded.options.get<BubbleOptions>().density_ratio,
                            .viscosity = 1e-4,
                            .gravity = {0, 0, -steepness}};
    EXPECT_NEAR((*swarm_of(run).population().slip)[0], bubbles::terminal_speed(less, 0.005),
                4e-5);  // the liquid along gains speed
    EXPECT_GT(u[0], 0.5 * (*swarm_of(run).population().slip)[0]);
    EXPECT_GT(u[2], 0.2 * (*swarm_of(run).population().slip)[0]);
  }
  EXPECT_GT(touching, 40);
}

// Inside a pipe that lies, a wall that bends under way: the slip along it is that of gravity times the sine of the
// angle from the crown, as on a slope, with strides of a fifth of a spacing and a radius of
// five.
TEST(BubblesBesideBodies, SlideAlongAVault) {
  Simulation run(R"toml(method = "les-sph"
[domain]
lower = [-0.6, 0, -0.6]
upper = [0.6, 0.8, 0.6]
y = "periodic"
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e4
froude = 1
mach = 0.05
[[liquid]]
[[body]]
shape = "cylinder"
radius = 0.5
length = 4
rotation = [90, 0, 0]
inside = false
wall = "free-slip"
[bubbles]
weber = 1e3
[[bubble_cloud]]
centre = [0.46, 0.4, 0.05]
bubble_radius = 0.02
[time]
end = 10
)toml");
  const BodyWalls& wall = *run.method.flow().boundary.bodies();
  const double dt = 0.15;
  int touching = 0;
  for (int k = 0; k < 60; ++k) {
    run.steps(1, dt);
    const Vec3 r = bubble_place(run, 0);
    ASSERT_GT(wall.distance(r), 0);
    // The gap is a thousandth of a spacing. By the crown the slip goes down with the slope.
    if (wall.distance(r) > 1.1e-4 || ++touching < 5 || r[0] < 0.15) continue;
    // By what it turns in a step, where it was and where it will be differ.
    const double angle = std::atan2(r[0], r[2]), slip = (*swarm_of(run).population().slip)[0], turn = slip * dt / 0.5;
    const auto terminal = [&](double at) {
      return bubbles::terminal_speed({.density_ratio = run.loaded.options.get<BubbleOptions>().density_ratio,
                                      .viscosity = 1e-4,
                                      .gravity = {0, 0, -std::sin(at)}},
                                     0.02);
    };
    EXPECT_GT(slip, terminal(angle - turn)) << k;
    EXPECT_LT(slip, terminal(angle + turn)) << k;
  }
  EXPECT_GT(touching, 10);
}

// Below a lid, a box and a ridge bubbles rest, and what presses them stirs nothing.
TEST(BubblesBesideBodies, RestUnderACeiling) {
  const std::string tank = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.8, 0.8, 1]
left = "free-slip"
right = "free-slip"
y = "periodic"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e3
froude = 1
mach = 0.05
[[liquid]]
[bubbles]
weber = 1e3
[[bubble_cloud]]
lower = [0.3, 0.1, 0.3]
upper = [0.5, 0.7, 0.4]
number = 10
bubble_radius = 0.02
[time]
end = 10
)toml";
  const std::string box = "[[solid]]\nlower = [0, 0, 0.7]\nupper = [0.8, 0.8, 1]\n",
                    ridge =
                        "[[body]]\nshape = \"outline\"\npoints = [[-0.4, 0.55], [0.4, 0.85], [1.2, 0.55], [1.2, "
                        "1.5], [-0.4, 1.5]]\nwall = \"free-slip\"\n";
  for (const std::string& ceiling : {std::string(), box, ridge}) {
    SCOPED_TRACE(ceiling);
    Simulation run(tank + ceiling);
    run.steps(200, 0.05);
    const double before = run.series()["kinetic_energy"];
    run.steps(40, 0.05);
    EXPECT_LT(run.series()["kinetic_energy"], before);
    // Of a terminal speed of 0.068, with which they arrive at t = 9 at the latest. In the edge of the ridge they go to
    // and fro between its faces, a gap wide.
    EXPECT_LT(run.series()["bubble_slip"], ceiling == ridge ? 0.068 / 3 : 0.004);
  }
}

TEST(BubblesBesideBodies, StayOutOfSolidsAndKeepTheirVolume) {
  Simulation run(round_stirred_tank);
  const BodyWalls& wall = *run.method.flow().boundary.bodies();
  for (int k = 0; k < 60; ++k) {
    run.steps(1, 0.004);
    const auto& population = swarm_of(run).population();
    for (std::size_t b = 0; b < population.size(); ++b)
      ASSERT_GT(wall.distance(bubble_place(run, b)), 0) << k << ' ' << b;
    const auto& history = swarm_of(run).history();
    const double came = history.injected_volume + history.entrained_volume;
    EXPECT_NEAR(population.total_volume() + history.burst_volume, came, 1e-12 * came);
  }
  EXPECT_GT(swarm_of(run).history().entrained, 0);
  EXPECT_GT(swarm_of(run).history().breakups, 0);
  EXPECT_GT(swarm_of(run).history().injected, 300);
}

TEST(BubblesBesideBodies, DoNotDependOnThreadsOrInterruptions) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(3);
  Simulation straight(round_stirred_tank);
  straight.steps(12, 0.004);
  MemoryState saved;
  straight.method.save(saved);
  straight.steps(6, 0.004);
  omp_set_num_threads(1);
  Simulation other(round_stirred_tank), restored(round_stirred_tank);
  other.steps(18, 0.004);
  omp_set_num_threads(before);
  restored.method.load(saved);
  restored.steps(6, 0.004);
  EXPECT_TRUE(saved_of(other) == saved_of(straight));
  EXPECT_TRUE(saved_of(restored) == saved_of(straight));
}

// What bubbles lose of oxygen beside a round wall, particles gain.
TEST(BubblesBesideBodies, GiveTheirOxygenToTheLiquid) {
  const std::string text = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.1, 0.1, 0.16]
bottom = "no-slip"
[resolution]
spacing = 0.01
[fluid]
density = 1000
viscosity = 1e-3
gravity = 9.81
[[liquid]]
where = "0.1 - z"
[[body]]
shape = "cylinder"
radius = 0.045
length = 1
position = [0.05, 0.05, 0]
inside = false
[bubbles]
surface_tension = 0.072
[[bubble_cloud]]
lower = [0.02, 0.02, 0.01]
upper = [0.08, 0.08, 0.09]
number = 200
bubble_radius = 0.002
[oxygen]
[time]
end = 1
)toml";
  Simulation run(text);
  run.steps(20, 0.003);
  const les_sph::Flow& flow = run.method.flow();
  double received = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) received += flow.particles.volume * flow.bubbles->dissolution()[i];
  EXPECT_GT(flow.bubbles->dissolved_amount(), 0);
  EXPECT_NEAR(received / flow.bubbles->dissolved_amount(), 1, 2e-6);
}

TEST(BubblesBesideBodies, SpargersInSolidsAreRefused) {
  const auto refused = [](const std::string& text, const std::string& message) {
    EXPECT_THAT(problems_of(text), Contains(HasSubstr(message)));
  };
  refused(replaced(round_stirred_tank, "position = [0.45, 0, 0.1]", "position = [0, 0, 0.2]"),
          "sparger.0 reaches into a solid: (0, 0, 0.2) lies in the body \"stirrer\"");
  refused(replaced(round_stirred_tank, "lower = [-0.4, -0.4, 0.1]\nupper = [0.4, 0.4, 0.7]", "centre = [0, 0, 0.4]"),
          "bubble_cloud.0 lies in the body \"stirrer\"");
  refused(replaced(round_stirred_tank, "position = [0.45, 0, 0.1]",
                   "shape = \"disc\"\nradius = 0.3\nposition = [0.45, 0, 0.1]"),
          "sparger.0 reaches into a solid");
}

}  // namespace
}  // namespace spume::test
