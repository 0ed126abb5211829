// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "spume/io/vtkhdf.hpp"
#include "support/stored_values.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using test::contents;
using test::TemporaryFolder;
using testing::HasSubstr;

struct Outcome {
  int code = -1;
  std::string out, err;
};

class Verbs : public testing::Test {
 protected:
  void write_case(const std::string& text) { test::write_contents(folder_ / "case.toml", text); }

  // Starts the program in the test's folder with its output in files.
  pid_t launch(std::vector<std::string> arguments, rlim_t largest_file = RLIM_INFINITY) {
    const pid_t child = fork();
    if (child != 0) return child;
    if (chdir(folder_.path().c_str()) != 0) _exit(99);
    const auto redirect = [](const char* file, int to) { dup2(open(file, O_WRONLY | O_CREAT | O_TRUNC, 0644), to); };
    redirect(full_output_ ? "/dev/full" : "out", STDOUT_FILENO);
    redirect("err", STDERR_FILENO);
    const rlimit limit{largest_file, largest_file};
    setrlimit(RLIMIT_FSIZE, &limit);
    setenv("OMP_NUM_THREADS", "2", 1);
    std::vector<char*> words;
    std::string program = "/proc/self/exe", mark = "--as-spume";
    words.push_back(program.data());
    words.push_back(mark.data());
    for (auto& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    execv(program.c_str(), words.data());
    _exit(98);
  }
  Outcome finish(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), contents(folder_ / "out"),
            contents(folder_ / "err")};
  }
  Outcome spume(const std::vector<std::string>& arguments) { return finish(launch(arguments)); }
  std::vector<float> stored(const std::string& run, const std::string& field) {
    return test::stored_values(folder_ / run / "fluid.vtkhdf", "/VTKHDF/PointData/" + field);
  }
  void wait_for(const std::filesystem::path& path) {
    for (int i = 0; i < 1000 && !std::filesystem::exists(path); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }

  TemporaryFolder folder_;
  bool full_output_ = false;
};

TEST_F(Verbs, RunPrintsTablesAndNumbersItsFolders) {
  write_case("title = \"Turning\"\nend = 0.2\nevery = 0.1\n");
  const Outcome first = spume({"run", "case.toml"});
  EXPECT_EQ(first.code, 0) << first.err;
  for (const char* part :
       {"case        Turning", "threads     2", "share", "ns/part", "finished at t = 0.2", "results in"})
    EXPECT_THAT(first.out, HasSubstr(part));
  EXPECT_EQ(first.out.find('\r'), std::string::npos) << "a pipe gets plain lines";
  EXPECT_EQ(spume({"run", "case.toml", "--quiet"}).out, "");
  const auto name = folder_.path().filename().string();
  EXPECT_TRUE(std::filesystem::exists(folder_ / "runs" / (name + "-1") / "summary.json"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "runs" / (name + "-2") / "summary.json"));
}

TEST_F(Verbs, AQuietRunTellsFailedVerdictsAllTheSame) {
  write_case("end = 1.0\nlargest_dt = 0.004\ndt = 0.01\n");
  const Outcome run = spume({"run", "case.toml", "--quiet"});
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("verdict failed: refused_steps = "));
}

TEST_F(Verbs, BadCommandLinesAndCasesExitWith2AndCreateNothing) {
  write_case("end = 0.2\n");
  test::write_contents(folder_ / "bad.toml", "title = \"no end\"\n");
  test::write_contents(folder_ / "broken.toml", "end = = 3\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{}, "a verb is missing"},
      {{"fly"}, "unknown verb 'fly'"},
      {{"run"}, "case is required"},
      {{"run", "case.toml", "--fast"}, "--fast"},
      {{"run", "case.toml", "--threads", "0"}, "--threads is 0; give a number of threads from 1 to 1024"},
      {{"run", "case.toml", "--threads", "-2"}, "--threads is -2"},
      {{"run", "case.toml", "--threads", "two"}, "two"},
      {{"run", "case.toml", "--threads", "100000"}, "--threads is 100000; give a number of threads from 1 to 1024"},
      {{"run", "case.toml", "--until", "1e-300"}, "shorter than a billionth of the first step"},
      {{"run", "case.toml", "--until", "-1"}, "--until is -1"},
      {{"run", "bad.toml"}, "bad.toml:1:1: error: missing key 'end'"},
      {{"run", "broken.toml"}, "broken.toml:1:"},
      {{"check", "bad.toml"}, "missing key"},
      {{"run", "none.toml"}, "none.toml"},
      {{"resume", "none"}, "there is no run folder 'none'"},
      {{"info", "none"}, "there is no file 'none'"},
      {{"options", "nonsense"}, "there is no section 'nonsense'; there are time, output"},
      {{"run", "case.toml", "--set", "particles=-1"}, "the method needs particles"},
      {{"check", "case.toml", "--set", "probes=true", "--set", "surface=false"}, "probe.1.kind needs a free surface"},
      {{"run", "case.toml", "--set", "particles=9000000000000"}, "not enough memory"},
      {{"run", "case.toml", "-o", "/proc/run"}, "/proc/run"}};
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = spume(arguments);
    EXPECT_EQ(outcome.code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(outcome.err, HasSubstr(message)) << testing::PrintToString(arguments);
    EXPECT_THAT(outcome.err, HasSubstr("error: "));
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "runs"));
}

