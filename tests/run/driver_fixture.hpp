// SPDX-License-Identifier: MIT
// Runs of the fake method in a temporary folder.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "spume/core/error.hpp"
#include "spume/io/vtkhdf.hpp"
#include "support/fake_method.hpp"
#include "support/stored_values.hpp"
#include "support/temporary_folder.hpp"
#include "support/watch.hpp"

namespace spume {

using test::contents;
using test::load_fake_case;
using test::make_fake_method;
using test::TemporaryFolder;
using test::Watch;

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
    return test::stored_values(folder_ / name / "fluid.vtkhdf", array);
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

// A case with everything that is recorded.
inline constexpr const char* full_case =
    "end = 1.0\nevery = 0.13\nseries_every = 0.02\nspectrum_every = 0.3\nprobes = true\ndimensions = 3\n";

}  // namespace spume
