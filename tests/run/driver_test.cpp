// SPDX-License-Identifier: MIT
// Steps that are refused, and folders that runs may not share.
#include "run/driver_fixture.hpp"
#include "spume/io/checkpoint.hpp"

namespace spume {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Le;

TEST_F(Driver, RefusedStepsAreHalvedAndGrowBack) {
  write_case("end = 1.0\nlargest_dt = 0.004\ndt = 0.01\n");
  Watch watch;
  EXPECT_EQ(start("run")->run(watch), RunState::finished);
  EXPECT_THAT(watch.steps, Each(Le(0.004)));
  EXPECT_THAT(watch.notes.at(1), HasSubstr("particle 7 at (0.25, 0.5), value 3.5"));
  EXPECT_THAT(watch.notes,
              ::testing::Contains(HasSubstr("refused with dt")).Times(summary("run")["retries"].get<int>()));
  EXPECT_THAT(watch.notes.back(), HasSubstr("verdict failed: refused_steps"));
  EXPECT_EQ(watch.limits[0], "a refused step");
  // Two refusals lead from 0.01 below 0.004. From then on every step is tried at twice the length of the one before it,
  // which is refused, so that there are about as many refusals as steps.
  EXPECT_GT(watch.notes.size(), watch.steps.size() / 2);
  for (std::size_t i = 1; i < watch.steps.size(); ++i) EXPECT_LE(watch.steps[i], 2.0000001 * watch.steps[i - 1]);
}

TEST_F(Driver, NoStepExceedsTheLargestThatTheCaseAllows) {
  write_case("end = 0.2\n");
  LoadedCase loaded = load_fake_case((folder_ / "case.toml").string(), {});
  loaded.options.time.max_step = 0.003;
  Watch watch;
  Simulation::start(std::move(loaded), make_fake_method, folder_ / "run")->run(watch);
  EXPECT_THAT(watch.steps, Each(Le(0.003)));
}

TEST_F(Driver, GivesUpWithWordsAndLeavesTheLastGoodState) {
  write_case("end = 1.0\nfails_from = 0.5\nmax_retries = 3\nevery = 0.4\n");
  const std::string message = failure_of_run();
  for (const char* part : {"numerical failure at step", "a particle moved further than its spacing", "checkpoint.h5",
                           "particle 7 at (0.25, 0.5), value 3.5", "refused 4 times", "its length is not the cause"})
    EXPECT_THAT(message, HasSubstr(part));
  const auto times = read_vtkhdf_contents(folder_ / "run" / "fluid.vtkhdf").times;
  ASSERT_EQ(times.size(), 3u);
  EXPECT_GE(times.back(), 0.5);
  const CheckpointReader checkpoint(folder_ / "run" / "checkpoint.h5");
  Array<double> clock;
  checkpoint.f64("driver/clock", clock);
  EXPECT_EQ(static_cast<float>(clock[0]), static_cast<float>(times.back()));
  EXPECT_EQ(summary("run")["state"], "numerical failure");
}

TEST_F(Driver, RecordsWhatItHasPrepared) {
  write_case("end = 0.05\nprepares = 3\n");
  Watch watch;
  EXPECT_EQ(start("run")->run(watch), RunState::finished);
  EXPECT_THAT(watch.prepared, ElementsAre("round 0", "round 1", "round 2"));
  EXPECT_THAT(contents(folder_ / "run" / "series.csv"), HasSubstr(",3,"));  // the first turn
}

TEST_F(Driver, StoppedWhileItPreparesItLeavesNothingToContinue) {
  write_case("end = 0.05\nprepares = 3\n");
  Watch stopping(-1, "round 1"), watch;
  EXPECT_EQ(start("run")->run(stopping), RunState::interrupted);
  EXPECT_EQ(stopping.prepared.size(), 2U);
  EXPECT_TRUE(stopping.steps.empty());
  EXPECT_THAT(stopping.notes.back(), HasSubstr("start the run again"));
  EXPECT_EQ(summary("run")["state"], "interrupted");
  EXPECT_THROW(resume("run"), InputError);
}

TEST_F(Driver, AFailureBeforeTheFirstStepSaysThatNothingCanBeContinued) {
  write_case("end = 1.0\nsolvable = false\n");
  const std::string message = failure_of_run();
  EXPECT_THAT(message, HasSubstr("the pressure solve did not converge"));
  EXPECT_THAT(message, HasSubstr("there is no checkpoint to resume from"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run" / "checkpoint.h5"));
}

// Steps of a sixtieth of what the method allows, each found by refusals: the end would be 6000 steps away.
TEST_F(Driver, GivesUpWhereRefusedStepsNoLongerAdvance) {
  write_case("end = 1.0\nlargest_dt = 0.00017\ndt = 0.01\nmax_retries = 6\n");
  Watch watch;
  EXPECT_THROW(start("run")->run(watch), NumericalFailure);
  EXPECT_GT(watch.steps.size(), 100u);
  EXPECT_LT(watch.steps.size(), 500u);
}

TEST_F(Driver, AFullFolderIsNeverOverwritten) {
  write_case("end = 0.1\n");
  Watch watch;
  start("run")->run(watch);
  const std::string before = contents(folder_ / "run" / "series.csv");
  EXPECT_THROW(start("run"), InputError);
  EXPECT_EQ(contents(folder_ / "run" / "series.csv"), before);
}

TEST_F(Driver, NothingIsCreatedForACaseThatTheMethodRefuses) {
  write_case("end = 0.1\nparticles = -1\n");
  EXPECT_THROW(start("run"), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
}

TEST_F(Driver, TwoProgramsDoNotWorkInOneFolder) {
  write_case("end = 0.1\n");
  Watch watch;
  start("run")->run(watch);
  const auto first = resume("run", 0.2);
  EXPECT_THROW(resume("run", 0.3), InputError);
}

}  // namespace
}  // namespace spume
