// SPDX-License-Identifier: MIT
#include "spume/io/grid_views.hpp"

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "spume/io/file.hpp"
#include "spume/io/hdf5.hpp"
#include "spume/io/vtkhdf_grid.hpp"
#include "spume/io/vtkhdf_steps.hpp"

namespace spume {
namespace {

using hdf5::File;
using hdf5::Id;

std::filesystem::path folder_of(std::filesystem::path grid_file) {
  return grid_file.replace_filename(grid_file.stem().string() + "_steps");
}

std::string view_name(std::size_t step) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.hdf", step);
  return name;
}

void copy_attribute(const File& from, const File& to, hid_t object, const char* name, hid_t stored, hid_t type,
                    hsize_t count) {
  const Id attribute =
      from.take(H5Aopen_by_name(from.id(), "/VTKHDF", name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "read");
  std::array<std::int64_t, 9> values{};  // or as many doubles, which are as large
  from.check(H5Aread(attribute, type, values.data()), "read");
  hdf5::write_attribute(to, object, name, stored, type, count, values.data());
}

// The slice of one step, seen as an array without the axis of time.
void view_field(const File& source, const File& view, const std::string& name, std::size_t step) {
  const std::string path = "/VTKHDF/PointData/" + name;
  const Id from = source.take(H5Dget_space(source.dataset(path)), H5Sclose, "read");
  std::vector<hsize_t> size(static_cast<std::size_t>(H5Sget_simple_extent_ndims(from)));
  source.check(H5Sget_simple_extent_dims(from, size.data(), nullptr), "read");
  std::vector<hsize_t> start(size.size(), 0), count(size);
  start[0] = step;
  count[0] = 1;
  source.check(H5Sselect_hyperslab(from, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), "read");
  const Id space =
      view.take(H5Screate_simple(static_cast<int>(size.size()) - 1, size.data() + 1, nullptr), H5Sclose, "write");
  const Id creation = hdf5::dataset_creation();
  const std::string file = "../" + source.path().filename().string();  // as seen from the folder of the view
  view.check(H5Pset_virtual(creation, space, file.c_str(), path.c_str(), from), "write");
  hdf5::make_groups(view, path);
  const Id data =
      view.take(H5Dcreate2(view.id(), path.c_str(), H5T_IEEE_F32LE, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                H5Dclose, "write");
}

void write_view(const File& source, const std::vector<std::string>& fields, const std::filesystem::path& path,
                std::size_t step) {
  File view = File::create(path, File::Format::compatible);
  hdf5::make_groups(view, "/VTKHDF/");
  {
    const Id root = view.take(H5Gopen2(view.id(), "/VTKHDF", H5P_DEFAULT), H5Gclose, "write");
    const std::int64_t version[2] = {1, 0};
    hdf5::write_attribute(view, root, "Version", H5T_STD_I64LE, H5T_NATIVE_INT64, 2, version);
    hdf5::write_fixed_string(view, root, "Type", "ImageData");
    copy_attribute(source, view, root, "WholeExtent", H5T_STD_I64LE, H5T_NATIVE_INT64, 6);
    copy_attribute(source, view, root, "Origin", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 3);
    copy_attribute(source, view, root, "Spacing", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 3);
    copy_attribute(source, view, root, "Direction", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 9);
  }
  for (const std::string& name : fields) view_field(source, view, name, step);
  view.close();
}

}  // namespace

std::filesystem::path grid_view_list(std::filesystem::path grid_file) {
  return grid_file.replace_extension(".hdf.series");
}

void write_grid_views(const std::filesystem::path& grid_file, std::size_t first) {
  const GridContents contents = read_grid_contents(grid_file);
  const std::filesystem::path folder = folder_of(grid_file);
  std::error_code failure;
  std::filesystem::create_directory(folder, failure);
  if (failure) throw_file_error(folder, "create", failure.value());
  {
    const File source = File::open(grid_file, false);
    for (std::size_t step = first; step < contents.times.size(); ++step)
      write_view(source, contents.fields, folder / view_name(step), step);
  }
  nlohmann::json files = nlohmann::json::array();
  for (std::size_t step = 0; step < contents.times.size(); ++step)
    files.push_back({{"name", (folder.filename() / view_name(step)).string()}, {"time", contents.times[step]}});
  const nlohmann::json list = {{"file-series-version", "1.0"}, {"files", files}};
  write_text_atomically(grid_view_list(grid_file), list.dump(1) + '\n');
  for (std::size_t step = contents.times.size(); std::filesystem::remove(folder / view_name(step), failure); ++step) {
  }
}

void remove_grid_views(const std::filesystem::path& grid_file) {
  std::error_code failure;
  std::filesystem::remove(grid_view_list(grid_file), failure);
  if (!failure) std::filesystem::remove_all(folder_of(grid_file), failure);
  if (failure) throw_file_error(grid_view_list(grid_file), "remove", failure.value());
}

}  // namespace spume
