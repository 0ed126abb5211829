// SPDX-License-Identifier: MIT
// Bubbles in the liquid: what they exchange, that nothing depends on threads or interruptions, and hard cases.
#include <gmock/gmock.h>
#include <omp.h>

#include "methods/les_sph_simulation.hpp"
#include "spume/physics/bubbles/coupling.hpp"

namespace spume::test {
namespace {

// A periodic cube at rest, 12^3 particles, in which a body force balances gravity: the hydrostatic pressure of the pure
// liquid. What remains is the buoyancy of the bubbles.
const std::string periodic_cube = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [1.2, 1.2, 1.2]
x = "periodic"
y = "periodic"
z = "periodic"
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e3
froude = 1
mach = 0.05
[forces]
body = ["0", "0", "1"]
[[liquid]]
[bubbles]
weber = 1e3
[[bubble_cloud]]
number = 200
bubble_radius = 0.02
[time]
end = 10
max_step = 0.01
)toml";

// One bubble below a still surface, which does not burst.
const std::string still_tank = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.2, 0.2, 0.24]
x = "periodic"
y = "periodic"
bottom = "no-slip"
[resolution]
spacing = 0.02
[fluid]
reynolds = 1e5
froude = 0.31927542840705043
mach = 0.05
[[liquid]]
upper = [0.2, 0.2, 0.16]
[bubbles]
weber = 1.4e4
schmidt = 1e9
[[bubble_cloud]]
centre = [0.1, 0.1, 0.1]
bubble_radius = 0.003
[time]
end = 10
)toml";

// Gas and liquid in a tank with a surface: sources, breakup and entrainment at work from the first steps.
// A droplet above holds bubbles that burst at once.
const std::string stirred_tank = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [1, 1, 1.5]
x = "periodic"
front = "free-slip"
back = "no-slip"
bottom = "no-slip"
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e4
froude = 1
mach = 0.05
[[liquid]]
upper = [1, 1, 0.8]
velocity = ["sin(2*pi*z)", "2*cos(2*pi*x)", "2*sin(2*pi*y)*z"]
[[liquid]]
lower = [0.4, 0.4, 1.2]
upper = [0.6, 0.6, 1.4]
[turbulence]
model = "mixed-scale"
[bubbles]
weber = 1e4
entrainment = true
breakup = true
fluctuations = true
[[sparger]]
shape = "disc"
position = [0.5, 0.5, 0.2]
radius = 0.2
rate = "0.05*t"
sizes = "log-normal"
bubble_radius = 0.01
deviation = 0.4
[[bubble_cloud]]
lower = [0.1, 0.1, 0.1]
upper = [0.9, 0.9, 0.7]
number = 150
bubble_radius = 0.03
[[bubble_cloud]]
centre = [0.5, 0.5, 1.3]
radius = 0.05
number = 7
bubble_radius = 0.01
[time]
end = 1
)toml";

const bubbles::BubbleCoupling& bubbles_of(const Simulation& run) {
  return *run.method.flow().bubbles;
}

// What the run remarks on, for the log; "" for nothing.
std::string remark_of(Simulation& run) {
  std::string text;
  for (const Remark& remark : run.method.take_remarks()) {
    EXPECT_TRUE(remark.log_only);
    text += remark.text;
  }
  return text;
}

double liquid_sum(const Simulation& run, const ConstFloatVectorField& field, int axis) {
  double sum = 0;
  for (std::size_t i = 0; i < run.method.flow().size(); ++i) sum += (*field[axis])[i];
  return sum * run.method.flow().particles.volume;
}

// Identifier, position, velocity, volume of every bubble.
std::vector<std::array<double, 8>> bubble_state(const Simulation& run) {
  const auto& population = bubbles_of(run).population();
  std::vector<std::array<double, 8>> state(population.size());
  for (std::size_t b = 0; b < population.size(); ++b) {
    state[b][0] = static_cast<double>((*population.identifier)[b]);
    for (std::size_t a = 0; a < 3; ++a) {
      state[b][1 + a] = (*population.position[a])[b];
      state[b][4 + a] = (*population.velocity[a])[b];
    }
    state[b][7] = (*population.volume)[b];
  }
  return state;
}

