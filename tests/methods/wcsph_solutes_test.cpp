// SPDX-License-Identifier: MIT
// What the liquid of wcsph carries: scalars, oxygen of released bodies and of the air, sludge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <limits>
#include <numbers>

#include "methods/wcsph_run.hpp"
#include "reference/rigid_gas.hpp"

namespace spume::test {
namespace wcsph_solutes {
namespace {

using std::numbers::pi;
using testing::Contains;
using testing::HasSubstr;

constexpr double rounding = std::numeric_limits<double>::epsilon();

const std::string vortices = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.03125
[[phase]]
name = "liquid"
density = 1
viscosity = 0.01
[[region]]
phase = "liquid"
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
[compressibility]
max_speed = 1
[time]
end = 1
)toml";

// Discs of 2 cm that grow in 20 cm of water, one after another, drift across the periodic side and shrink.
const std::string discs = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [0.2, 0.3]
x = "periodic"
bottom = "no-slip"
[resolution]
spacing = 0.01
[fluid]
gravity = 9.81
[[phase]]
name = "water"
density = 998
viscosity = 1e-3
[[region]]
phase = "water"
upper = [0.2, 0.2]
[[body]]
shape = "ball"
radius = 0.02
position = [0.18, 0.06]
displacement = ["0.1*t", "0.3*t"]
release_interval = 0.15
release_duration = 0.4
release_growth = 0.1
release_shrinkage = 0.1
[compressibility]
max_speed = 1.4
[oxygen]
surface_k_l = 1e-3
[[scalar]]
name = "oxygen"
unit = "g/m3"
initial = "2 + 10*x"
diffusivity = 2e-9
[time]
end = 1
)toml";

// What a case carries beside, and the case without it.
std::string without_solutes(const std::string& text) {
  const std::size_t first = text.find("[oxygen]"), last = text.find("[time]");
  return text.substr(0, first) + text.substr(last);
}

std::string with_scalar(const std::string& text, const std::string& initial, const std::string& more = "") {
  return text + "[[scalar]]\nname = \"dye\"\ninitial = \"" + initial + "\"\n" + more;
}

struct Range {
  double least = 1e300, largest = -1e300;
};
Range range(const WcsphRun& run) {
  Range range;
  for (const double c : run.method.flow().solutes.scalars->values(0)) {
    range.least = std::min(range.least, c);
    range.largest = std::max(range.largest, c);
  }
  return range;
}

// A function of the stream function is not stirred, and cos cos is an eigenfunction of the Laplacian: exact in vortices
// that stir the particles, with the shift of which the values change.
TEST(WcsphSolutes, AScalarOnTheStreamlinesOfVorticesDecaysByDiffusionAlone) {
  WcsphRun run(with_scalar(vortices, "cos(2*pi*x)*cos(2*pi*y)", "diffusivity = 0.01\n"));
  ASSERT_TRUE(run.method.flow().features.shifting);
  until(run, 0.5);
  const wcsph::Flow& flow = run.method.flow();
  double error = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const Vec3 r = vector_at(flow.particles.position, 2, i);
    const double exact = std::exp(-8 * pi * pi * 0.01 * flow.time) * std::cos(2 * pi * r[0]) * std::cos(2 * pi * r[1]);
    error += std::pow(flow.solutes.scalars->values(0)[i] - exact, 2) / static_cast<double>(flow.size());
  }
  // Rates are off by (k h)^2 / 8, k^2 = 8 pi^2 and h = 1.3 / 32, which 0.39 decay times make 0.2 % of the rms 1/2.
  EXPECT_LT(std::sqrt(error), 0.004);
}