TEST_F(Verbs, SettingsReachTheCaseAndRepeat) {
  write_case("end = 0.2\n");
  EXPECT_EQ(spume({"run", "case.toml", "--set", "end=0.1", "--set", "particles=3", "-o", "out-dir"}).code, 0);
  EXPECT_THAT(contents(folder_ / "out-dir" / "summary.json"), HasSubstr("\"particles\": 3"));
  EXPECT_THAT(contents(folder_ / "out-dir" / "summary.json"), HasSubstr("\"end\": 0.1"));
}

TEST_F(Verbs, AnExistingResultIsRefused) {
  write_case("end = 0.1\n");
  EXPECT_EQ(spume({"run", "case.toml", "-o", "results"}).code, 0);
  const Outcome again = spume({"run", "case.toml", "-o", "results"});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("'results' is not empty"));
}

TEST_F(Verbs, NumericalFailureExitsWith3) {
  write_case("end = 1.0\nfails_from = 0.3\n");
  const Outcome outcome = spume({"run", "case.toml", "-o", "results"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("error: numerical failure at step"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "results" / "checkpoint.h5"));
}

TEST_F(Verbs, InterruptExitsWith130AndResumeGoesOn) {
  write_case("end = 1.0\nevery = 0.05\nsleep = 0.01\n");
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string name = "results-" + std::to_string(signal);
    const pid_t child = launch({"run", "case.toml", "-o", name});
    wait_for(folder_ / name / "fluid.vtkhdf");
    kill(child, signal);
    const Outcome outcome = finish(child);
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("spume resume " + name));
    EXPECT_EQ(spume({"resume", name, "--until", "0.4"}).code, 0);
    EXPECT_THAT(contents(folder_ / name / "summary.json"), HasSubstr("\"time\": 0.4"));
  }
}