// Shear above a no-slip floor, three bubbles at 0.25, 0.5 and 3 spacings from it. The gradient of the shear is exact on
// the lattice, and the mirrored liquid goes on with it; with the rule of a slip wall the lowest bubble saw a third.
TEST(Bubbles, SeeTheVorticityOfAShearDownToANoSlipFloor) {
  std::string clouds;
  for (const char* height : {"0.005", "0.01", "0.06"})
    clouds += std::string("[[bubble_cloud]]\ncentre = [0.1, 0.1, ") + height + "]\nbubble_radius = 0.003\n";
  std::string text = still_tank;
  text.replace(text.find("[[bubble_cloud]]"), text.find("[time]") - text.find("[[bubble_cloud]]"), clouds);
  Simulation run(text, {"liquid.0.velocity=[\"3*z\", \"0\", \"0\"]"});
  run.steps(1, 1e-4);
  ASSERT_EQ(bubbles_of(run).population().size(), 3U);
  for (std::size_t b = 0; b < 3; ++b) EXPECT_NEAR(bubbles_of(run).vorticity_at_bubble(b)[1], 3, 0.03) << b;
}

class Closures : public ::testing::TestWithParam<std::string> {};

TEST_P(Closures, WhatParticlesReceiveIsWhatBubblesGive) {
  for (const std::string& text : {periodic_cube, stirred_tank}) {
    Simulation run(text, {"bubbles.momentum_form=\"" + GetParam() + "\""});
    for (int k = 0; k < 5; ++k) {
      run.steps(1, 0.005);
      const Vec3 given = bubbles_of(run).total_reaction();
      double size = 0;
      for (const double component : given) size += std::abs(component);
      ASSERT_GT(size, 0);
      // Float weights: a few roundings each.
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(liquid_sum(run, run.method.flow().bubbles->exchange(), axis), given[axis], 2e-6 * size);
    }
  }
}

// N bubbles at terminal velocity lift the mixture by N V g (1 - 1/beta), relative to the pure liquid.
TEST_P(Closures, CountBuoyancyOnce) {
  Simulation run(periodic_cube, {"bubbles.momentum_form=\"" + GetParam() + "\""});
  run.steps(30, 0.01);  // 0.3 is 100 relaxation times of these bubbles
  const double before = run.series().at("momentum_z");
  const double volume = bubbles_of(run).population().total_volume();
  EXPECT_NEAR(volume, 200 * 4 * M_PI / 3 * 8e-6, 1e-12);
  run.steps(20, 0.01);
  const double lift = (run.series().at("momentum_z") - before) / 0.2, exact = volume * (1 - 1.2 / 1000);
  EXPECT_NEAR(bubbles_of(run).total_reaction()[2], exact, 2e-3 * exact);
  // The discrete pressure gradient of particles of different size is not exactly conservative.
  EXPECT_NEAR(lift, exact, 0.02 * exact);
}

INSTANTIATE_TEST_SUITE_P(Both, Closures, ::testing::Values("mixture-pressure", "two-fluid"),
                         [](const auto& info) { return info.index == 0 ? "MixturePressure" : "TwoFluid"; });

TEST(Bubbles, TakeTheirVolumeFromTheLiquid) {
  Simulation run(periodic_cube);
  run.steps(1, 0.005);
  const les_sph::Flow& flow = run.method.flow();
  double gas = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double alpha = flow.bubbles->volume_fraction()[i];
    EXPECT_LE(alpha, 1);
    gas += flow.particles.volume / alpha * (1 - alpha);
  }
  // Kernel sums over a slightly disordered arrangement are one to a per cent.
  const double volume = bubbles_of(run).population().total_volume();
  EXPECT_NEAR(gas, volume, 0.03 * volume);
}