// Each step adds the rounding of n doubles and of their sum.
TEST(WcsphSolutes, AmountsStayToTheRoundingOfDoublesAndNoValuePassesTheOthers) {
  for (const std::string& text : {vortices, without_solutes(discs)}) {
    WcsphRun run(with_scalar(text, text == vortices ? "x < 0.3 ? 1 : 0" : "x < 0.06 ? 1 : 0", "diffusivity = 1e-4\n"));
    const double before = run.series()["amount_of_dye"];
    EXPECT_GT(before, 0);
    constexpr int steps = 100;
    for (int k = 0; k < steps; ++k) run.steps(1, run.method.step_limit().dt);
    EXPECT_NEAR(run.series()["amount_of_dye"] / before, 1, steps * 64 * rounding);
    const Range after = range(run);
    EXPECT_GE(after.least, 0);
    EXPECT_LE(after.largest, 1 + 1e-6);  // values are floats beside the least one
  }
}

// A scene that names none has neither stage nor array for it, and its flow is the same to the bit.
TEST(WcsphSolutes, FlowsAreTheSameBitsWithAndWithoutThem) {
  WcsphRun plain(without_solutes(discs)), run(discs);
  EXPECT_EQ(plain.method.flow().solutes.scalars, nullptr);
  for (const Stage& stage : plain.method.plan()) {
    const bool carries = stage.name == "scalars" || stage.name == "oxygen" || stage.name == "reactions";
    EXPECT_FALSE(carries && stage.on) << stage.name;
  }
  for (int k = 0; k < 60; ++k) {
    const double dt = plain.method.step_limit().dt;
    plain.steps(1, dt);
    run.steps(1, dt);
  }
  const auto a = plain.saved_state(), b = run.saved_state();
  for (const auto& [name, values] : a) EXPECT_EQ(values, b.at(name)) << name;
}

TEST(WcsphSolutes, ARestoredRunAndAnyNumberOfThreadsGiveTheSameBits) {
  const int before = omp_get_max_threads();
  for (const std::string& text : {discs, with_scalar(vortices, "x", "diffusivity = 0.01\n")}) {
    const auto advance = [](WcsphRun& run, int steps) {
      for (int k = 0; k < steps; ++k) run.steps(1, run.method.step_limit().dt);
    };
    omp_set_num_threads(1);
    WcsphRun straight(text);
    advance(straight, 60);
    MemoryState saved;
    straight.method.save(saved);
    advance(straight, 40);
    omp_set_num_threads(3);
    WcsphRun restored(text);
    restored.method.load(saved);
    advance(restored, 40);
    EXPECT_EQ(straight.saved_state(), restored.saved_state());
    EXPECT_EQ(straight.series(), restored.series());
  }
  omp_set_num_threads(before);
}

// Of the discs of the case at time t: position, and size by s (2 - s).
std::vector<reference::Disc> discs_at(double t) {
  std::vector<reference::Disc> all;
  for (int k = 0; 0.15 * k <= t; ++k) {
    const double age = t - 0.15 * k, left = 0.4 - age;
    if (age > 0.4 || !(age > 0)) continue;
    const double s = std::min({1.0, age / 0.1, left / 0.1});
    all.push_back({{0.18 + 0.1 * age, 0.06 + 0.3 * age, 0}, {0.1, 0.3, 0}, 0.02 * s * (2 - s)});
  }
  return all;
}

