// SPDX-License-Identifier: MIT
#include "spume/io/vtkhdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "spume/core/error.hpp"
#include "spume/io/hdf5.hpp"
#include "support/stored_values.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using hdf5::File;
using test::TemporaryFolder;
using testing::ElementsAre;

// Particles in two dimensions with a velocity of two components, a pressure and an identifier.
struct Sample {
  std::vector<double> x, y, u, v, p;
  std::vector<std::int64_t> id;
  Sample(std::size_t size, int step) {
    for (std::size_t i = 0; i < size; ++i) {
      x.push_back(0.5 * static_cast<double>(i) + step);
      y.push_back(0.25 * static_cast<double>(i) - step);
      u.push_back(std::sin(static_cast<double>(i)));
      v.push_back(step);
      p.push_back(100.0 * step + static_cast<double>(i));
      id.push_back((std::int64_t{1} << 40) + static_cast<std::int64_t>(i));
    }
  }
  ParticleSnapshot snapshot() const {
    return {"fluid",
            x.size(),
            {x.data(), y.data()},
            {{"velocity", {u.data(), v.data()}, {}}, {"pressure", {p.data()}, {}}, {"id", {}, {id.data()}}}};
  }
};

std::vector<std::int64_t> integers(const File& file, const std::string& name) {
  return test::stored_values<std::int64_t>(file, name);
}
std::vector<double> reals(const File& file, const std::string& name) {
  return test::stored_values<double>(file, name);
}

const std::vector<std::size_t> sizes = {5, 3, 7, 4};

void write_steps(VtkhdfFile& file, std::size_t first, std::size_t last) {
  for (std::size_t s = first; s < last; ++s) {
    const Sample sample(sizes[s], static_cast<int>(s));
    file.append(0.1 * static_cast<double>(s), sample.snapshot());
  }
}

TEST(Vtkhdf, LayoutIsThatOfTheFormat) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "fluid.vtkhdf", {});
  write_steps(writer, 0, 4);
  const File file = File::open(folder / "fluid.vtkhdf", false);
  EXPECT_THAT(integers(file, "/VTKHDF/NumberOfPoints"), ElementsAre(5, 3, 7, 4));
  EXPECT_THAT(integers(file, "/VTKHDF/Vertices/NumberOfCells"), ElementsAre(5, 3, 7, 4));
  EXPECT_THAT(integers(file, "/VTKHDF/Vertices/NumberOfConnectivityIds"), ElementsAre(5, 3, 7, 4));
  EXPECT_THAT(integers(file, "/VTKHDF/Vertices/Offsets"),
              ElementsAre(0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4));
  EXPECT_THAT(integers(file, "/VTKHDF/Vertices/Connectivity"),
              ElementsAre(0, 1, 2, 3, 4, 0, 1, 2, 0, 1, 2, 3, 4, 5, 6, 0, 1, 2, 3));
  for (const std::string topology : {"Lines", "Polygons", "Strips"}) {
    EXPECT_THAT(integers(file, "/VTKHDF/" + topology + "/NumberOfCells"), ElementsAre(0, 0, 0, 0));
    EXPECT_THAT(integers(file, "/VTKHDF/" + topology + "/NumberOfConnectivityIds"), ElementsAre(0, 0, 0, 0));
    EXPECT_THAT(integers(file, "/VTKHDF/" + topology + "/Offsets"), ElementsAre(0, 0, 0, 0));
    EXPECT_TRUE(integers(file, "/VTKHDF/" + topology + "/Connectivity").empty());
  }
  EXPECT_THAT(reals(file, "/VTKHDF/Steps/Values"), ElementsAre(0, 0.1, 0.2, 0.1 * 3));
  EXPECT_THAT(integers(file, "/VTKHDF/Steps/PartOffsets"), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(integers(file, "/VTKHDF/Steps/NumberOfParts"), ElementsAre(1, 1, 1, 1));
  EXPECT_THAT(integers(file, "/VTKHDF/Steps/PointOffsets"), ElementsAre(0, 5, 8, 15));
  const auto cells = ElementsAre(0, 0, 0, 0, 5, 0, 0, 0, 8, 0, 0, 0, 15, 0, 0, 0);
  EXPECT_THAT(integers(file, "/VTKHDF/Steps/CellOffsets"), cells);
  EXPECT_THAT(integers(file, "/VTKHDF/Steps/ConnectivityIdOffsets"), cells);
}

