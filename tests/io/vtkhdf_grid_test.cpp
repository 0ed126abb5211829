// SPDX-License-Identifier: MIT
#include "spume/io/vtkhdf_grid.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "spume/core/error.hpp"
#include "spume/io/hdf5.hpp"
#include "support/stored_values.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

struct Fields {
  std::vector<float> a, b, c;
  GridSnapshot snapshot{"fields", {3, 4, 5}, {0.5, 0, -1}, {0.1, 0.2, 0.3}, {}};
  explicit Fields(float shift) {
    for (int i = 0; i < 60; ++i) {
      a.push_back(static_cast<float>(i) + shift);
      b.push_back(-static_cast<float>(i));
      c.push_back(2 * static_cast<float>(i));
    }
    snapshot.fields = {{"velocity", {a.data(), b.data(), c.data()}}, {"pressure", {a.data()}}};
  }
};

TEST(VtkhdfGrid, StepsAreStoredWithXFastest) {
  const test::TemporaryFolder folder;
  const auto path = folder / "fluid.vtkhdf";
  VtkhdfGridFile file(path, {false, {{"case", "text"}}});
  file.append(0, Fields(0).snapshot);
  file.append(0.5, Fields(100).snapshot);
  const std::vector<float> pressure = test::stored_values(path, "/VTKHDF/PointData/pressure");
  const std::vector<float> velocity = test::stored_values(path, "/VTKHDF/PointData/velocity");
  ASSERT_EQ(pressure.size(), 120u);
  ASSERT_EQ(velocity.size(), 360u);
  // Point (2, 1, 4) of the second step.
  const std::size_t stored = 60 + (4 * 4 + 1) * 3 + 2, given = (2 * 4 + 1) * 5 + 4;
  EXPECT_EQ(pressure[stored], 100 + static_cast<float>(given));
  EXPECT_EQ(velocity[3 * stored + 1], -static_cast<float>(given));
  EXPECT_EQ(velocity[3 * stored + 2], 2 * static_cast<float>(given));
  for (const char* field : {"velocity", "pressure"})
    EXPECT_EQ(test::stored_values(path, std::string("/VTKHDF/Steps/PointDataOffsets/") + field),
              (std::vector<float>{0, 1}))
        << field;
  const auto attribute = [&](const char* name, std::size_t count) {
    const auto stored = hdf5::File::open(path, false);
    const auto id =
        stored.take(H5Aopen_by_name(stored.id(), "/VTKHDF", name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "read");
    std::vector<double> values(count);
    stored.check(H5Aread(id, H5T_NATIVE_DOUBLE, values.data()), "read");
    return values;
  };
  EXPECT_EQ(attribute("Origin", 3), (std::vector<double>{0.5, 0, -1}));
  EXPECT_EQ(attribute("Spacing", 3), (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(attribute("WholeExtent", 6), (std::vector<double>{0, 2, 0, 3, 0, 4}));
  EXPECT_EQ(attribute("Direction", 9), (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(hdf5::read_text(hdf5::File::open(path, false), "/Spume/case"), "text");
  const GridContents contents = read_grid_contents(path);
  EXPECT_EQ(contents.times, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(contents.points, (std::array<std::int64_t, 3>{3, 4, 5}));
  EXPECT_EQ(contents.fields, (std::vector<std::string>{"pressure", "velocity"}));
  EXPECT_TRUE(is_grid_file(path));
}

TEST(VtkhdfGrid, ContinuesAfterTheStepsThatAreKept) {
  const test::TemporaryFolder folder;
  const auto path = folder / "fluid.vtkhdf";
  {
    VtkhdfGridFile file(path, {});
    for (int step = 0; step < 3; ++step) file.append(step, Fields(static_cast<float>(step)).snapshot);
  }
  VtkhdfGridFile file(path, {});
  EXPECT_EQ(file.steps(), 3);
  file.keep_steps(1);
  file.append(7, Fields(50).snapshot);
  EXPECT_EQ(read_grid_contents(path).times, (std::vector<double>{0, 7}));
  EXPECT_EQ(test::stored_values(path, "/VTKHDF/PointData/pressure")[60], 50);
  EXPECT_THROW(file.keep_steps(5), FileError);
  file.keep_steps(0);
  EXPECT_FALSE(std::filesystem::exists(path));
}

// Readers without time open one file per step; its arrays are those of the step, also after the folder has moved.
TEST(VtkhdfGrid, OlderReadersSeeEveryStep) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a");
  {
    VtkhdfGridFile file(folder / "a" / "fluid.vtkhdf", {});
    for (int step = 0; step < 3; ++step) file.append(0.5 * step, Fields(100 * static_cast<float>(step)).snapshot);
  }
  std::filesystem::rename(folder / "a", folder / "b");
  const auto path = folder / "b" / "fluid.vtkhdf", steps = folder / "b" / "fluid_steps";
  const auto listed = [&] {
    std::vector<double> times;
    const auto list = nlohmann::json::parse(std::ifstream(folder / "b" / "fluid.hdf.series"));
    for (const auto& one : list["files"]) {
      EXPECT_TRUE(std::filesystem::exists(folder / "b" / std::string(one["name"])));
      times.push_back(one["time"]);
    }
    return times;
  };
  EXPECT_EQ(listed(), (std::vector<double>{0, 0.5, 1}));
  const std::vector<float> all = test::stored_values(path, "/VTKHDF/PointData/velocity");
  EXPECT_EQ(test::stored_values(steps / "000002.hdf", "/VTKHDF/PointData/velocity"),
            (std::vector<float>(all.begin() + 360, all.end())));
  EXPECT_EQ(test::stored_values(steps / "000001.hdf", "/VTKHDF/PointData/pressure")[0], 100);

  VtkhdfGridFile file(path, {});
  file.keep_steps(1);
  EXPECT_EQ(listed(), (std::vector<double>{0}));
  EXPECT_FALSE(std::filesystem::exists(steps / "000001.hdf"));
  file.append(7, Fields(50).snapshot);
  EXPECT_EQ(listed(), (std::vector<double>{0, 7}));
  EXPECT_EQ(test::stored_values(steps / "000001.hdf", "/VTKHDF/PointData/pressure")[0], 50);
  file.keep_steps(0);
  EXPECT_FALSE(std::filesystem::exists(steps));
  EXPECT_FALSE(std::filesystem::exists(folder / "b" / "fluid.hdf.series"));
}

TEST(VtkhdfGrid, ViewsAreAnOption) {
  const test::TemporaryFolder folder;
  VtkhdfGridFile file(folder / "fluid.vtkhdf", {false, {}});
  file.append(0, Fields(0).snapshot);
  EXPECT_FALSE(std::filesystem::exists(folder / "fluid.hdf.series"));
}

TEST(VtkhdfGrid, AnotherGridIsRefused) {
  const test::TemporaryFolder folder;
  VtkhdfGridFile file(folder / "fluid.vtkhdf", {});
  file.append(0, Fields(0).snapshot);
  Fields other(0);
  other.snapshot.points = {3, 5, 4};
  EXPECT_THROW(file.append(1, other.snapshot), FileError);
}

}  // namespace
}  // namespace spume