// The first exchange of discs of which two are there: contents are those that they set out with. Circumferences of
// polygons and float changes.
TEST(WcsphSolutes, DiscsGiveWhatTheSlowTwinGives) {
  WcsphRun run(discs);
  until(run, 0.24);
  const wcsph::Flow& flow = run.method.flow();
  const oxygen::Gas& gas = flow.solutes.oxygen->gas();
  oxygen::RigidBubbles bubbles(flow.scene, flow.resolution, gas);
  Array<float> change(flow.size());
  constexpr double dt = 0.01;
  const double given = bubbles.exchange(flow.time, dt,
                                        {.size = flow.size(),
                                         .particle_volume = flow.particles.volume,
                                         .places = flow.particles.position,
                                         .velocity = flow.particles.velocity,
                                         .dissolved = flow.solutes.oxygen->dissolved()},
                                        change);
  reference::Water water;
  water.particle_volume = flow.particles.volume;
  water.h = flow.resolution.smoothing_length;
  water.period = 0.2;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    water.position.push_back(vector_at(flow.particles.position, 2, i));
    water.velocity.push_back(vector_at(flow.particles.velocity, 2, i));
    water.dissolved.push_back(flow.solutes.oxygen->dissolved()[i]);
  }
  const std::vector<reference::Disc> now = discs_at(flow.time);
  ASSERT_EQ(now.size(), 2U);
  const double moles = gas.moles(pi * 0.02 * 0.02, 0.06);
  const oxygen::Contents full{gas.fraction * moles, (1 - gas.fraction) * moles};
  const reference::RigidGas slow = reference::rigid_gas(water, now, gas, {full, full}, dt);
  EXPECT_GT(slow.given, 0);
  EXPECT_NEAR(given / slow.given, 1, 1e-5);
  EXPECT_NEAR(bubbles.conductance() / slow.conductance, 1, 1e-5);
  const double largest = *std::max_element(slow.change.begin(), slow.change.end());
  int reached = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    EXPECT_NEAR(change[i], slow.change[i], 1e-5 * largest);
    reached += change[i] > 0 ? 1 : 0;
  }
  EXPECT_GT(reached, 30);
}

// What the bodies lose the liquid gains; what they set out with is in the liquid, in them, or left with them.
TEST(WcsphSolutes, OxygenIsConserved) {
  WcsphRun run(discs);
  const double first = run.series()["amount_of_oxygen"];
  until(run, 0.75);  // two discs have been taken away
  auto after = run.series();
  EXPECT_GT(after["oxygen_left"], 0);
  EXPECT_GT(after["oxygen_from_bubbles"], 1e-6);
  EXPECT_NEAR(
      (after["oxygen_from_bubbles"] + after["oxygen_in_bubbles"] + after["oxygen_left"]) / after["oxygen_released"], 1,
      1e-13);
  EXPECT_NEAR((after["amount_of_oxygen"] - after["oxygen_from_bubbles"] - after["oxygen_from_surface"]) / first, 1,
              1e-12);
  EXPECT_GT(after["sotr"], 0);
  EXPECT_GT(after["kla"], 0);
}

// The length of the surface of water at rest, and the exact course of its mean towards saturation over short times.
TEST(WcsphSolutes, StillWaterHasTheSurfaceOfItsWidth) {
  std::string text = discs;
  const std::size_t body = text.find("[[body]]");
  text.erase(body, text.find("[compressibility]") - body);
  WcsphRun run(text);
  for (int k = 0; k < 20; ++k) run.steps(1, run.method.step_limit().dt);
  EXPECT_NEAR(run.series()["surface_area"], 0.2, 0.2 * 1e-3);
  EXPECT_NEAR(run.series()["kla"], 1e-3 * 0.2 / (0.2 * 0.2), 1e-3 * 5e-3);
}

// What neither diffuses nor is shifted needs no sums over pairs; what diffuses takes two, of which one measures.
TEST(WcsphSolutes, WhatNothingMovesCostsNoSweep) {
  const auto pairs_of = [](const std::string& more) {
    WcsphRun run(with_scalar(without_solutes(discs), "x", more));
    run.steps(3, run.method.step_limit().dt);
    double scalars = 0, continuity = 0;
    for (const Ledger::Entry& entry : run.ledger.entries()) {
      if (entry.stage == "scalars") scalars = entry.pairs / 3;
      if (entry.stage == "continuity") continuity = entry.pairs / static_cast<double>(entry.calls);
    }
    return scalars / continuity;
  };
  EXPECT_EQ(pairs_of(""), 0);
  EXPECT_NEAR(pairs_of("diffusivity = 0.001\n"), 2, 0.01);
}

