// SPDX-License-Identifier: MIT
// gfd between steps: saved and restored to the bit, untouched by a refused step, the same for any number of threads;
// and what its plan says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include "methods/gfd_run.hpp"

namespace spume::test {
namespace {

using testing::HasSubstr;

class GfdState : public ::testing::TestWithParam<std::string> {};

TEST_P(GfdState, ARestoredRunContinuesToTheSameBits) {
  for (const Overrides& set : {Overrides{}, Overrides{"momentum.diffusion=\"printed\"", "interface.smoothing=3"},
                               Overrides{"time.viscosity=\"implicit\""}}) {
    GfdRun straight(GetParam(), set);
    straight.steps(3, 0.002);
    MemoryState saved;
    straight.method.save(saved);
    straight.steps(2, 0.002);
    GfdRun restored(GetParam(), set);
    restored.method.load(saved);
    EXPECT_EQ(restored.method.step_count(), 3);
    restored.series();  // who looks at a state does not change it
    restored.steps(2, 0.002);
    EXPECT_EQ(restored.method.time(), straight.method.time());
    EXPECT_EQ(restored.saved_state(), straight.saved_state());
    EXPECT_EQ(restored.method.step_limit().dt, straight.method.step_limit().dt);
    EXPECT_EQ(restored.series(), straight.series());
  }
}

TEST_P(GfdState, DoesNotDependOnTheNumberOfThreads) {
  const int before = omp_get_max_threads();
  for (const std::string viscosity : {"explicit", "implicit"}) {
    std::vector<std::map<std::string, std::vector<double>>> states;
    for (const int threads : {1, 2, 3}) {
      omp_set_num_threads(threads);
      GfdRun run(GetParam(), {"time.viscosity=\"" + viscosity + "\""});
      run.steps(4, 0.002);
      states.push_back(run.saved_state());
    }
    EXPECT_EQ(states[0], states[1]) << viscosity;
    EXPECT_EQ(states[0], states[2]) << viscosity;
  }
  omp_set_num_threads(before);
}

TEST_P(GfdState, ARefusedStepLeavesIt) {
  EXPECT_EQ(changed_by_a_refused_step<gfd::Gfd>(GetParam(), {}, 0.002), "");
  EXPECT_EQ(changed_by_a_refused_step<gfd::Gfd>(GetParam(), {"time.viscosity=\"implicit\""}, 0.002), "");
}

const char* const state_names[] = {"Drop2D", "Ball3D", "ThreeLayers", "TurningTank"};

INSTANTIATE_TEST_SUITE_P(Cases, GfdState,
                         ::testing::Values(drop_in_a_box, ball_in_a_box, three_layers, drop_in_a_turning_tank),
                         [](const auto& info) { return state_names[info.index]; });

TEST(GfdAllocations, ASteadyRunAllocatesNothing) {
  const OneThread alone;
  for (const auto& [text, set] : {std::pair(drop_in_a_box, Overrides{}), std::pair(ball_in_a_box, Overrides{}),
                                  std::pair(ball_in_a_box, Overrides{"time.viscosity=\"implicit\""})}) {
    GfdRun run(text, set);
    run.steps(10, 0.002);
    const auto before = array_statistics();
    run.steps(5, 0.002);
    EXPECT_EQ(array_statistics().allocations, before.allocations) << text;
    EXPECT_EQ(array_statistics().bytes, before.bytes);
  }
}

// With nothing left to gain the fall of the drop comes from nothing.
TEST(GfdEnergy, AStepThatMakesItIsRefusedAndTheStateIsKept) {
  GfdRun run(drop_in_a_box, {"fluid.gravity=10", "interface.surface_tension=0"});
  run.steps(10, 0.002);
  auto& flow = const_cast<gfd::Flow&>(run.flow());
  const double supply = flow.energy_supply;
  flow.energy_supply = flow.potential_energy() - 1;
  const auto before = run.saved_state();
  try {
    run.steps(100, 0.004);
    FAIL() << "accepted";
  } catch (const StepFailure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("energy from nothing"));
  }
  EXPECT_LT(run.method.step_count(), 110);
  EXPECT_GT(run.saved_state().size(), 5U);
  flow.energy_supply = supply;
  run.steps(1, 0.002);
  EXPECT_NE(run.saved_state(), before);
}

std::vector<std::string> running(const GfdRun& run) {
  std::vector<std::string> names;
  for (const Stage& stage : run.method.plan())
    if (stage.on) names.push_back(stage.name);
  return names;
}

TEST(GfdPlan, OnePhaseHasNoInterface) {
  const std::string one = replaced(replaced(replaced(drop_in_a_box, "[interface]\nsurface_tension = 1\n", ""),
                                            "[[region]]\nphase = \"drop\"\ncentre = [0.5, 0.5]\nradius = 0.25\n", ""),
                                   "[[phase]]\nname = \"drop\"\ndensity = 10\nviscosity = 0.1\n", "");
  GfdRun run(one);
  run.steps(2, 0.002);
  for (const char* name : {"bands", "potentials", "viscosity gradient"})
    EXPECT_THAT(running(run), testing::Not(testing::Contains(std::string(name))));
  EXPECT_EQ(run.flow().bands.varies(), nullptr);
  EXPECT_TRUE(run.flow().colours.empty());
  EXPECT_EQ(run.max_speed(), 0) << "still liquid";
}

TEST(GfdPlan, EveryStageCountsItsTrafficAndTheViscosityHasAGradientWhereOneIsRead) {
  for (const std::string form : {"split", "printed", "rotation-free", "mu-laplacian"}) {
    GfdRun run(drop_in_a_box, {"momentum.diffusion=\"" + form + "\"", "time.viscosity=\"implicit\""});
    run.steps(3, 0.002);
    EXPECT_EQ(uncounted_stages(run.method, run.ledger), "") << form;
    const auto names = running(run);
    EXPECT_EQ(std::count(names.begin(), names.end(), "viscosity gradient"), form == "split" || form == "printed")
        << form;
  }
}

std::string refused(const std::string& text, const Overrides& overrides = {}) {
  try {
    load_text(text, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(GfdCases, WhatItCannotDoIsRefusedWithTheFix) {
  EXPECT_THAT(refused(drop_in_a_box, {"pressure.solver=\"cg\""}), HasSubstr("use \"bicgstab\""));
  EXPECT_THAT(refused(drop_in_a_box, {"phase.1.sound_speed=340"}), HasSubstr("remove sound_speed"));
  EXPECT_THAT(refused(drop_in_a_box, {"region.0.where=\"0.9 - y\""}), HasSubstr("no free surface"));
  EXPECT_THAT(refused(drop_in_a_box, {"domain.top=\"open\""}), HasSubstr("no free surface"));
  EXPECT_THAT(refused(replaced(drop_in_a_box, "[[region]]\nphase = \"drop\"", "[[region]]\nphase = \"outside\"")),
              HasSubstr("phase 'drop' fills nothing"));
  EXPECT_THAT(refused(drop_in_a_box, {"interface.surface_tension=-1"}), HasSubstr(">= 0"));
  EXPECT_THAT(refused(drop_in_a_box, {"momentum.diffusion=\"full\""}), HasSubstr("split"));
}

// Each is told where it stands. A region that a later one covers, or of which nothing is left beside bodies; one that
// lies elsewhere; supports that do not fit.
TEST(GfdCases, RegionsThatCannotBeFilledAreRefusedAtTheirPlace) {
  const std::string covered = "[[region]]\nphase = \"outside\"\ncentre = [0.5, 0.5]\nradius = 0.3\n";
  EXPECT_THAT(refused(drop_in_a_box + covered), HasSubstr(":25:1: error: region.1 is empty: later regions replace"));
  EXPECT_THAT(refused(drop_in_a_box, {"region.1.centre=[1.5, 0.5]"}),
              HasSubstr("region.1 reaches outside the domain: x from 1.25 to 1.75, the domain's x from 0 to 1"));
  EXPECT_THAT(refused(replaced(drop_in_a_box, "viscosity = 0.1\n", "")),
              HasSubstr("missing key 'viscosity' in [[phase]]; add  viscosity ="));
  EXPECT_THAT(refused(drop_in_a_box, {"domain.upper=[0.2, 1]"}),
              HasSubstr("is shorter than two kernel supports and a spacing, 0.31; set spacing <="));
  EXPECT_THAT(refused(drop_in_a_box, {"resolution.smoothing_ratio=0.5"}), HasSubstr("must be >= 0.8"));
}

// The support is 0.13: a disc of 4 particles is 0.05 wide, layers of 2 rows are, those of 3 are 0.15.
TEST(GfdCases, RegionsThinnerThanTheSupportAreRefusedAtTheirPlace) {
  EXPECT_THAT(
      refused(drop_in_a_box, {"region.1.radius=0.06"}),
      HasSubstr(":25:1: error: region.1 is 0.05 wide; its interfaces need the kernel support, 0.13: widen it, or "
                "set resolution.spacing <= 0.0192"));
  const auto layer = [](const std::string& lower, const std::string& upper) {
    return Overrides{"region.1={phase=\"drop\", lower=[0, " + lower + "], upper=[1, " + upper + "]}"};
  };
  EXPECT_THAT(refused(drop_in_a_box, layer("0.5", "0.6")), HasSubstr("region.1 is 0.05 wide"));
  EXPECT_EQ(refused(drop_in_a_box, layer("0.5", "0.65")), "accepted");
  // At a wall it goes on behind: 2 rows are 4.
  EXPECT_EQ(refused(drop_in_a_box, layer("0", "0.1")), "accepted");
  EXPECT_THAT(refused(drop_in_a_box, layer("0", "0.05")), HasSubstr("region.1 is 0.05 wide"));
  // What is left of the surroundings counts as well.
  EXPECT_THAT(refused(drop_in_a_box, layer("0.05", "1")), HasSubstr("region.0 is 0.05 wide"));
}

}  // namespace
}  // namespace spume::test