TEST_F(Verbs, ASecondSignalEndsAtOnce) {
  write_case("end = 1.0\nsleep = 30.0\n");
  const pid_t child = launch({"run", "case.toml", "-o", "results"});
  wait_for(folder_ / "results" / "series.csv");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto start = std::chrono::steady_clock::now();
  kill(child, SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(child, SIGINT);
  EXPECT_EQ(finish(child).code, 130);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

// A limit on the size of files stands for a full disk: the write that crosses it fails in the same way.
TEST_F(Verbs, AFileThatCannotGrowEndsTheRunWithItsNameAndTheReason) {
  write_case("end = 1.0\nevery = 0.01\nparticles = 5000\n");
  const Outcome outcome = finish(launch({"run", "case.toml", "-o", "results"}, 3'000'000));
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("cannot write 'results/fluid.vtkhdf': File too large"));
  // What was recorded before is whole, and the run goes on from where the record broke off.
  const auto recorded = read_vtkhdf_contents(folder_ / "results" / "fluid.vtkhdf");
  EXPECT_GE(recorded.times.size(), 3u);
  EXPECT_EQ(spume({"resume", "results"}).code, 0);
  EXPECT_EQ(spume({"run", "case.toml", "-o", "whole"}).code, 0);
  EXPECT_EQ(contents(folder_ / "results" / "series.csv"), contents(folder_ / "whole" / "series.csv"));
  EXPECT_EQ(read_vtkhdf_contents(folder_ / "results" / "fluid.vtkhdf").times,
            read_vtkhdf_contents(folder_ / "whole" / "fluid.vtkhdf").times);
  for (const char* field : {"velocity", "turn"}) EXPECT_EQ(stored("results", field), stored("whole", field)) << field;
}

TEST_F(Verbs, WithoutMemoryARunNamesACheckpointOnlyWhereThereIsOne) {
  write_case("end = 1.0\nmemory_until = 0.3\n");
  const Outcome outcome = spume({"run", "case.toml", "-o", "results"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("not enough memory to go on at t = 0.3"));
  EXPECT_THAT(outcome.err, HasSubstr("spume resume results continues from the checkpoint of step 0"));
  write_case("end = 1.0\nmemory_until = -1.0\n");
  const Outcome early = spume({"run", "case.toml", "-o", "early", "--set", "solvable=false"});
  EXPECT_EQ(early.code, 3);
  EXPECT_THAT(early.err, HasSubstr("there is no checkpoint to resume from"));
}

TEST_F(Verbs, ARunWhoseReaderLeavesGoesOnToItsEnd) {
  write_case("end = 0.5\nfails_from = 1e30\n");
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command = "cd '" + folder_.path().string() + "' && { '" + program +
                              "' --as-spume run case.toml -o results; echo $? > code; } | true";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(contents(folder_ / "code"), "0\n");
  EXPECT_THAT(contents(folder_ / "results" / "summary.json"), HasSubstr("\"state\": \"finished\""));
}

TEST_F(Verbs, NoRoomBeforeTheFirstStepExitsWith2) {
  write_case("end = 1.0\nparticles = 5000\n");
  const Outcome outcome = finish(launch({"run", "case.toml", "-o", "results"}, 100'000));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("File too large"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results" / "fluid.vtkhdf"))
      << "a file without a snapshot cannot be read";
}

TEST_F(Verbs, CheckPrintsPlanMemoryAndTime) {
  write_case("end = 1.0\n");
  const Outcome outcome = spume({"check", "case.toml"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* part : {"  aim      on   always (at the start only)\n  turn     on   always\n  bubbles  off  the "
                           "case has no [bubbles]\n",
                           "48.0 B per particle", "limited by", "machine has"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "runs"));
}

TEST_F(Verbs, WhatHasNoEffectIsToldByCheckAndByARunAtItsStartAndItsEnd) {
  write_case("end = 0.05\nidle = 1\n");
  const std::string warning = "case.toml:2:1: warning: idle has no effect\n";
  EXPECT_THAT(spume({"check", "case.toml"}).out, HasSubstr(warning));
  const Outcome run = spume({"run", "case.toml", "-o", "results"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_LT(run.out.find(warning), run.out.rfind(warning)) << "twice";
  const std::string log = contents(folder_ / "results" / "log.txt"), text = "warning: idle has no effect";
  EXPECT_LT(log.find(text), log.find("two steps are done"));
  EXPECT_GT(log.rfind(text), log.find("two steps are done"));
}

TEST_F(Verbs, OutputThatCannotBeWrittenExitsWith2) {
  write_case("end = 0.1\n");
  full_output_ = true;
  for (const std::vector<std::string>& verb : {std::vector<std::string>{"check", "case.toml"},
                                               {"info", "case.toml"},
                                               {"options"},
                                               {"--help"},
                                               {"--version"}}) {
    const Outcome outcome = spume(verb);
    EXPECT_EQ(outcome.code, 2) << verb[0];
    EXPECT_THAT(outcome.err, HasSubstr("the output could not be written; is the disk full?")) << verb[0];
  }
  EXPECT_EQ(spume({"run", "case.toml", "-o", "results"}).code, 0) << "its files are its results";
}

TEST_F(Verbs, InfoDescribesEveryKindOfFile) {
  write_case("end = 0.1\nevery = 0.05\n");
  ASSERT_EQ(spume({"run", "case.toml", "-o", "results"}).code, 0);
  EXPECT_THAT(spume({"info", "results"}).out, HasSubstr("finished"));
  EXPECT_THAT(spume({"info", "results"}).out, HasSubstr("  refused_steps              0, bound 1: pass\n"));
  EXPECT_THAT(spume({"info", "results/fluid.vtkhdf"}).out, HasSubstr("3 snapshots"));
  EXPECT_THAT(spume({"info", "results/checkpoint.h5"}).out, HasSubstr("method/position_0"));
  EXPECT_THAT(spume({"info", "case.toml"}).out, HasSubstr("method fake"));
  test::write_contents(folder_ / "bad.h5", "hello");
  const Outcome bad = spume({"info", "bad.h5"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("not a Spume checkpoint"));
}

TEST_F(Verbs, OptionsListOneSectionOrAll) {
  EXPECT_THAT(spume({"options"}).out, HasSubstr("[output]"));
  const Outcome time = spume({"options", "time"});
  EXPECT_THAT(time.out, HasSubstr("Time at which the run ends"));
  EXPECT_EQ(time.out.find("[output]"), std::string::npos);
}

TEST_F(Verbs, ThreadsWaitPassivelyUnlessTheUserSaysOtherwise) {
  unsetenv("OMP_WAIT_POLICY");
  setenv("OMP_DISPLAY_ENV", "verbose", 1);  // the runtime prints what it has read, once per start
  EXPECT_THAT(spume({"options"}).err, HasSubstr("GOMP_SPINCOUNT = '1000'"));
  setenv("GOMP_SPINCOUNT", "77", 1);
  EXPECT_THAT(spume({"options"}).err, HasSubstr("GOMP_SPINCOUNT = '77'"));
  unsetenv("GOMP_SPINCOUNT");
  unsetenv("OMP_DISPLAY_ENV");
}

// A bound runtime pins the first thread before the program restarts: the restarted one must find all cores again.
TEST_F(Verbs, BoundThreadsKeepEveryCoreThroughTheRestart) {
  setenv("OMP_PROC_BIND", "true", 1);
  setenv("OMP_DISPLAY_ENV", "true", 1);
  const std::string err = spume({"options"}).err;
  unsetenv("OMP_DISPLAY_ENV");
  unsetenv("OMP_PROC_BIND");
  std::vector<std::string> places;
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);)
    if (line.find("OMP_PLACES") != std::string::npos) places.push_back(line);
  ASSERT_GE(places.size(), 2U) << err;
  EXPECT_EQ(places.front(), places.back());
}

TEST_F(Verbs, ScriptsGetTheirArgumentsAndTheirExitCodeIsPassedOn) {
  const auto package = folder_ / "tools" / "spume_tools";
  for (const char* name : {"verify", "plots", "compare"}) std::filesystem::create_directories(package / name);
  test::write_contents(
      package / "verify" / "__main__.py",
      "import sys\nprint(sys.argv[1:])\n"
      "import os\nprint(sorted(k for k in os.environ if 'SPUME_S' in k or 'GOMP' in k))\nsys.exit(1)\n");
  test::write_contents(package / "plots" / "__main__.py", "import sys\nprint('plot', sys.argv[1:])\n");
  test::write_contents(package / "compare" / "__main__.py", "import sys\nprint('compare', sys.argv[1:])\n");
  test::write_contents(folder_ / "runpy.py", "raise SystemExit('a file of the working folder was imported')\n");
  setenv("SPUME_HOME", folder_.path().c_str(), 1);
  const Outcome verify = spume({"verify", "couette", "--quick"});
  EXPECT_EQ(verify.code, 1) << verify.err;
  EXPECT_THAT(verify.out, HasSubstr("test_cli', 'couette', '--quick']"));
  EXPECT_THAT(verify.out, HasSubstr("\n[]\n")) << "settings for this process are not handed on";
  EXPECT_THAT(spume({"plot", "results"}).out, HasSubstr("plot ['results']"));
  EXPECT_THAT(spume({"compare", "a", "b", "--no-pictures"}).out, HasSubstr("compare ['a', 'b', '--no-pictures']"));
  EXPECT_THAT(spume({"plot", "a", "b", "--fields", "speed", "pressure", "--plane", "y=0.5", "--animate"}).out,
              HasSubstr("plot ['a', 'b', '--fields', 'speed', 'pressure', '--plane', 'y=0.5', '--animate']"));
  test::write_contents(package / "plots" / "__main__.py", "import os\nprint(len(os.sched_getaffinity(0)), 'cores')\n");
  cpu_set_t processors;
  sched_getaffinity(0, sizeof processors, &processors);
  setenv("OMP_PROC_BIND", "true", 1);
  EXPECT_EQ(spume({"plot", "results"}).out, std::to_string(CPU_COUNT(&processors)) + " cores\n")
      << "runs started by a script use every core though the threads of this program are bound";
  unsetenv("OMP_PROC_BIND");
  setenv("SPUME_HOME", "/nowhere", 1);
  EXPECT_EQ(spume({"verify"}).code, 2);
  unsetenv("SPUME_HOME");
}

TEST_F(Verbs, CasesThatCameWithTheProgramAreFoundByName) {
  const auto home = folder_ / "home";
  for (const char* name : {"wave", "tank"}) {
    std::filesystem::create_directories(home / "cases" / name);
    test::write_contents(home / "cases" / name / "case.toml", "end = 0.1\n");
  }
  setenv("SPUME_HOME", home.c_str(), 1);
  EXPECT_EQ(spume({"run", "wave", "-o", "results"}).code, 0);
  std::filesystem::create_directories(folder_ / "cases" / "tank");
  test::write_contents(folder_ / "cases" / "tank" / "case.toml", "title = \"Own tank\"\nend = 0.1\n");
  EXPECT_THAT(spume({"check", "tank"}).out, HasSubstr("Own tank")) << "those of the working folder go first";
  const Outcome misspelt = spume({"check", "wale"});
  EXPECT_EQ(misspelt.code, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("did you mean 'wave'?"));
  unsetenv("SPUME_HOME");
}

TEST_F(Verbs, ViewSaysWhatItCannotShow) {
  const auto none = spume({"view", (folder_ / "none").string()});
  EXPECT_EQ(none.code, exit_input);
  EXPECT_THAT(none.err, HasSubstr("is not there"));
  const auto empty = spume({"view", folder_.path().string()});
  EXPECT_EQ(empty.code, exit_input);
  EXPECT_THAT(empty.err, HasSubstr("holds no states"));
  EXPECT_EQ(spume({"view"}).code, exit_input);
  EXPECT_EQ(spume({"view", "a", "b", "c"}).code, exit_input);
}

}  // namespace
}  // namespace spume