// Uniform sludge in still water is one tank: the same as the reactions alone.
TEST(WcsphSolutes, SludgeInStillWaterReactsAsInOneTank) {
  std::string text = replaced(discs, "surface_k_l = 1e-3", "");
  text.erase(text.find("[[body]]"), text.find("[compressibility]") - text.find("[[body]]"));
  text.erase(text.find("[[scalar]]"), text.find("[time]") - text.find("[[scalar]]"));
  text +=
      "max_step = 1e-4\n[biokinetics]\ninterval = 0.001\ntolerance = 1e-9\n"
      "[[scalar]]\nname = \"S_O\"\ninitial = \"6\"\n[[scalar]]\nname = \"S_S\"\ninitial = \"20\"\n"
      "[[scalar]]\nname = \"X_BH\"\ninitial = \"2500\"\n[[scalar]]\nname = \"S_NH\"\ninitial = \"9\"\n"
      "[[scalar]]\nname = \"S_ALK\"\ninitial = \"5\"\n";
  WcsphRun run(text);
  run.steps(50, 1e-4);
  const BiokineticsOptions& options = run.loaded.options.get<BiokineticsOptions>();
  std::vector<double> tank(biokinetics::asm1::components, 0.0);
  std::vector<double*> one;
  for (double& c : tank) one.push_back(&c);
  tank[biokinetics::asm1::s_o] = 6;
  tank[biokinetics::asm1::s_s] = 20;
  tank[biokinetics::asm1::x_bh] = 2500;
  tank[biokinetics::asm1::s_nh] = 9;
  tank[biokinetics::asm1::s_alk] = 5;
  const biokinetics::Integrator integrator(biokinetics::asm1_model(options.parameters), 1e-9);
  for (int k = 0; k < 5; ++k) integrator.advance(one, 0, 1, 0.001 / 86400);
  for (std::size_t i = 0; i < tank.size(); ++i)
    EXPECT_NEAR(run.method.flow().solutes.scalars->values(options.scalars[i])[7], tank[i],
                1e-12 * std::max(tank[i], 1.0))
        << i;
  EXPECT_GT(run.series()["oxygen_uptake"], 0);
}

// With sludge dissolved oxygen is S_O: a scalar of the other name would stand by.
TEST(WcsphSolutes, AScalarThatOnlyLooksLikeDissolvedOxygenIsWarnedOf) {
  const auto said = [](const std::string& text) {
    const LoadedCase loaded = load_text(text);
    return std::any_of(loaded.options.warnings.begin(), loaded.options.warnings.end(), [](const Problem& warning) {
      return warning.text.find("'oxygen' takes no part in [oxygen], whose scalar is 'S_O'") != std::string::npos;
    });
  };
  const std::string sludge = discs +
                             "[biokinetics]\nmodel = \"asm1\"\n[[scalar]]\nname = \"S_NH\"\ninitial = \"9\"\n"
                             "[[scalar]]\nname = \"S_ALK\"\ninitial = \"5\"\n";
  EXPECT_TRUE(said(sludge));
  EXPECT_FALSE(said(replaced(sludge, "name = \"oxygen\"", "name = \"S_O\"")));
  EXPECT_FALSE(said(discs));
}

TEST(WcsphSolutes, WhatItCannotCarryIsRefusedWithTheFix) {
  const auto refused = [](const std::string& text, const std::string& message) {
    EXPECT_THAT(problems_of(text), Contains(HasSubstr(message))) << message;
  };
  const std::string air = "[[phase]]\nname = \"air\"\ndensity = 1\nviscosity = 1e-5\n[[region]]\nphase = \"air\"\n";
  refused(replaced(discs, "[[phase]]", air + "[[phase]]"), "leave the gas out, or remove the scalars");
  refused(replaced(discs, "gravity = 9.81", "froude = 1"), "holds values in SI units");
  refused(replaced(discs, "initial = \"2 + 10*x\"", "initial = \"10*x - 1\""), "finite number >= 0");
  refused(replaced(discs, "position = [0.18, 0.06]", "position = [0.18, 0.27]"), "nowhere on its way is liquid");
  refused(replaced(discs, "surface_k_l", "bubbles_shrink = true\nsurface_k_l"), "keep their size");
}

}  // namespace
}  // namespace wcsph_solutes
}  // namespace spume::test
