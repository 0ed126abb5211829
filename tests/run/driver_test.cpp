// SPDX-License-Identifier: MIT
#include "spume/run/driver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "spume/core/error.hpp"
#include "spume/io/checkpoint.hpp"
#include "spume/io/hdf5.hpp"
#include "spume/io/vtkhdf.hpp"
#include "support/fake_method.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using test::contents;
using test::load_fake_case;
using test::make_fake_method;
using test::TemporaryFolder;
using testing::Each;
using testing::HasSubstr;
using testing::Le;

// Watches a run; asks it to stop after a step, as a user would.
class Watch final : public Observer {
 public:
  explicit Watch(std::int64_t stop_after = -1) : stop_after_(stop_after) {}
  void progress(const Progress& progress) override {
    steps.push_back(progress.dt);
    limits.push_back(progress.limited_by);
    last = progress;
    if (progress.step == stop_after_) raise(SIGINT);
  }
  void note(const std::string& text) override { notes.push_back(text); }
  std::vector<double> steps;
  std::vector<std::string> notes, limits;
  Progress last;

 private:
  std::int64_t stop_after_;
};

class Driver : public testing::Test {
 protected:
  void write_case(const std::string& text) { test::write_contents(folder_ / "case.toml", text); }
  std::unique_ptr<Simulation> start(const std::string& name) {
    return Simulation::start(load_fake_case((folder_ / "case.toml").string(), {}), make_fake_method, folder_ / name);
  }
  std::unique_ptr<Simulation> resume(const std::string& name, std::optional<double> until = {}) {
    return Simulation::resume(folder_ / name, load_fake_case, make_fake_method, until);
  }
  std::string failure_of_run() {
    Watch watch;
    try {
      start("run")->run(watch);
    } catch (const NumericalFailure& failure) {
      return failure.what();
    }
    return {};
  }
  nlohmann::json summary(const std::string& name) {
    return nlohmann::json::parse(contents(folder_ / name / "summary.json"));
  }
  std::vector<float> stored(const std::string& name, const std::string& array) {
    const auto file = hdf5::File::open(folder_ / name / "fluid.vtkhdf", false);
    const auto data = file.dataset(array);
    const auto space = file.take(H5Dget_space(data), H5Sclose, "read");
    std::vector<float> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    file.check(H5Dread(data, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read");
    return values;
  }
  void expect_equal_results(const std::string& a, const std::string& b) {
    for (const char* file : {"series.csv", "probes.csv", "lines.csv", "spectrum.csv", "turns.csv", "places.csv"}) {
      EXPECT_FALSE(contents(folder_ / a / file).empty()) << file;
      EXPECT_EQ(contents(folder_ / a / file), contents(folder_ / b / file)) << file;
    }
    const auto first = read_vtkhdf_contents(folder_ / a / "fluid.vtkhdf");
    const auto second = read_vtkhdf_contents(folder_ / b / "fluid.vtkhdf");
    EXPECT_EQ(first.times, second.times);
    for (const char* array : {"/VTKHDF/Points", "/VTKHDF/PointData/velocity", "/VTKHDF/PointData/id",
                              "/VTKHDF/Vertices/Offsets", "/VTKHDF/Steps/PointOffsets"})
      EXPECT_EQ(stored(a, array), stored(b, array)) << array;
  }
  TemporaryFolder folder_;
};

constexpr const char* full_case =
    "end = 1.0\nevery = 0.13\nseries_every = 0.02\nspectrum_every = 0.3\nprobes = true\ndimensions = 3\n";

TEST_F(Driver, RecordsStartEveryOutputTimeAndEnd) {
  write_case("end = 1.0\nevery = 0.3\n");
  Watch watch;
  EXPECT_EQ(start("run")->run(watch), RunState::finished);
  EXPECT_THAT(read_vtkhdf_contents(folder_ / "run" / "fluid.vtkhdf").times,
              testing::Pointwise(testing::DoubleEq(), {0.0, 0.3, 0.6, 0.9, 1.0}));
  EXPECT_EQ(summary("run")["state"], "finished");
  EXPECT_EQ(summary("run")["final"]["t"], 1.0);
  EXPECT_EQ(summary("run")["steps"], static_cast<std::int64_t>(watch.steps.size()));
  for (const char* file : {"case.toml", "checkpoint.h5", "ledger.json", "log.txt", "series.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "run" / file)) << file;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run" / "probes.csv"));
}

TEST_F(Driver, ProbesHaveTheirColumns) {
  write_case("end = 0.05\nprobes = true\n");
  Watch watch;
  start("run")->run(watch);
  EXPECT_THAT(
      contents(folder_ / "run" / "probes.csv"),
      HasSubstr("\nt,tip_pressure,tip_velocity_x,tip_velocity_y,gauge,toe,gate_area,gate_pressure,gate_velocity_x,"
                "gate_velocity_y\n0,0.5,1,0.25,0.5,1.2,0.75,0,1,0.75\n"));
  EXPECT_THAT(contents(folder_ / "run" / "lines.csv"),
              HasSubstr("\nt,name,s,x,y,z,velocity_x,velocity_y,velocity_z,pressure\n0,cut,0,0,0,0,1,0,0,0\n"
                        "0,cut,2.5,1.5,2,0,1,2,0,1.5\n0,cut,5,3,4,0,1,4,0,3\n"));
}

// The copy in a run folder is read again, so a method that has lost its surface is refused there too.
TEST_F(Driver, AProbeThatTheMethodDoesNotHaveIsRefusedAtItsPlace) {
  write_case("end = 0.05\nprobes = true\nsurface = false\n");
  try {
    start("run");
    FAIL() << "no error";
  } catch (const InputError& error) {
    const std::string place = (folder_ / "case.toml").string() + ":1:1: error: ";
    EXPECT_EQ(error.what(), place +
                                "probe.1.kind needs a free surface, which method \"fake\" does not have; use "
                                "\"point\", \"line\" or \"plane\"");
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
  write_case("end = 0.05\nprobes = true\n");
  Watch stopping(2);
  start("run")->run(stopping);
  test::write_contents(folder_ / "run" / "case.toml", "end = 0.05\nprobes = true\nsurface = false\n");
  EXPECT_THROW(resume("run"), InputError);
  test::write_contents(folder_ / "run" / "case.toml", "end = 0.05\nprobes = true\n");
  EXPECT_NO_THROW(resume("run"));
}

TEST_F(Driver, TablesOfTheMethodHaveRowsAtTheirTimes) {
  write_case("title = \"Points\"\nend = 0.03\nspectrum_every = 0.02\nseries_every = 0.01\nevery = 0.015\ndt = 0.01\n");
  Watch watch;
  start("run")->run(watch);
  const auto times = [&](const std::string& table) {
    std::istringstream lines(contents(folder_ / "run" / (table + ".csv")));
    std::string found;
    for (std::string line; std::getline(lines, line);)
      if (std::isdigit(line[0]) != 0) found += line.substr(0, line.find(',')) + ' ';
    return found;
  };
  EXPECT_EQ(times("turns"), times("series").empty() ? "?" : "0 0.01 0.02 0.03 ");
  EXPECT_EQ(times("places"), "0 0 0.015 0.015 0.03 0.03 ");
  EXPECT_EQ(times("spectrum"), "0 0 0.02 0.02 0.03 0.03 ");
  EXPECT_THAT(contents(folder_ / "run" / "spectrum.csv"),
              HasSubstr("# Points: energy spectra\n# t: time\n# wavenumber: 1/length\n# energy: velocity^2 length\n"
                        "t,wavenumber,energy\n0,1,0\n"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run" / "nothing.csv"));
}

// A table that began after the checkpoint belongs to what the resumed run does again.
TEST_F(Driver, TablesThatBeganAfterTheCheckpointBeginAnew) {
  write_case("end = 1.0\n");
  Watch stopping(5), watch;
  start("run")->run(stopping);
  ASSERT_FALSE(std::filesystem::exists(folder_ / "run" / "spectrum.csv"));
  test::write_contents(folder_ / "run" / "spectrum.csv", "rows of steps that are done again\n");
  resume("run")->run(watch);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run" / "spectrum.csv"));
}

TEST_F(Driver, RemarksGoToTheLogAndThoseForAllToTheWatcher) {
  write_case("end = 0.1\n");
  Watch watch;
  start("run")->run(watch);
  EXPECT_THAT(watch.notes, testing::ElementsAre("the points are ready"));
  const std::string log = contents(folder_ / "run" / "log.txt");
  for (const char* text : {"the points are ready", "two steps are done"}) {
    EXPECT_THAT(log, HasSubstr(text));
    EXPECT_EQ(log.find(text), log.rfind(text)) << "given once";
  }
}

TEST_F(Driver, TheSummaryGivesVerdictsOnWhatMustHold) {
  write_case("end = 1.0\n");
  Watch watch;
  start("run")->run(watch);
  const auto verdicts = summary("run")["verdicts"];
  ASSERT_EQ(verdicts.size(), 2u);
  EXPECT_EQ(verdicts[0]["quantity"], "radius_drift");
  EXPECT_EQ(verdicts[0]["bound"], 1e-3);
  // The radius of the first point falls from 1 from step to step: the largest drift is the last.
  EXPECT_DOUBLE_EQ(verdicts[0]["value"].get<double>(), 1 - summary("run")["final"]["radius"].get<double>());
  EXPECT_EQ(verdicts[0]["verdict"], "FAIL");
  EXPECT_EQ(verdicts[1]["quantity"], "refused_steps");
  EXPECT_EQ(verdicts[1]["value"], 0);
  EXPECT_EQ(verdicts[1]["verdict"], "pass");
}

// The copy in the run folder is what a resumed run reads, and the case, with its references, is where it was.
TEST_F(Driver, TheSummaryNamesTheCaseAlsoAfterResuming) {
  const std::string given = (folder_ / "case.toml").string();
  const std::string relative = std::filesystem::relative(given).string();
  write_case("end = 1.0\n");
  Watch stopping(2), again(3), watch;
  Simulation::start(load_fake_case(relative, {}), make_fake_method, folder_ / "run")->run(stopping);
  EXPECT_EQ(summary("run")["case"], given);
  for (Watch* next : {&again, &watch}) {
    resume("run")->run(*next);
    EXPECT_EQ(summary("run")["case"], given);
  }
}

TEST_F(Driver, TheSummaryCountsTheTimeOfAllProcesses) {
  write_case("end = 0.2\nsleep = 0.02\n");
  Watch stopping(5), watch;
  start("run")->run(stopping);
  const double before = summary("run")["total_wall_seconds"];
  EXPECT_GE(before, 0.1);
  resume("run")->run(watch);
  const double wall = summary("run")["wall_seconds"], total = summary("run")["total_wall_seconds"];
  EXPECT_GE(wall, 0.02 * static_cast<double>(watch.steps.size()));
  // The checkpoint was written a moment before the summary.
  EXPECT_GE(total, wall + 0.1);
  EXPECT_LE(total, wall + before);
  EXPECT_EQ(summary("run")["steps_this_process"], static_cast<std::int64_t>(watch.steps.size()));
  EXPECT_NEAR(summary("run")["particle_steps_per_second"].get<double>(),
              50 * static_cast<double>(watch.steps.size()) / wall, 1e-6);
}

// 50 particles and at least 0.02 s a step; the rate is that of the whole of so short a run.
TEST_F(Driver, TheProgressGivesRateAndRemainingTime) {
  write_case("end = 1.0\nsleep = 0.02\n");
  Watch stopping(20);
  start("run")->run(stopping);
  const Progress& last = stopping.last;
  EXPECT_EQ(last.step, 20);
  EXPECT_EQ(last.end, 1);
  EXPECT_GT(last.particle_steps_per_second, 0);
  EXPECT_LE(last.particle_steps_per_second, 50 / 0.02);
  const double wall = 20 * 50 / last.particle_steps_per_second;
  EXPECT_NEAR(last.remaining_seconds, (1 - last.time) / last.time * wall, 1e-9 * wall);
}

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

TEST_F(Driver, RefusedStepsAreHalvedAndGrowBack) {
  write_case("end = 1.0\nlargest_dt = 0.004\ndt = 0.01\n");
  Watch watch;
  EXPECT_EQ(start("run")->run(watch), RunState::finished);
  EXPECT_THAT(watch.steps, Each(Le(0.004)));
  EXPECT_THAT(watch.notes.at(1), HasSubstr("particle 7 at (0.25, 0.5), value 3.5"));
  EXPECT_THAT(watch.notes,
              ::testing::Contains(HasSubstr("refused with dt")).Times(summary("run")["retries"].get<int>()));
  EXPECT_THAT(watch.notes.back(), HasSubstr("verdict failed: "));
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

TEST_F(Driver, RefusedStepsResumeBitForBit) {
  write_case(std::string(full_case) + "largest_dt = 0.004\ndt = 0.01\n");
  Watch watch, stopping(30), continuing;
  start("whole")->run(watch);
  start("stopped")->run(stopping);
  resume("stopped")->run(continuing);
  expect_equal_results("whole", "stopped");
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