// One step from a moving liquid: the volume fraction of every particle, and the liquid that every bubble sees, against
// sums over all pairs and their periodic copies.
TEST(Bubbles, AndLiquidSeeEachOtherThroughTheKernel) {
  Simulation run(periodic_cube, {"liquid.0.velocity=[\"sin(2*pi*z/1.2)\",\"cos(2*pi*x/1.2)\",\"1\"]"});
  run.steps(4, 0.01);
  const les_sph::Flow& flow = run.method.flow();
  std::vector<Vec3> moving(flow.size());  // the velocity that moves the liquid in the next step
  for (std::size_t i = 0; i < flow.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      moving[static_cast<std::size_t>((*flow.particles.identifier)[i])][a] =
          (*flow.particles.velocity[a])[i] + 0.005 * (*flow.acceleration[a])[i];
  run.steps(1, 0.01);
  const auto& population = bubbles_of(run).population();
  const double period = 1.2;
  const auto offset = [&](double from, double to) {
    const double d = to - from;
    return d - period * std::round(d / period);
  };
  const auto weight = [&](std::size_t i, std::size_t b) {
    double r2 = 0;
    for (std::size_t a = 0; a < 3; ++a)
      r2 += std::pow(offset((*flow.intermediate_position[a])[i], (*population.next_position[a])[b]), 2);
    const double h = flow.resolution.smoothing_length * flow.sizes.length_ratio[i];
    return WendlandC2::normalisation(3) / (h * h * h) * WendlandC2::w(std::sqrt(r2) / h);
  };
  bool some = false;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    double sum = 0;
    for (std::size_t b = 0; b < population.size(); ++b) sum += weight(i, b) * (*population.volume)[b];
    EXPECT_NEAR(flow.bubbles->volume_fraction()[i], 1 - sum, 1e-6);
    some = some || sum > 0.01;
  }
  EXPECT_TRUE(some);
  for (std::size_t b = 0; b < population.size(); ++b) {
    double weights = 0;
    Vec3 seen{};
    for (std::size_t i = 0; i < flow.size(); ++i) {
      const double w = weight(i, b) * flow.sizes.volume_ratio[i];
      weights += w;
      for (std::size_t a = 0; a < 3; ++a)
        seen[a] += w * moving[static_cast<std::size_t>((*flow.particles.identifier)[i])][a];
    }
    double slip2 = 0;
    for (std::size_t a = 0; a < 3; ++a) slip2 += std::pow(seen[a] / weights - (*population.velocity[a])[b], 2);
    // Velocities of the order of one in float.
    EXPECT_NEAR((*population.slip)[b], std::sqrt(slip2), 2e-6) << b;
  }
}

TEST(Bubbles, InStillLiquidWithoutGravityLeaveItAtRest) {
  Simulation run(periodic_cube, {"forces.body=[\"0\",\"0\",\"0\"]", "fluid.froude=1e30"});
  run.steps(10, 0.01);
  EXPECT_LT(max_speed(run.state()), 1e-12);
  for (const auto& bubble : bubble_state(run)) EXPECT_LT(std::hypot(bubble[4], bubble[5], bubble[6]), 1e-12);
}

TEST(Bubbles, RiseAtTheirTerminalVelocityRelativeToTheLiquid) {
  Simulation run(periodic_cube, {"bubble_cloud.0.number=1", "bubble_cloud.0.centre=[0.6,0.6,0.3]"});
  run.steps(60, 0.01);
  bubbles::Gas gas;
  gas.viscosity = 1e-3;
  gas.gravity = {0, 0, -1};
  const auto& population = bubbles_of(run).population();
  EXPECT_NEAR((*population.slip)[0], bubbles::terminal_speed(gas, 0.02), 0.02 * bubbles::terminal_speed(gas, 0.02));
}

