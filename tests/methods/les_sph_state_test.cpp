// SPDX-License-Identifier: MIT
// State between steps: saved and restored to the bit, untouched by a refused step; nothing is allocated on the way.
#include <gtest/gtest.h>

#include <limits>
#include <type_traits>
#include <variant>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

class SavedRun : public ::testing::TestWithParam<std::string> {};

TEST_P(SavedRun, ARestoredRunContinuesToTheSameBits) {
  const Overrides overrides{"turbulence.model=\"dynamic-lagrangian\""};
  for (const Overrides& set : {Overrides{}, overrides}) {
    Simulation straight(GetParam(), set);
    straight.steps(3, 0.004);
    MemoryState saved;
    straight.method.save(saved);
    straight.steps(2, 0.004);

    Simulation restored(GetParam(), set);
    restored.method.load(saved);
    EXPECT_EQ(restored.method.step_count(), 3);
    restored.steps(2, 0.004);
    EXPECT_EQ(restored.method.time(), straight.method.time());
    EXPECT_TRUE(restored.state() == straight.state());
    EXPECT_EQ(restored.method.step_limit().dt, straight.method.step_limit().dt);
  }
}

// A method that has already run elsewhere forgets it.
TEST_P(SavedRun, LoadingReplacesAnyEarlierState) {
  Simulation straight(GetParam());
  straight.steps(2, 0.004);
  MemoryState saved;
  straight.method.save(saved);
  Simulation other(GetParam());
  other.steps(5, 0.003);
  other.method.load(saved);
  EXPECT_TRUE(other.state() == straight.state());
  straight.steps(1, 0.004);
  other.steps(1, 0.004);
  EXPECT_TRUE(other.state() == straight.state());
}

TEST_P(SavedRun, ARefusedStepLeavesIt) {
  Simulation run(GetParam());
  run.steps(2, 0.004);
  MemoryState saved;
  run.method.save(saved);

  Simulation strict(GetParam(), {"pressure.max_iterations=1", "pressure.tolerance=1e-14"});
  strict.method.load(saved);
  const State before = strict.state();
  const double dt_before = strict.method.step_limit().dt;
  EXPECT_THROW(strict.steps(1, 0.004), StepFailure);
  EXPECT_TRUE(strict.state() == before);
  EXPECT_EQ(strict.method.time(), run.method.time());
  EXPECT_EQ(strict.method.step_count(), 2);
  EXPECT_EQ(strict.method.step_limit().dt, dt_before);
}

// Whatever a step takes along: averages of a closure, walls and their speed, a force that varies.
TEST(LesSphRefusal, LeavesEveryNumberOfTheState) {
  for (const std::string model : {"none", "mixed-scale", "smagorinsky", "dynamic-shepard", "dynamic-lagrangian"}) {
    const std::string closure = "turbulence.model=\"" + model + "\"";
    for (const std::string& text : {taylor_green, taylor_green_3d, dam_break})
      EXPECT_EQ(changed_by_a_refused_step(text, {closure}, 0.004), "") << model;
    EXPECT_EQ(changed_by_a_refused_step(cavity, {closure, "domain.wall_velocity.top=[\"sin(50*t)\", \"0\"]"}, 0.004),
              "")
        << model;
  }
  const Overrides second{"shifting.velocity_correction=\"second-order\"", "pressure.precision=\"double\""};
  EXPECT_EQ(changed_by_a_refused_step(taylor_green, second, 0.004), "");
  EXPECT_EQ(changed_by_a_refused_step(closed_box, {"forces.body=[\"sin(40*t)*y\", \"x\"]"}, 0.004), "");
}

// A step far too long moves a particle across its support: refused as well, and a shorter one succeeds.
TEST_P(SavedRun, ARefusedStepCanBeRepeatedShorter) {
  Simulation run(GetParam()), untroubled(GetParam());
  run.steps(2, 0.004);
  untroubled.steps(2, 0.004);
  EXPECT_THROW(run.steps(1, 1e4), StepFailure);
  run.steps(1, 0.004);
  untroubled.steps(1, 0.004);
  // The refused step sorted the particles at other places, and sums run in their order.
  const State a = run.state(), b = untroubled.state();
  for (std::size_t i = 0; i < a.velocity.size(); ++i)
    for (int axis = 0; axis < a.dimensions; ++axis) {
      ASSERT_NEAR(a.position[i][axis], b.position[i][axis], 1e-5);
      ASSERT_NEAR(a.velocity[i][axis], b.velocity[i][axis], 1e-3);
    }
}

