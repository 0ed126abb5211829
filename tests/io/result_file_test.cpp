// SPDX-License-Identifier: MIT
// Results are read as they were written, by this program or by another.
#include "spume/io/result_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "spume/core/error.hpp"
#include "spume/io/hdf5.hpp"
#include "spume/io/vtkhdf.hpp"
#include "spume/io/vtkhdf_grid.hpp"
#include "spume/io/vtkhdf_steps.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using hdf5::File;
using hdf5::Id;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

const ParticleField& field_of(const ParticleSnapshot& family, const std::string& name) {
  for (const ParticleField& field : family.fields)
    if (field.name == name) return field;
  throw std::out_of_range(name);
}

template <class Stored>
void add_list(const File& file, const std::string& name, const std::vector<Stored>& values, hid_t type,
              std::vector<hsize_t> shape = {}) {
  if (shape.empty()) shape = {values.size()};
  hdf5::make_groups(file, name);
  const Id space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Id data(H5Dcreate2(file.id(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  ASSERT_GE(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
}

// Three steps of growing size, with a pressure, a velocity of two components and identifiers.
void write_particles(const std::filesystem::path& path) {
  VtkhdfFile file(path, {});
  for (std::size_t step = 0; step < 3; ++step) {
    const std::size_t size = 4 + step;
    std::vector<double> x(size), y(size), p(size);
    std::vector<std::int64_t> id(size);
    for (std::size_t i = 0; i < size; ++i) {
      x[i] = 0.5 * static_cast<double>(i), y[i] = static_cast<double>(step), p[i] = static_cast<double>(10 * step + i);
      id[i] = (std::int64_t{1} << 40) + static_cast<std::int64_t>(i);
    }
    file.append(0.25 * static_cast<double>(step),
                {"fluid",
                 size,
                 {x.data(), y.data()},
                 {{"pressure", {p.data()}, {}}, {"velocity", {x.data(), y.data()}, {}}, {"id", {}, {id.data()}}}});
  }
}

void expect_particles(const std::filesystem::path& path) {
  const ResultFile file(path);
  EXPECT_THAT(file.times(), ElementsAre(0, 0.25, 0.5));
  for (std::size_t step = 0; step < 3; ++step) {
    ResultStep read;
    file.read(step, read);
    ASSERT_EQ(read.families.size(), 1U);
    const ParticleSnapshot& family = read.families[0];
    ASSERT_EQ(family.size, 4 + step);
    ASSERT_EQ(family.position.size(), 3U);
    for (std::size_t i = 0; i < family.size; ++i) {
      EXPECT_EQ(family.position[0][i], 0.5 * static_cast<double>(i));
      EXPECT_EQ(family.position[1][i], static_cast<double>(step));
      EXPECT_EQ(family.position[2][i], 0);
      EXPECT_EQ(field_of(family, "pressure").f64[0][i], static_cast<double>(10 * step + i));
      EXPECT_EQ(field_of(family, "velocity").f64[1][i], static_cast<double>(step));
      EXPECT_EQ(field_of(family, "id").i64[0][i], (std::int64_t{1} << 40) + static_cast<std::int64_t>(i));
    }
  }
}

TEST(ResultFile, ReadsParticlesOfTheProgram) {
  const TemporaryFolder folder;
  write_particles(folder / "fluid.vtkhdf");
  EXPECT_EQ(ResultFile(folder / "fluid.vtkhdf").family(), "fluid");
  expect_particles(folder / "fluid.vtkhdf");
}

TEST(ResultFile, ReadsAnH5PartFileOfAnotherProgram) {
  const TemporaryFolder folder;
  {
    const File file = File::create(folder / "beam.h5part", File::Format::compatible);
    for (const int step : {10, 2}) {  // by their times, not by their names
      const std::string group = "/Step#" + std::to_string(step) + '/';
      const std::vector<float> x{1, 2, 3};
      for (const char* name : {"x", "y", "velocity_0", "velocity_1", "velocity_2", "mass"})
        add_list(file, group + name, x, H5T_NATIVE_FLOAT);
      add_list(file, group + "id", std::vector<int>{7, 8, 9}, H5T_NATIVE_INT);
      add_list(file, group + "other_length", std::vector<double>{1}, H5T_NATIVE_DOUBLE);
      const Id at(H5Gopen2(file.id(), group.c_str(), H5P_DEFAULT), H5Gclose);
      const double time = step == 10 ? 0.5 : 0.75;
      hdf5::write_attribute(file, at, "TimeValue", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 1, &time);
    }
  }
  const ResultFile file(folder / "beam.h5part");
  EXPECT_THAT(file.times(), ElementsAre(0.5, 0.75));
  ResultStep read;
  file.read(0, read);
  const ParticleSnapshot& family = read.families.at(0);
  EXPECT_EQ(family.name, "beam");
  EXPECT_EQ(family.position[1][2], 3);
  EXPECT_EQ(family.position[2][2], 0);
  EXPECT_EQ(field_of(family, "velocity").f64.size(), 3U);
  EXPECT_EQ(field_of(family, "mass").f64[0][1], 2);
  EXPECT_EQ(field_of(family, "id").i64[0][2], 9);
  EXPECT_THROW(field_of(family, "other_length"), std::out_of_range);
}

TEST(ResultFile, ReadsGridsInTheOrderOfTheirPoints) {
  const TemporaryFolder folder;
  std::vector<float> values(3 * 4 * 5), twice(values.size());
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = static_cast<float>(k), twice[k] = static_cast<float>(2 * k);
  {
    VtkhdfGridFile file(folder / "fluid.vtkhdf", {.notes = {{"case", "title"}}});
    const GridSnapshot grid{
        "fluid",
        {3, 4, 5},
        {1, 2, 3},
        {0.1, 0.2, 0.3},
        {{"pressure", {values.data()}}, {"velocity", {values.data(), twice.data(), values.data()}}}};
    file.append(0, grid);
    file.append(2, grid);
  }
  const ResultFile file(folder / "fluid.vtkhdf");
  EXPECT_THAT(file.times(), ElementsAre(0, 2));
  ResultStep read;
  file.read(1, read);
  const GridSnapshot& grid = read.grids.at(0);
  EXPECT_THAT(grid.points, ElementsAre(3, 4, 5));
  EXPECT_THAT(grid.origin, ElementsAre(1, 2, 3));
  EXPECT_TRUE(grid.periodic);
  for (std::size_t k = 0; k < values.size(); ++k) {
    EXPECT_EQ(grid.fields.at(0).components.at(0)[k], values[k]);
    EXPECT_EQ(grid.fields.at(1).components.at(1)[k], twice[k]);
  }
}

// An UnstructuredGrid in two parts without steps, as writers of one state leave it.
TEST(ResultFile, ReadsOneStateInParts) {
  const TemporaryFolder folder;
  {
    const File file = File::create(folder / "cloud.vtkhdf", File::Format::compatible);
    add_list(file, "/VTKHDF/NumberOfPoints", std::vector<std::int64_t>{2, 1}, H5T_NATIVE_INT64);
    add_list(file, "/VTKHDF/Points", std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9}, H5T_NATIVE_FLOAT, {3, 3});
    add_list(file, "/VTKHDF/PointData/heat", std::vector<float>{10, 20, 30}, H5T_NATIVE_FLOAT);
    const Id root(H5Gopen2(file.id(), "/VTKHDF", H5P_DEFAULT), H5Gclose);
    hdf5::write_fixed_string(file, root, "Type", "UnstructuredGrid");
  }
  const ResultFile file(folder / "cloud.vtkhdf");
  EXPECT_THAT(file.times(), ElementsAre(0));
  ResultStep read;
  file.read(0, read);
  EXPECT_EQ(read.families.at(0).size, 3U);
  EXPECT_EQ(read.families[0].position[2][2], 9);
  EXPECT_EQ(field_of(read.families[0], "heat").f64[0][2], 30);
}

std::string failure(const std::filesystem::path& path) {
  try {
    const ResultFile file(path);
    ResultStep read;
    for (std::size_t step = 0; step < file.times().size(); ++step) file.read(step, read);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

TEST(ResultFile, WhatDoesNotFitTogetherIsRefused) {
  const TemporaryFolder folder;
  test::write_contents(folder / "text.vtkhdf", "no HDF5");
  EXPECT_THAT(failure(folder / "text.vtkhdf"), HasSubstr("cannot"));
  EXPECT_THAT(failure(folder / "none.vtkhdf"), HasSubstr("cannot"));
  File::create(folder / "empty.h5part", File::Format::compatible);
  EXPECT_THAT(failure(folder / "empty.h5part"), HasSubstr("neither VTKHDF nor H5Part"));

  const auto damaged = [&](const char* name, auto&& change) {
    const std::filesystem::path path = folder / name;
    write_particles(path);
    {
      const File file = File::open(path, true);
      change(file);
    }
    return failure(path);
  };
  EXPECT_THAT(damaged("long.vtkhdf", [](const File& file) { vtkhdf::write_step_count(file, 1000); }),
              HasSubstr("shorter than the steps tell"));
  EXPECT_THAT(damaged("negative.vtkhdf", [](const File& file) { vtkhdf::write_step_count(file, -1); }),
              HasSubstr("-1 steps"));
  const auto set = [](const File& file, const char* name, std::vector<std::int64_t> values) {
    const Id data = file.dataset(name);
    ASSERT_GE(H5Dwrite(data, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  };
  EXPECT_THAT(damaged("sizes.vtkhdf",
                      [&](const File& file) {
                        set(file, "/VTKHDF/NumberOfPoints", {4, 5, std::int64_t{1} << 60});
                      }),
              HasSubstr("impossible number of points"));
  EXPECT_THAT(damaged("offsets.vtkhdf",
                      [&](const File& file) {
                        set(file, "/VTKHDF/Steps/PointOffsets", {0, -7, 9});
                      }),
              HasSubstr("entry -7"));
  EXPECT_THAT(damaged("far.vtkhdf",
                      [&](const File& file) {
                        set(file, "/VTKHDF/Steps/PointOffsets", {0, 4, 900});
                      }),
              HasSubstr("shorter than the steps tell"));
  EXPECT_THAT(damaged("type.vtkhdf",
                      [&](const File& file) {
                        const Id root(H5Gopen2(file.id(), "/VTKHDF", H5P_DEFAULT), H5Gclose);
                        H5Adelete(root, "Type");
                        hdf5::write_fixed_string(file, root, "Type", "OverlappingAMR");
                      }),
              HasSubstr("'OverlappingAMR'"));
}

}  // namespace
}  // namespace spume