// A bubble that has come to rest below a still surface. Held by the surface it gives the liquid nothing but its creep
// through the last per cent of (3.32), and the liquid calms down; by (3.33) it gives its whole buoyancy for ever.
TEST(Bubbles, AtRestBelowASurfaceLeaveTheLiquidAtRest) {
  const auto lift_and_energy = [](const std::string& bearer) {
    Simulation run(still_tank, {"bubbles.surface_reaction=\"" + bearer + "\""});
    run.steps(100, 0.01);
    const double buoyancy = bubbles_of(run).population().total_volume() * 9.81;
    const double lift = bubbles_of(run).total_reaction()[2] / buoyancy, energy = run.series().at("kinetic_energy");
    run.steps(100, 0.01);
    return std::array{lift, run.series().at("kinetic_energy") / energy};
  };
  const auto pressure_fixed = lift_and_energy("surface"), printed = lift_and_energy("liquid");
  EXPECT_NEAR(pressure_fixed[0], 0, 0.05);
  EXPECT_NEAR(printed[0], 1, 0.01);
  EXPECT_LT(pressure_fixed[1], 1);
  EXPECT_GT(printed[1], 1.5);
}

TEST(Bubbles, DoNotDependOnTheThreadCount) {
  std::vector<State> states;
  std::vector<std::vector<std::array<double, 8>>> bubbles;
  for (const int threads : {1, 2, 5}) {
    omp_set_num_threads(threads);
    Simulation run(stirred_tank);
    run.steps(25, 0.004);
    states.push_back(run.state());
    bubbles.push_back(bubble_state(run));
    // Every kind of event has happened.
    EXPECT_GT(bubbles_of(run).history().entrained, 0);
    EXPECT_GT(bubbles_of(run).history().breakups, 0);
    EXPECT_GT(bubbles_of(run).history().bursts, 0);
    EXPECT_GT(bubbles_of(run).history().injected, 157);
  }
  omp_set_num_threads(2);
  for (std::size_t k = 1; k < states.size(); ++k) {
    EXPECT_TRUE(states[k] == states[0]);
    EXPECT_TRUE(bubbles[k] == bubbles[0]);
  }
}

TEST(Bubbles, ContinueToTheSameBitsFromACheckpoint) {
  Simulation straight(stirred_tank);
  straight.steps(12, 0.004);
  MemoryState saved;
  straight.method.save(saved);
  straight.steps(6, 0.004);
  Simulation restored(stirred_tank);
  restored.method.load(saved);
  restored.steps(6, 0.004);
  EXPECT_TRUE(restored.state() == straight.state());
  EXPECT_TRUE(bubble_state(restored) == bubble_state(straight));
  EXPECT_EQ(restored.series(), straight.series());
  EXPECT_EQ(restored.method.step_limit().dt, straight.method.step_limit().dt);
}

TEST(Bubbles, AreLeftByARefusedStep) {
  Simulation run(stirred_tank), strict(stirred_tank, {"pressure.max_iterations=1", "pressure.tolerance=1e-14"});
  run.steps(8, 0.004);
  MemoryState saved;
  run.method.save(saved);
  strict.method.load(saved);
  auto before = bubble_state(strict);
  EXPECT_THROW(strict.steps(1, 0.004), StepFailure);
  auto after = bubble_state(strict);
  // The refused step may have sorted them.
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  EXPECT_TRUE(before == after);
  EXPECT_EQ(bubbles_of(strict).history().entrained, bubbles_of(run).history().entrained);
}

TEST(Bubbles, KeepTheirVolumeInAllEvents) {
  Simulation run(stirred_tank);
  for (int k = 0; k < 30; ++k) {
    run.steps(1, 0.004);
    const auto& history = bubbles_of(run).history();
    const double came = history.injected_volume + history.entrained_volume;
    EXPECT_NEAR(bubbles_of(run).population().total_volume() + history.burst_volume, came, 1e-12 * came);
  }
}