// Probes look at the present state, also when it is not that of the last look at the same step count.
TEST(LesSphSamples, FollowALoadedState) {
  Simulation here(taylor_green), there(taylor_green, {"liquid.0.velocity=[\"1\", \"0.5\"]"});
  here.steps(1, 0.004);
  there.steps(1, 0.05);
  const Vec3 point{0.31, 0.42, 0};
  here.method.sample(point);
  MemoryState saved;
  there.method.save(saved);
  here.method.load(saved);
  const PointSample a = here.method.sample(point), b = there.method.sample(point);
  EXPECT_NEAR(a.coverage, b.coverage, 1e-12);
  for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(a.velocity[axis], b.velocity[axis], 1e-12);
}

TEST(LesSphSamples, KnowTheHydrostaticPressureOfALoadedState) {
  Simulation saved_from(closed_box), loaded_into(closed_box);
  saved_from.steps(2, 0.005);
  MemoryState saved;
  saved_from.method.save(saved);
  loaded_into.method.load(saved);
  const Vec3 floor{0.31, 0, 0};
  EXPECT_EQ(loaded_into.method.sample(floor).scalars[0], saved_from.method.sample(floor).scalars[0]);
}

TEST(LesSphSamples, AreTheSameAfterARefusedStep) {
  Simulation run(taylor_green);
  run.steps(2, 0.004);
  const Vec3 point{0.31, 0.42, 0};
  const PointSample before = run.method.sample(point);
  EXPECT_THROW(run.steps(1, 1e4), StepFailure);
  const PointSample after = run.method.sample(point);
  EXPECT_NEAR(after.coverage, before.coverage, 1e-12);
  for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(after.velocity[axis], before.velocity[axis], 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Cases, SavedRun, ::testing::Values(taylor_green, taylor_green_3d, dam_break),
                         [](const auto& info) {
                           return info.index == 0 ? "Vortices2D" : info.index == 1 ? "Vortices3D" : "DamBreak";
                         });

// Arrays that lend their place to others would tell here when somebody reads them afterwards.
TEST(LesSphScratch, NothingIsReadOfIt) {
  const auto spoil = [](Simulation& run) {
    auto& flow = const_cast<les_sph::Flow&>(run.method.flow());
    for (const auto& field : flow.particles.fields.fields())
      if (field->lifetime == Lifetime::result)
        std::visit(
            []<class T>(Array<T>& values) {
              if constexpr (std::is_floating_point_v<T>) values.fill(std::numeric_limits<T>::quiet_NaN());
            },
            field->values);
  };
  const std::vector<std::pair<std::string, Overrides>> scenes = {
      {taylor_green, {}},
      {taylor_green, {"time.centred=false", "shifting.on=false"}},
      {taylor_green, {"shifting.velocity_correction=\"second-order\"", "turbulence.model=\"smagorinsky\""}},
      {taylor_green, {"turbulence.model=\"dynamic-lagrangian\"", "pressure.precision=\"double\""}},
      {cavity, {"turbulence.model=\"mixed-scale\""}},
      {dam_break, {"turbulence.model=\"dynamic-shepard\""}},
      {dam_break_3d, {"turbulence.model=\"mixed-scale\""}},
      {square_patch, {}}};
  for (const auto& [text, overrides] : scenes) {
    Simulation plain(text, overrides), spoilt(text, overrides);
    for (int k = 0; k < 4; ++k) {
      plain.steps(1, 0.002);
      spoilt.steps(1, 0.002);
      spoil(spoilt);
    }
    const State expected = plain.state(), found = spoilt.state();
    EXPECT_EQ(found.position, expected.position) << text;
    EXPECT_EQ(found.velocity, expected.velocity) << text;
    EXPECT_EQ(found.pressure, expected.pressure) << text;
  }
}

// What `spume check` lists is what the method holds, to the rounding of sizes to cache lines. A run before it leaves
// what the thread keeps.
TEST(LesSphAllocations, EveryArrayIsListed) {
  const std::vector<std::pair<std::string, Overrides>> scenes = {
      {taylor_green, {}},
      {cavity, {"resolution.spacing=0.02"}},
      {taylor_green_3d, {"turbulence.model=\"dynamic-lagrangian\""}},
      {dam_break_3d, {"turbulence.model=\"mixed-scale\"", "resolution.spacing=0.05"}}};
  const OneThread alone;
  for (const auto& [text, overrides] : scenes) {
    Simulation(text, overrides).steps(4, 0.001);
    const LoadedCase loaded = load_text(text, overrides);
    const auto before = static_cast<double>(array_statistics().bytes);
    les_sph::LesSph method(loaded);
    Ledger ledger;
    for (int k = 0; k < 4; ++k) method.step(0.001, ledger);
    double listed = 0;
    for (const ArrayInfo& array : method.arrays()) listed += array.bytes;
    const double pressure_fixed = static_cast<double>(array_statistics().bytes) - before;
    EXPECT_NEAR(listed, pressure_fixed, 0.01 * pressure_fixed) << text;
  }
}

TEST(LesSphAllocations, ASteadyRunAllocatesNothing) {
  const OneThread alone;
  for (const std::string& text : {taylor_green, taylor_green_3d, dam_break}) {
    Simulation run(text);
    run.steps(10, 0.004);
    const auto before = array_statistics();
    run.steps(5, 0.004);
    EXPECT_EQ(array_statistics().allocations, before.allocations) << text;
    EXPECT_EQ(array_statistics().bytes, before.bytes);
  }
}

// Liquid from the bottom to 0.4 and, over air, a slab from 0.6 to 0.8: the coverage passes one half at the edges of
// lattice cells, within the error of the kernel's sums over a lattice, 1 % of the sum or 0.03 spacings.
TEST(LesSphSamples, MeasureColumnsByTheirTopAndByTheirWetLength) {
  Simulation run(R"(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.025
[fluid]
reynolds = 100
froude = 1
[[liquid]]
upper = [1, 0.4]
[[liquid]]
lower = [0, 0.6]
upper = [1, 0.8]
[time]
end = 1
)");
  EXPECT_NEAR(run.method.elevation({0.31, 0, 0}), 0.8, 0.05 * 0.025);
  EXPECT_NEAR(run.method.wetted_length({0.31, 0, 0}), 0.6, 0.15 * 0.025);
  Simulation dry(dam_break);
  EXPECT_EQ(dry.method.wetted_length({dry.loaded.scene.domain.upper[0], 0, 0}), 0);
}

// A linear shear between walls at rest and in motion is linear in the mirrored liquid too: the fit is exact up to and
// on the walls.
TEST(LesSphSamples, SeeTheVelocityOfNoSlipWalls) {
  Simulation run(channel, {"domain.wall_velocity.top=[\"2\", \"0\"]", "liquid.0.velocity=[\"2*y\", \"0\"]"});
  for (const double y : {0.0, 0.01, 0.2, 0.5, 0.93, 1.0}) {
    const PointSample sample = run.method.sample({0.31, y, 0});
    EXPECT_NEAR(sample.velocity[0], 2 * y, 1e-12);
    EXPECT_NEAR(sample.velocity[1], 0, 1e-12);
  }
}

// The mirrored liquid takes the hydrostatic pressure from where its sources are: on the floor of still water a sample
// that mirrored the whole pressure read 0.6 spacings of water too little.
TEST(LesSphSamples, SeeTheHydrostaticPressureOnTheFloor) {
  Simulation run(closed_box, {"domain.left=\"free-slip\"", "domain.right=\"free-slip\""});
  run.steps(2, 0.005);
  const double middle = run.method.sample({0.5, 0.5, 0}).scalars[0];
  for (const double y : {0.0, 0.01, 0.1, 0.9, 1.0})
    for (const double x : {0.0, 0.3})
      // The solve's tolerance of 1e-6, over a box of 1.
      EXPECT_NEAR(run.method.sample({x, y, 0}).scalars[0] - middle, 0.5 - y, 2e-5) << x << " " << y;
}

}  // namespace
}  // namespace spume::test
