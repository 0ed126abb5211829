// SPDX-License-Identifier: MIT
// Checkpoints, interrupted runs, and what a resumed run continues or refuses.
#include "run/driver_fixture.hpp"
#include "spume/io/checkpoint.hpp"

namespace spume {
namespace {

using testing::Each;
using testing::HasSubstr;

// A run that is killed continues from the last checkpoint, so there must be some on the way.
TEST_F(Driver, CheckpointsAreWrittenOnTheWay) {
  class Reader final : public Observer {
   public:
    explicit Reader(std::filesystem::path path) : path_(std::move(path)) {}
    void progress(const Progress& progress) override {
      if (progress.step != 5) return;
      Array<std::int64_t> counters;
      CheckpointReader(path_).i64("driver/counters", counters);
      step = counters[0];
    }
    void note(const std::string&) override {}
    std::int64_t step = -1;

   private:
    std::filesystem::path path_;
  };
  for (const auto& [every, expected] : {std::pair{"0.001", 4}, std::pair{"300", 0}}) {
    write_case(std::string("end = 0.1\nsleep = 0.002\ncheckpoint_every = ") + every + '\n');
    Reader reader(folder_ / every / "checkpoint.h5");
    start(every)->run(reader);
    EXPECT_EQ(reader.step, expected) << every;
  }
}

TEST_F(Driver, InterruptedAndResumedRunEqualsAnUninterruptedOne) {
  write_case(full_case);
  Watch watch;
  EXPECT_EQ(start("whole")->run(watch), RunState::finished);
  for (const std::int64_t stop : {1, 17, 40}) {
    const std::string name = "stopped-" + std::to_string(stop);
    Watch stopping(stop), continuing;
    EXPECT_EQ(start(name)->run(stopping), RunState::interrupted);
    EXPECT_EQ(static_cast<std::int64_t>(stopping.steps.size()), stop);
    EXPECT_EQ(summary(name)["state"], "interrupted");
    EXPECT_EQ(resume(name)->run(continuing), RunState::finished);
    EXPECT_EQ(stopping.steps.size() + continuing.steps.size(), watch.steps.size());
    expect_equal_results("whole", name);
    EXPECT_EQ(summary(name)["verdicts"], summary("whole")["verdicts"]);
  }
}

TEST_F(Driver, ARunKilledAfterItsCheckpointLosesNothingWhenResumed) {
  write_case(full_case);
  Watch watch, stopping(20), again(33), last;
  start("whole")->run(watch);
  start("killed")->run(stopping);
  // The checkpoint of step 20 with the results of step 33 is what a kill between two checkpoints leaves.
  std::filesystem::copy_file(folder_ / "killed" / "checkpoint.h5", folder_ / "old.h5");
  resume("killed")->run(again);
  std::filesystem::copy_file(folder_ / "old.h5", folder_ / "killed" / "checkpoint.h5",
                             std::filesystem::copy_options::overwrite_existing);
  resume("killed")->run(last);
  expect_equal_results("whole", "killed");
}

TEST_F(Driver, RefusedStepsResumeBitForBit) {
  write_case(std::string(full_case) + "largest_dt = 0.004\ndt = 0.01\n");
  Watch watch, stopping(30), continuing;
  start("whole")->run(watch);
  start("stopped")->run(stopping);
  resume("stopped")->run(continuing);
  expect_equal_results("whole", "stopped");
}

TEST_F(Driver, AFinishedRunContinuesOnlyToALaterTime) {
  write_case("end = 0.5\nevery = 0.25\n");
  Watch watch;
  start("run")->run(watch);
  EXPECT_THROW(resume("run"), InputError);
  EXPECT_THROW(resume("run", 0.4), InputError);
  EXPECT_EQ(resume("run", 0.75)->run(watch), RunState::finished);
  EXPECT_THAT(read_vtkhdf_contents(folder_ / "run" / "fluid.vtkhdf").times, testing::ElementsAre(0, 0.25, 0.5, 0.75));
}

TEST_F(Driver, AnEndFromTheCommandLineOutlivesAnInterruption) {
  write_case("end = 0.2\n");
  LoadedCase loaded = load_fake_case((folder_ / "case.toml").string(), {until_override(1.0)});
  Watch stopping(40), again(60), watch;
  EXPECT_EQ(Simulation::start(std::move(loaded), make_fake_method, folder_ / "run")->run(stopping),
            RunState::interrupted);
  ASSERT_GT(summary("run")["time"], 0.2);
  EXPECT_EQ(resume("run", 1.25)->run(again), RunState::interrupted);
  EXPECT_EQ(resume("run")->run(watch), RunState::finished);
  EXPECT_EQ(summary("run")["time"], 1.25);
}

TEST_F(Driver, OnlyValuesCountAsAChangedCase) {
  write_case("end = 0.5\nevery = 0.25\n");
  Watch stopping(3), again(4), last;
  start("run")->run(stopping);
  const auto file = folder_ / "run" / "case.toml";
  test::write_contents(file, "every = 2.5e-1 # case\n\nend   =  0.50 # case\n");
  resume("run")->run(again);
  EXPECT_THAT(again.notes, Each(testing::Not(HasSubstr("changed"))));
  test::write_contents(file, "end = 0.5\nevery = 0.125\n");
  resume("run")->run(last);
  EXPECT_THAT(last.notes, testing::Contains(HasSubstr("every = 0.125, at the checkpoint 0.25")));
  EXPECT_THAT(contents(folder_ / "run" / "log.txt"), HasSubstr("every = 0.125, at the checkpoint 0.25"));
}

TEST_F(Driver, ACheckpointOfAnotherBoxSpacingOrMethodIsRefused) {
  const std::string text = "end = 0.5\nmethod = \"a\"\ndomain.upper = [1, 1]\nresolution.spacing = 0.1\n";
  write_case(text);
  Watch stopping(3), watch;
  start("run")->run(stopping);
  const auto refusal_of = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    test::write_contents(folder_ / "run" / "case.toml", changed);
    try {
      resume("run");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal_of("\"a\"", "\"b\""), HasSubstr("method = \"b\", at the checkpoint \"a\""));
  EXPECT_THAT(refusal_of("1, 1]", "1, 2]"), HasSubstr("domain.upper = [1, 2], at the checkpoint [1, 1]"));
  EXPECT_THAT(refusal_of("1, 1]", "1, 1, 1]"), HasSubstr("does not fit the changed case"));
  EXPECT_THAT(refusal_of("0.1", "0.2"), HasSubstr("resolution.spacing = 0.2, at the checkpoint 0.1"));
  EXPECT_EQ(refusal_of("0.1", "1e-1"), "");
  EXPECT_EQ(resume("run")->run(watch), RunState::finished);
}

TEST_F(Driver, ResumeNamesWhatIsWrong) {
  write_case("end = 0.3\n");
  EXPECT_THROW(resume("none"), InputError);
  Watch stopping(5);
  start("run")->run(stopping);
  const auto checkpoint = folder_ / "run" / "checkpoint.h5";
  const std::string good = contents(checkpoint);
  test::write_contents(checkpoint, good.substr(0, good.size() - 100));
  EXPECT_THROW(resume("run"), FileError);
  test::write_contents(checkpoint, good);
  std::filesystem::remove(folder_ / "run" / "series.csv");
  EXPECT_THROW(resume("run"), FileError);
}

TEST_F(Driver, ACheckpointWhoseDriverAndMethodDisagreeIsRefused) {
  write_case("end = 0.3\n");
  Watch stopping(5);
  start("run")->run(stopping);
  const auto checkpoint = folder_ / "run" / "checkpoint.h5", changed = folder_ / "changed.h5";
  {
    const CheckpointReader reader(checkpoint);
    CheckpointWriter writer(changed, reader.origin());
    for (const auto& entry : reader.entries()) {
      Array<double> reals;
      Array<std::int64_t> integers;
      if (entry.type == "f64") {
        reader.f64(entry.name, reals);
        writer.f64(entry.name, reals);
      } else {
        reader.i64(entry.name, integers);
        if (entry.name == "driver/counters") ++integers[0];
        writer.i64(entry.name, integers);
      }
    }
    writer.commit();
  }
  std::filesystem::rename(changed, checkpoint);
  try {
    resume("run");
    FAIL() << "no error";
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("method and driver disagree about the step"));
  }
}

}  // namespace
}  // namespace spume
