// SPDX-License-Identifier: MIT
// The plan of the spectral method against what its steps do.
#include <gmock/gmock.h>

#include <optional>

#include "methods/spectral_flow.hpp"
#include "methods/uncounted_stages.hpp"

namespace spume {
namespace {

using test::random_start;
using test::spectral_text;
using test::SpectralRun;
using test::uncounted_stages;
using testing::ElementsAreArray;

const std::string shell = "[forcing]\nkind = \"shell\"\nwidth = 2\ninjection = 0.7\n";

std::string particles(const std::string& coupling, const std::string& more = "") {
  return "[particles]\ncount = 500\ndiameter = 0.03\nbeta = 3\nresponse_time = 0.05\noverlap_samples = 0\n"
         "coupling = \"" +
         coupling + "\"\n" + more;
}

std::string flow(const std::string& integrator, const std::string& dealiasing = "padded") {
  return "[spectral]\nintegrator = \"" + integrator + "\"\ndealiasing = \"" + dealiasing + "\"\n";
}

std::vector<std::string> stages_of_a_step(const Method& method) {
  std::vector<std::string> names;
  for (const Stage& stage : method.plan())
    if (stage.on && stage.part != StagePart::start) names.push_back(stage.name);
  return names;
}

std::vector<std::string> stages_in(const Ledger& ledger) {
  std::vector<std::string> names;
  for (const Ledger::Entry& entry : ledger.entries()) names.push_back(entry.stage);
  return names;
}

std::optional<Ledger::Entry> entry_of(const Ledger& ledger, const std::string& stage) {
  for (const Ledger::Entry& entry : ledger.entries())
    if (entry.stage == stage) return entry;
  return {};
}

// And the ledger knows what each of them reads and writes.
TEST(SpectralPlan, NamesTheStagesThatTheLedgerTimes) {
  const std::string inviscid = "[initial]\nkind = \"random\"\nspectrum = \"k^2*exp(-(k/8)^2)\"\nenergy = 0.5\n";
  for (const std::string& rest :
       {random_start + flow("ab2"), random_start + flow("rk3", "none"), random_start + flow("rk4", "two-thirds"),
        inviscid + flow("rk4", "two-thirds"), random_start + shell + flow("ab2"),
        random_start + "[forcing]\nkind = \"linear\"\nrate = 0.3\n" + flow("rk4"),
        random_start + flow("ab2") + particles("one-way"), random_start + flow("rk3") + particles("two-way"),
        random_start + shell + flow("ab2") + particles("four-way", "sort_every = 2\n"),
        random_start + flow("ab2", "two-thirds") + particles("colliding", "frozen = true\n"),
        random_start + flow("ab2") + particles("one-way", "lyapunov = 3\nrecords = \"double\"\n")}) {
    SpectralRun<> run(spectral_text("[8, 12, 10]", rest));
    run.start().steps(3, 0.001);
    EXPECT_THAT(stages_in(run.ledger), ElementsAreArray(stages_of_a_step(run.method))) << rest;
    EXPECT_EQ(uncounted_stages(run.method, run.ledger), "") << rest;
  }
}

// In the words of the case file where it is off.
TEST(SpectralPlan, GivesTheReasonForEveryStage) {
  SpectralRun<> run(spectral_text("[8, 12, 10]", random_start + flow("ab2") + particles("one-way")));
  std::map<std::string, std::string> off;
  for (const Stage& stage : run.method.plan()) {
    EXPECT_FALSE(stage.reason.empty()) << stage.name;
    if (!stage.on) off[stage.name] = stage.reason;
  }
  EXPECT_EQ(off["forcing coefficient"], "forcing.kind = \"none\"");
  EXPECT_EQ(off["force to modes"], "particles.coupling = \"one-way\"");
  EXPECT_EQ(off["Lyapunov exponents"], "particles.lyapunov = 0");
}

// Calls in 4 steps. Padding gives 3 remainders along x and none 2; the first step of Adams-Bashforth is a midpoint rule
// of two tendencies.
TEST(SpectralPlan, RunsStagesAsOftenAsTheSchemeNeedsThem) {
  struct Expected {
    const char *integrator, *dealiasing;
    int tendencies, remainders;
  };
  for (const Expected& e : {Expected{"ab2", "padded", 5, 3}, Expected{"rk3", "padded", 12, 3},
                            Expected{"rk4", "two-thirds", 20, 2}, Expected{"ab2", "none", 5, 2}}) {
    SpectralRun<> run(spectral_text("[8, 12, 10]", random_start + shell + flow(e.integrator, e.dealiasing) +
                                                       particles("two-way", "sort_every = 3\n")));
    run.start().steps(4, 0.001);
    const auto calls = [&](const std::string& stage) { return entry_of(run.ledger, stage)->calls; };
    EXPECT_EQ(calls("forcing coefficient"), e.tendencies) << e.integrator;
    EXPECT_EQ(calls("product in planes"), e.tendencies * e.remainders) << e.integrator;
    EXPECT_EQ(calls("forward transforms in x"), e.tendencies * (e.remainders - 1)) << e.integrator;
    EXPECT_EQ(calls("forward transforms in x, update"), e.tendencies) << e.integrator;
    EXPECT_EQ(calls("acceptance"), e.tendencies) << e.integrator;
    EXPECT_EQ(calls("energy balance"), 4) << e.integrator;
    EXPECT_EQ(calls("particle sort"), 2) << "at the first step and the fourth";
  }
}

TEST(SpectralPlan, CountsParticlesAndTrafficWhereTheyBelong) {
  SpectralRun<> run(spectral_text("[8, 12, 10]", random_start + flow("ab2") + particles("two-way")));
  run.start().steps(1, 0.001);
  EXPECT_EQ(entry_of(run.ledger, "product in planes")->particles, 6 * 8 * 12 * 10);  // two tendencies of 3 remainders
  EXPECT_EQ(entry_of(run.ledger, "particle motion")->particles, 500);
  const spectral::Flow<double>& flow = run.method.flow();
  const auto bytes = [](const auto& arrays) {
    double sum = 0;
    for (const auto& array : arrays) sum += 16.0 * static_cast<double>(array.size());
    return sum;
  };
  EXPECT_EQ(entry_of(run.ledger, "inverse transforms in x")->bytes,
            6 * (bytes(flow.potential()) + bytes(flow.planes())));
  EXPECT_GT(entry_of(run.ledger, "particle records")->bytes, 3 * 8.0 * 8 * 12 * 10);
}

TEST(SpectralPlan, LeavesARefusedStepOutOfTheBalance) {
  SpectralRun<> run(spectral_text("[8, 12, 10]", random_start + flow("rk3")));
  run.start();
  EXPECT_THROW(run.steps(1, 5 * run.method.step_limit().dt), StepFailure);
  EXPECT_EQ(entry_of(run.ledger, "acceptance")->calls, 1);  // its tendency was the first and the last
  EXPECT_FALSE(entry_of(run.ledger, "energy balance"));
}

}  // namespace
}  // namespace spume