TEST(Bubbles, CostNothingInASceneWithoutThem) {
  std::string text = periodic_cube;
  text.erase(text.find("[bubbles]"), text.find("[time]") - text.find("[bubbles]"));
  Simulation run(text);
  run.steps(2, 0.005);
  EXPECT_EQ(run.method.flow().bubbles, nullptr);
  for (const ArrayInfo& array : run.method.arrays()) {
    EXPECT_EQ(array.name.find("bubble"), std::string::npos) << array.name;
    EXPECT_EQ(array.name.find("volume_fraction"), std::string::npos);
  }
  for (const Stage& stage : run.method.plan())
    EXPECT_FALSE(stage.on && stage.name.find("bubble") != std::string::npos) << stage.name;
  EXPECT_EQ(run.series().count("bubbles"), 0U);
}

TEST(Bubbles, HaveStagesWhoseTrafficIsCountedWhileTheyLive) {
  for (const std::string& text : {periodic_cube, stirred_tank}) {
    Simulation run(text);
    run.steps(2, 0.004);
    EXPECT_EQ(uncounted_stages(run.method, run.ledger), "");
  }
  Simulation later(periodic_cube, {"bubble_cloud.0.time=5"});
  later.steps(2, 0.004);
  for (const Ledger::Entry& entry : later.ledger.entries()) {
    const bool of_bubbles = entry.stage == "bubble motion" || entry.stage == "volume fraction" ||
                            entry.stage == "bubble forces" || entry.stage == "bubble events";
    EXPECT_EQ(entry.bytes > 0, !of_bubbles) << entry.stage;
  }
}

// Sources, breakup, entrainment, fluctuations, bursting, under every closure, momentum form and integrator.
TEST(Bubbles, AreLeftAsTheyWereByARefusedStep) {
  for (const std::string model : {"mixed-scale", "smagorinsky", "dynamic-shepard", "dynamic-lagrangian"})
    EXPECT_EQ(changed_by_a_refused_step(stirred_tank, {"turbulence.model=\"" + model + "\""}, 0.005), "") << model;
  for (const std::string set : {"momentum_form=\"two-fluid\"", "integrator=\"substep\"", "fluid_inertia=true",
                                "surface_reaction=\"liquid\"", "fluctuations=false"})
    EXPECT_EQ(changed_by_a_refused_step(stirred_tank, {"bubbles." + set}, 0.005), "") << set;
  EXPECT_EQ(changed_by_a_refused_step(periodic_cube, {}, 0.005), "");
}

// A section [bubbles] of which no bubble lives changes nothing in the liquid.
TEST(Bubbles, ThatDoNotYetLiveLeaveTheLiquidToTheBit) {
  std::string without = periodic_cube;
  without.erase(without.find("[bubbles]"), without.find("[time]") - without.find("[bubbles]"));
  const Overrides moving{"liquid.0.velocity=[\"sin(2*pi*z/1.2)\",\"0\",\"0\"]"};
  Overrides later = moving;
  later.push_back("bubble_cloud.0.time=5");
  Simulation a(without, moving), b(periodic_cube, later);
  a.steps(6, 0.005);
  b.steps(6, 0.005);
  EXPECT_TRUE(a.state() == b.state());
}