TEST(Vtkhdf, TypeIsAStringOfFixedLength) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "fluid.vtkhdf", {});
  write_steps(writer, 0, 1);
  const File file = File::open(folder / "fluid.vtkhdf", false);
  const auto attribute =
      file.take(H5Aopen_by_name(file.id(), "/VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "read");
  const auto type = file.take(H5Aget_type(attribute), H5Tclose, "read");
  EXPECT_EQ(H5Tis_variable_str(type), 0);
  EXPECT_EQ(H5Tget_cset(type), H5T_CSET_ASCII);
  ASSERT_EQ(H5Tget_size(type), 8u);
  std::string text(8, ' ');
  file.check(H5Aread(attribute, type, text.data()), "read");
  EXPECT_EQ(text, "PolyData");
}

TEST(Vtkhdf, PlaneParticlesGetAThirdComponentOfZero) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "fluid.vtkhdf", {});
  write_steps(writer, 0, 2);
  const File file = File::open(folder / "fluid.vtkhdf", false);
  const auto points = reals(file, "/VTKHDF/Points");
  const auto velocity = reals(file, "/VTKHDF/PointData/velocity");
  const Sample second(3, 1);
  ASSERT_EQ(points.size(), 24u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(points[3 * (5 + i)], second.x[i]);
    EXPECT_EQ(points[3 * (5 + i) + 1], second.y[i]);
    EXPECT_EQ(points[3 * (5 + i) + 2], 0);
    EXPECT_EQ(velocity[3 * (5 + i)], static_cast<float>(second.u[i]));
    EXPECT_EQ(velocity[3 * (5 + i) + 2], 0);
  }
  EXPECT_EQ(integers(file, "/VTKHDF/PointData/id")[7], (std::int64_t{1} << 40) + 2);
}

TEST(Vtkhdf, H5partViewShowsTheSameNumbers) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "fluid.vtkhdf", {});
  write_steps(writer, 0, 4);
  ASSERT_TRUE(std::filesystem::is_symlink(folder / "fluid.h5part"));
  EXPECT_EQ(std::filesystem::read_symlink(folder / "fluid.h5part"), "fluid.vtkhdf");
  const File file = File::open(folder / "fluid.h5part", false);
  for (std::size_t s = 0; s < sizes.size(); ++s) {
    const Sample sample(sizes[s], static_cast<int>(s));
    const std::string step = "/Step#" + std::to_string(s) + '/';
    EXPECT_EQ(reals(file, step + "x"), sample.x);
    EXPECT_EQ(reals(file, step + "y"), sample.y);
    EXPECT_EQ(reals(file, step + "z"), std::vector<double>(sizes[s], 0));
    EXPECT_EQ(reals(file, step + "velocity_1"), sample.v);
    EXPECT_EQ(reals(file, step + "pressure"), sample.p);
    EXPECT_EQ(integers(file, step + "id"), sample.id);
  }
}

TEST(Vtkhdf, WithoutTheViewThereIsNoSecondName) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "fluid.vtkhdf", {false, {}});
  write_steps(writer, 0, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "fluid.h5part"));
  EXPECT_FALSE(File::open(folder / "fluid.vtkhdf", false).exists("/Step#0"));
}

TEST(Vtkhdf, EmptySnapshotsAreLeftOut) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "bubbles.vtkhdf", {});
  writer.append(0, Sample(0, 0).snapshot());
  EXPECT_FALSE(std::filesystem::exists(folder / "bubbles.vtkhdf"));
  writer.append(1, Sample(3, 1).snapshot());
  writer.append(2, Sample(0, 2).snapshot());
  writer.append(3, Sample(2, 3).snapshot());
  EXPECT_THAT(read_vtkhdf_contents(folder / "bubbles.vtkhdf").times, ElementsAre(1, 3));
}

