// SPDX-License-Identifier: MIT
// A method that no file of the program knows runs through the whole of it: case file, driver, results, checkpoints,
// `spume check`. And it is short.
#include "toy_method/heat_conduction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "spume/cli/program.hpp"
#include "spume/core/kernel.hpp"
#include "spume/io/checkpoint.hpp"
#include "spume/scene/load.hpp"
#include "support/stored_values.hpp"
#include "support/temporary_folder.hpp"
#include "support/watch.hpp"

namespace spume::test {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

const std::filesystem::path sources = std::filesystem::path(SPUME_SOURCE_DIR) / "tests/toy_method";

// Of case.toml.
constexpr double diffusivity = 0.1, spacing = 0.0125, smoothing_length = 1.3 * spacing;
constexpr double support_radius = WendlandC2::support * smoothing_length;
constexpr double wavenumber2 = 8 * pi * pi;  // (2 pi)^2 along x and along y
const double kr = std::sqrt(wavenumber2) * support_radius;

const CaseSchema& schema() {
  static const CaseSchema made({heat_conduction()});
  return made;
}
LoadedCase load(const std::string& path, const std::vector<std::string>& overrides) {
  return load_case(path, overrides, schema());
}
std::unique_ptr<Method> make(const LoadedCase& loaded) {
  return heat_conduction().make(loaded);
}

// Rows of a file of results below its heading.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& path, std::string& heading) {
  std::istringstream lines(contents(path));
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    if (std::isalpha(static_cast<unsigned char>(line[0])) != 0) {
      heading = line;
      continue;
    }
    rows.emplace_back();
    std::istringstream values(line);
    for (std::string value; std::getline(values, value, ',');) rows.back().push_back(std::stod(value));
  }
  return rows;
}

class ToyMethod : public testing::Test {
 protected:
  std::unique_ptr<Simulation> start(const std::string& name, const std::vector<std::string>& overrides = {}) {
    return Simulation::start(load((sources / "case.toml").string(), overrides), make, folder_ / name);
  }
  std::vector<float> stored(const std::string& run, const std::string& array) {
    return stored_values(folder_ / run / "fluid.vtkhdf", array);
  }
  // Amplitude of cos(2 pi x) cos(2 pi y) in the last snapshot.
  double amplitude(const std::string& run, std::size_t particles) {
    const auto points = stored(run, "/VTKHDF/Points"), temperature = stored(run, "/VTKHDF/PointData/temperature");
    double sum = 0;
    for (std::size_t i = temperature.size() - particles; i < temperature.size(); ++i)
      sum += temperature[i] * std::cos(2 * pi * points[3 * i]) * std::cos(2 * pi * points[3 * i + 1]);
    return 4 * sum / static_cast<double>(particles);
  }
  void expect_equal_results(const std::string& a, const std::string& b) {
    for (const char* file : {"series.csv", "probes.csv"}) {
      EXPECT_FALSE(contents(folder_ / a / file).empty()) << file;
      EXPECT_EQ(contents(folder_ / a / file), contents(folder_ / b / file)) << file;
    }
    for (const char* array : {"/VTKHDF/Points", "/VTKHDF/PointData/temperature"})
      EXPECT_EQ(stored(a, array), stored(b, array)) << array;
    const CheckpointReader first(folder_ / a / "checkpoint.h5"), second(folder_ / b / "checkpoint.h5");
    for (const char* array : {"method/temperature", "method/position_x", "method/numbers"}) {
      Array<double> one, other;
      first.f64(array, one);
      second.f64(array, other);
      EXPECT_TRUE(std::equal(one.begin(), one.end(), other.begin(), other.end())) << array;
    }
  }
  TemporaryFolder folder_;
};

// Rate at which the sums damp the wave on the lattice: kappa' sum_j 2 g_j (1 - cos(2 pi x_j) cos(2 pi y_j)). The
// factor kappa' / kappa = 2 / div r, with div r = sum_j g_j |r_j|^2, makes it kappa k^2 for long waves.
double rate_on_the_lattice() {
  double damping = 0, divergence_of_position = 0;
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j) {
      const double r = spacing * std::hypot(i, j);
      const double g = -WendlandC2::f(r / smoothing_length) * WendlandC2::normalisation(2) * spacing * spacing /
                       std::pow(smoothing_length, 4);
      damping += 2 * g * (1 - std::cos(2 * pi * spacing * i) * std::cos(2 * pi * spacing * j));
      divergence_of_position += g * r * r;
    }
  return diffusivity * 2 / divergence_of_position * damping;
}

TEST_F(ToyMethod, AWaveDecaysAsItShouldOnTheLatticeAndInTheContinuum) {
  Watch watch;
  const auto run = start("run");
  EXPECT_EQ(run->run(watch), RunState::finished);
  EXPECT_EQ(watch.limits.back(), "diffusive");
  const double found = amplitude("run", run->method().particle_count());
  const double rate = rate_on_the_lattice();
  double expected = 1;
  for (const double dt : watch.steps) expected *= 1 - dt * rate;
  // Coordinates of up to 0.5 are floats: distances are good to 2^-25 / spacing = 2.4e-6, weights to some three times as
  // much, and so is the exponent of the decay, which is below 1.
  EXPECT_NEAR(found, expected, 1e-5 * expected);
  // cos x lies between 1 - x^2 / 2 and that plus x^4 / 24: the rate is too small by up to (k R)^2 / 12 of itself. A
  // step multiplies by 1 - x, x = rate dt, and log(1 - x) lies between -x - x^2 and -x for x < 1/2.
  const double exact_rate = diffusivity * wavenumber2, end = 0.1;
  EXPECT_LT(rate, exact_rate);
  EXPECT_GT(rate, exact_rate * (1 - kr * kr / 12));
  const double low = -exact_rate * exact_rate * watch.steps.front() * end, high = exact_rate * end * kr * kr / 12;
  EXPECT_GT(std::log(found) + exact_rate * end, low);
  EXPECT_LT(std::log(found) + exact_rate * end, high);
}

