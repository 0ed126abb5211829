// SPDX-License-Identifier: MIT
// What the driver records: rows, tables, probes, remarks, summary, progress.
#include <sstream>

#include "run/driver_fixture.hpp"

namespace spume {
namespace {

using testing::HasSubstr;

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

}  // namespace
}  // namespace spume