// More gas than room: the run goes on, says so, and every bubble keeps its volume.
TEST(Bubbles, InAnOverfullRegionRunOn) {
  Simulation run(periodic_cube, {"bubble_cloud.0.number=400", "bubble_cloud.0.centre=[0.6,0.6,0.6]",
                                 "bubble_cloud.0.radius=0.12", "bubble_cloud.0.bubble_radius=0.03"});
  run.steps(10, 0.005);
  const auto series = run.series();
  EXPECT_GT(series.at("overfull_particles"), 0);
  EXPECT_GT(series.at("smallest_volume_fraction"), 0);
  EXPECT_LT(series.at("smallest_volume_fraction"), 0.5);
  const double exact = 400 * 4 * M_PI / 3 * 2.7e-5;
  EXPECT_NEAR(series.at("bubble_volume"), exact, 1e-12 * exact);
  EXPECT_FALSE(run.method.take_remarks().empty());
  EXPECT_TRUE(run.method.take_remarks().empty());
  // The filter that the fluctuations know is as wide as the kernels there: h alpha^(-1/3), alpha >= 1/2.
  double widest = 0;
  for (std::size_t b = 0; b < 400; ++b) {
    const double width = bubbles_of(run).filter_width_at_bubble(b);
    EXPECT_GE(width, 1 - 1e-6);
    EXPECT_LE(width, std::cbrt(2.0) * (1 + 1e-6));
    widest = std::max(widest, width);
  }
  EXPECT_GT(widest, 1.2);
}

// Spray: all bubbles burst in one step, and the liquid goes on without any.
TEST(Bubbles, OfADropletBurstTogether) {
  std::string text = stirred_tank;
  const auto cut = [&](const char* from, const char* to) {
    text.erase(text.find(from), text.find(to, text.find(from) + 1) - text.find(from));
  };
  cut("[[liquid]]", "[[liquid]]");
  cut("[[sparger]]", "[[bubble_cloud]]");
  cut("[[bubble_cloud]]", "[[bubble_cloud]]");
  Simulation run(text, {"bubbles.entrainment=false"});
  const double volume = run.series().at("bubble_volume");
  EXPECT_GT(volume, 0);
  run.steps(1, 0.002);
  EXPECT_EQ(run.series().at("bubbles"), 0);
  EXPECT_EQ(run.series().at("bursts"), 7);
  EXPECT_THAT(remark_of(run), ::testing::HasSubstr("7 of 7 bubbles burst in the step to t = 0.002"));
  EXPECT_NEAR(run.series().at("burst_volume"), volume, 1e-12 * volume);
  run.steps(3, 0.002);
  EXPECT_EQ(run.series().at("smallest_volume_fraction"), 1);
}

// A million bubbles in a thousand particles: the run goes on, says so, and not one loses its volume.
TEST(Bubbles, InGreatNumberRunOn) {
  Simulation run(periodic_cube, {"bubble_cloud.0.number=1000000", "bubble_cloud.0.bubble_radius=1e-5"});
  run.steps(1, 0.005);
  EXPECT_EQ(run.series().at("bubbles"), 1e6);
  const double exact = 1e6 * 4 * M_PI / 3 * 1e-15;
  EXPECT_NEAR(run.series().at("bubble_volume"), exact, 1e-9 * exact);
  EXPECT_THAT(remark_of(run), ::testing::HasSubstr("1000000 bubbles live at t = 0.005"));
}

// In a closed box bubbles do without surface tension, and without counts about a radius that there is not.
TEST(Bubbles, WithoutTensionAreNotCountedAboutTheHinzeRadius) {
  std::string text = periodic_cube;
  const auto weber = text.find("weber");
  ASSERT_NE(weber, std::string::npos);
  text.erase(weber, text.find('\n', weber) + 1 - weber);
  Simulation run(text);
  run.steps(1, 0.005);
  EXPECT_EQ(run.series().count("bubbles_above_hinze"), 0U);
  EXPECT_GT(run.series().at("bubble_volume"), 0);
  for (const RecordTable& table : run.method.tables()) EXPECT_NE(table.name, "bubble_sizes");
  Simulation with(periodic_cube);
  EXPECT_EQ(with.series().count("bubbles_above_hinze"), 1U);
}

TEST(Bubbles, AllocateNothingInASteadyStep) {
  const OneThread alone;
  Simulation run(periodic_cube);
  run.steps(25, 0.005);
  const auto before = array_statistics();
  run.steps(5, 0.005);
  EXPECT_EQ(array_statistics().allocations, before.allocations);
}

}  // namespace
}  // namespace spume::test