TEST_F(ToyMethod, HeatIsConserved) {
  Watch watch;
  start("run")->run(watch);
  std::string heading;
  const auto rows = rows_of(folder_ / "run" / "series.csv", heading);
  EXPECT_EQ(heading, "step,t,dt,heat,retries");
  ASSERT_EQ(rows.size(), watch.steps.size() + 1);
  EXPECT_NEAR(rows[0][3], 0.5, 1e-12);  // area times mean temperature
  // A particle exchanges in a step at most courant = 0.5 times the difference to its neighbours, k R at most, and its
  // weights are good to 7e-6 as above across the periodic sides, for one pair in ten, and to some 2^-22 elsewhere: 1e-6
  // in all. Errors of two particles are independent, those of one particle in two steps need not be; three deviations.
  const double n = 3200, volume = spacing * spacing;
  const double most = 3 * static_cast<double>(watch.steps.size()) * std::sqrt(n) * volume * 0.5 * kr * 1e-6;
  for (const auto& row : rows) ASSERT_NEAR(row[3], rows[0][3], most);
}

TEST_F(ToyMethod, AProbeFollowsTheWave) {
  Watch watch;
  const auto run = start("run");
  run->run(watch);
  std::string heading;
  const auto rows = rows_of(folder_ / "run" / "probes.csv", heading);
  EXPECT_EQ(heading, "t,top_temperature,top_velocity_x,top_velocity_y");
  // On the wall at an extremum of the wave, cos(pi) cos(pi) = 1, neighbours and images differ by up to A (k R)^2 / 2.
  for (const auto& [row, A] : {std::pair{rows.front(), 1.0}, std::pair{rows.back(), amplitude("run", 3200)}}) {
    EXPECT_LT(row[1], 1 + A);
    EXPECT_GT(row[1], 1 + A * (1 - kr * kr / 2));
  }
}

TEST_F(ToyMethod, ResultsDoNotDependOnTheNumberOfThreads) {
  const int before = omp_get_max_threads();
  for (const int threads : {1, 2}) {
    omp_set_num_threads(threads);
    Watch watch;
    start(std::to_string(threads))->run(watch);
  }
  omp_set_num_threads(before);
  expect_equal_results("1", "2");
}

TEST_F(ToyMethod, AResumedRunHasTheSameBits) {
  Watch watch, stopping(17), continuing;
  start("whole")->run(watch);
  EXPECT_EQ(start("stopped")->run(stopping), RunState::interrupted);
  EXPECT_EQ(Simulation::resume(folder_ / "stopped", load, make, {})->run(continuing), RunState::finished);
  EXPECT_EQ(stopping.steps.size() + continuing.steps.size(), watch.steps.size());
  expect_equal_results("whole", "stopped");
}

TEST_F(ToyMethod, TheLedgerNamesTheStagesOfThePlan) {
  Watch watch;
  const auto run = start("run");
  run->run(watch);
  const std::string ledger = contents(folder_ / "run" / "ledger.json");
  EXPECT_EQ(run->method().plan().size(), 2u);
  for (const Stage& stage : run->method().plan()) EXPECT_THAT(ledger, HasSubstr('"' + stage.name + '"'));
  for (const auto& entry : run->ledger().entries())
    if (entry.stage == "conduction") {
      EXPECT_EQ(entry.calls, static_cast<std::int64_t>(watch.steps.size()));
      EXPECT_GT(entry.bytes, 16.0 * 3200 * static_cast<double>(watch.steps.size()));  // temperatures, and the sweep
    } else if (entry.stage == "neighbours") {
      EXPECT_EQ(entry.calls, 1);
    }
}

TEST_F(ToyMethod, CheckPrintsItsPlan) {
  const Program program{load, make, []() -> const std::vector<OptionInfo>& { return schema().option_table(); }};
  std::string words[] = {"spume", "check", (sources / "case.toml").string()};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
  testing::internal::CaptureStdout();
  EXPECT_EQ(run_program(3, arguments, program), exit_done);
  const std::string printed = testing::internal::GetCapturedStdout();
  for (const char* text : {"conduction", "explicit step of the temperature", "diffusive", "temperature"})
    EXPECT_THAT(printed, HasSubstr(text));
}

TEST_F(ToyMethod, MistakesAreRefusedAtTheirPlace) {
  const auto problem = [&](const std::string& override) {
    try {
      start("run", {override});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(problem("heat.temperatur=\"1\""), HasSubstr("did you mean 'temperature'"));
  EXPECT_THAT(problem("heat.temperature=\"1 + warm\""), HasSubstr("warm"));
  EXPECT_THAT(problem("output.fields=[\"velocity\"]"), HasSubstr("it has temperature"));
  EXPECT_THAT(problem("pressure.solver=\"cg\""), HasSubstr("pressure"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
}

TEST(ToyMethodSources, HaveFewerThanTwoHundredLines) {
  std::ptrdiff_t lines = 0;
  for (const char* file : {"heat_conduction.hpp", "heat_conduction.cpp", "case.toml"}) {
    const std::string text = contents(sources / file);
    ASSERT_FALSE(text.empty()) << file;
    lines += std::count(text.begin(), text.end(), '\n');
  }
  EXPECT_LT(lines, 200);
}

}  // namespace
}  // namespace spume::test