TEST(Vtkhdf, CutAndContinuedFileEqualsOneWrittenInOneGo) {
  const TemporaryFolder folder;
  VtkhdfFile whole(folder / "whole.vtkhdf", {});
  write_steps(whole, 0, 4);
  {
    VtkhdfFile first(folder / "parts.vtkhdf", {});
    write_steps(first, 0, 3);
    first.append(7, Sample(9, 9).snapshot());
  }
  VtkhdfFile second(folder / "parts.vtkhdf", {});
  EXPECT_EQ(second.steps(), 4);
  second.keep_steps(2);
  for (const char* group : {"/Step#2", "/Step#3"}) {
    EXPECT_TRUE(File::open(folder / "whole.vtkhdf", false).exists(group)) << group;
    EXPECT_FALSE(File::open(folder / "parts.vtkhdf", false).exists(group)) << group;
  }
  write_steps(second, 2, 4);
  const File a = File::open(folder / "whole.vtkhdf", false), b = File::open(folder / "parts.vtkhdf", false);
  for (const char* name :
       {"NumberOfPoints", "Vertices/Offsets", "Vertices/Connectivity", "Vertices/NumberOfCells", "Lines/Offsets",
        "Steps/PointOffsets", "Steps/CellOffsets", "Steps/ConnectivityIdOffsets", "Steps/PartOffsets", "PointData/id"})
    EXPECT_EQ(integers(a, std::string("/VTKHDF/") + name), integers(b, std::string("/VTKHDF/") + name)) << name;
  for (const char* name : {"Points", "PointData/velocity", "PointData/pressure", "Steps/Values"})
    EXPECT_EQ(reals(a, std::string("/VTKHDF/") + name), reals(b, std::string("/VTKHDF/") + name)) << name;
  EXPECT_EQ(reals(a, "/Step#3/x"), reals(b, "/Step#3/x"));
  EXPECT_THAT(read_vtkhdf_contents(folder / "parts.vtkhdf").sizes, ElementsAre(5, 3, 7, 4));
}

TEST(Vtkhdf, BlocksAcrossManyChunksKeepTheirOrder) {
  const TemporaryFolder folder;
  constexpr std::size_t size = 150'000;  // more than two of the largest blocks, and not a multiple of a chunk
  VtkhdfFile writer(folder / "fluid.vtkhdf", {});
  for (int step = 0; step < 2; ++step) writer.append(step, Sample(size, step).snapshot());
  const File file = File::open(folder / "fluid.vtkhdf", false);
  const Sample second(size, 1);
  EXPECT_EQ(reals(file, "/Step#1/x"), second.x);
  EXPECT_EQ(integers(file, "/Step#1/id"), second.id);
}

TEST(Vtkhdf, KeepingNothingRemovesTheFile) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "fluid.vtkhdf", {});
  write_steps(writer, 0, 2);
  EXPECT_THROW(writer.keep_steps(3), FileError);
  writer.keep_steps(0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Vtkhdf, ForeignAndShortenedFilesAreRefused) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "fluid.vtkhdf", {});
  write_steps(writer, 0, 2);
  const std::string good = test::contents(folder / "fluid.vtkhdf");
  test::write_contents(folder / "short.vtkhdf", good.substr(0, good.size() / 2));
  test::write_contents(folder / "text.vtkhdf", "hello");
  EXPECT_THROW(read_vtkhdf_contents(folder / "short.vtkhdf"), FileError);
  EXPECT_THROW(read_vtkhdf_contents(folder / "text.vtkhdf"), FileError);
  EXPECT_THROW(read_vtkhdf_contents(folder / "none.vtkhdf"), FileError);
  EXPECT_THROW(VtkhdfFile(folder / "text.vtkhdf", {}), FileError);
}

TEST(Vtkhdf, AFieldThatChangesItsShapeIsRefused) {
  const TemporaryFolder folder;
  VtkhdfFile writer(folder / "fluid.vtkhdf", {});
  write_steps(writer, 0, 1);
  Sample sample(3, 1);
  auto snapshot = sample.snapshot();
  snapshot.fields[1].name = "temperature";
  EXPECT_THROW(writer.append(1, snapshot), FileError);
}

}  // namespace
}  // namespace spume
