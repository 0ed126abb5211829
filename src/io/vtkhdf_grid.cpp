// SPDX-License-Identifier: MIT
#include "spume/io/vtkhdf_grid.hpp"

#include <algorithm>
#include <optional>

#include "spume/core/error.hpp"
#include "spume/io/file.hpp"
#include "spume/io/grid_views.hpp"
#include "spume/io/hdf5.hpp"
#include "spume/io/journal.hpp"
#include "spume/io/vtkhdf_steps.hpp"

namespace spume {
namespace {

using hdf5::File;
using hdf5::Id;

constexpr hsize_t chunk_bytes = 1 << 20;

std::int64_t grid_step_count(const File& file) {
  return vtkhdf::read_step_count(file, false, "grid");
}

hsize_t slab(const GridSnapshot& snapshot, std::size_t components) {
  const hsize_t layer = snapshot.points[0] * snapshot.points[1] * components * sizeof(float);
  return std::clamp<hsize_t>(chunk_bytes / layer, 1, snapshot.points[2]);
}

void create_layout(const File& file, const GridSnapshot& snapshot, const vtkhdf::Notes& notes) {
  for (const auto& field : snapshot.fields) {
    const hsize_t components = field.components.size();
    std::vector<hsize_t> rest{snapshot.points[2], snapshot.points[1], snapshot.points[0]};
    std::vector<hsize_t> chunk{1, slab(snapshot, components), snapshot.points[1], snapshot.points[0]};
    if (components > 1) rest.push_back(components), chunk.push_back(components);
    vtkhdf::create_array(file, "/VTKHDF/PointData/" + field.name, H5T_IEEE_F32LE, rest, chunk);
    vtkhdf::create_array(file, "/VTKHDF/Steps/PointDataOffsets/" + field.name, H5T_STD_I64LE, {}, {256});
  }
  vtkhdf::create_array(file, "/VTKHDF/Steps/Values", H5T_IEEE_F64LE, {}, {256});
  vtkhdf::write_header(file, "ImageData", notes);
  const Id root = file.take(H5Gopen2(file.id(), "/VTKHDF", H5P_DEFAULT), H5Gclose, "write");
  std::int64_t extent[6];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    extent[2 * axis] = 0;
    extent[2 * axis + 1] = static_cast<std::int64_t>(snapshot.points[axis]) - 1;
  }
  hdf5::write_attribute(file, root, "WholeExtent", H5T_STD_I64LE, H5T_NATIVE_INT64, 6, extent);
  hdf5::write_attribute(file, root, "Origin", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 3, snapshot.origin.data());
  hdf5::write_attribute(file, root, "Spacing", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 3, snapshot.spacing.data());
  const double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  hdf5::write_attribute(file, root, "Direction", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 9, direction);
}

void set_steps(const File& file, const std::string& name, std::int64_t steps) {
  const Id data = file.dataset(name);
  std::vector<hsize_t> size = extent_of(file, data);
  size[0] = static_cast<hsize_t>(steps);
  file.check(H5Dset_extent(data, size.data()), "write");
}

void write_part(const File& file, hid_t data, const std::vector<hsize_t>& start, const std::vector<hsize_t>& count,
                hid_t type, const void* values) {
  const Id space = file.take(H5Dget_space(data), H5Sclose, "write");
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  const Id memory =
      file.take(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose, "write");
  file.check(H5Dwrite(data, type, memory, space, H5P_DEFAULT, values), "write");
}

void write_field(const File& file, const GridSnapshot& snapshot, const GridSnapshot::Field& field, hsize_t step) {
  const auto [nx, ny, nz] = snapshot.points;
  const std::size_t components = field.components.size();
  const std::string name = "/VTKHDF/PointData/" + field.name;
  const Id data = file.dataset(name);
  std::vector<hsize_t> size = extent_of(file, data);
  std::vector<hsize_t> expected{step, nz, ny, nx};
  if (components > 1) expected.push_back(components);
  if (size != expected)
    throw FileError("cannot write '" + file.path().string() + "': the field " + field.name +
                    " is not the one of the earlier snapshots");
  size[0] = step + 1;
  file.check(H5Dset_extent(data, size.data()), "write");
  const std::size_t layers = slab(snapshot, components);
  std::vector<float> buffer(layers * ny * nx * components);
  for (std::size_t first = 0; first < nz; first += layers) {
    const std::size_t here = std::min(layers, nz - first);
    for (std::size_t ix = 0; ix < nx; ++ix)
      for (std::size_t iy = 0; iy < ny; ++iy)
        for (std::size_t l = 0; l < here; ++l)
          for (std::size_t c = 0; c < components; ++c)
            buffer[((l * ny + iy) * nx + ix) * components + c] = field.components[c][(ix * ny + iy) * nz + first + l];
    std::vector<hsize_t> start(size.size(), 0), count(size);
    start[0] = step, count[0] = 1;
    start[1] = first, count[1] = here;
    write_part(file, data, start, count, H5T_NATIVE_FLOAT, buffer.data());
  }
}

void write_value(const File& file, const std::string& name, hsize_t step, hid_t type, const void* value) {
  set_steps(file, name, static_cast<std::int64_t>(step) + 1);
  write_part(file, file.dataset(name), {step}, {1}, type, value);
}

}  // namespace

GridContents read_grid_contents(const std::filesystem::path& path) {
  const File file = File::open(path, false);
  const std::int64_t steps = grid_step_count(file);
  GridContents contents;
  contents.fields = vtkhdf::member_names(file, "/VTKHDF/PointData");
  contents.times.resize(static_cast<std::size_t>(steps));
  const Id data = file.dataset("/VTKHDF/Steps/Values");
  std::vector<double> all(extent_of(file, data)[0]);
  if (static_cast<std::int64_t>(all.size()) < steps)
    throw FileError("cannot read '" + path.string() + "': fewer times than steps");
  if (!all.empty()) file.check(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), "read");
  std::copy_n(all.begin(), contents.times.size(), contents.times.begin());
  if (!contents.fields.empty()) {
    const auto size = extent_of(file, file.dataset("/VTKHDF/PointData/" + contents.fields[0]));
    for (std::size_t axis = 0; axis < 3 && size.size() > 3; ++axis)
      contents.points[axis] = static_cast<std::int64_t>(size[3 - axis]);
  }
  return contents;
}

bool is_grid_file(const std::filesystem::path& path) {
  try {
    grid_step_count(File::open(path, false));
    return true;
  } catch (const FileError&) {
    return false;
  }
}

VtkhdfGridFile::VtkhdfGridFile(std::filesystem::path path, Options options)
    : path_(std::move(path)), options_(std::move(options)) {
  if (!std::filesystem::exists(path_)) return;
  hdf5::replay_journal(path_);
  steps_ = grid_step_count(File::open(path_, false));
}

void VtkhdfGridFile::append(double time, const GridSnapshot& snapshot) {
  try {
    write(time, snapshot);
  } catch (const FileError&) {
    if (steps_ == 0) hdf5::remove_with_journal(path_);
    throw;
  }
}

void VtkhdfGridFile::write(double time, const GridSnapshot& snapshot) {
  if (!std::filesystem::exists(path_)) {
    File file = File::create(path_, File::Format::compatible);
    create_layout(file, snapshot, options_.notes);
    file.close();
  }
  std::int64_t bytes = 1 << 16;
  for (const auto& field : snapshot.fields)
    bytes += static_cast<std::int64_t>(field.components.size() * sizeof(float) * snapshot.points[0] *
                                       snapshot.points[1] * snapshot.points[2]);
  const ReservedSpace space(path_, bytes);
  File file = File::open(path_, true);
  const auto step = static_cast<hsize_t>(steps_);
  for (const auto& field : snapshot.fields) {
    write_field(file, snapshot, field, step);
    write_value(file, "/VTKHDF/Steps/PointDataOffsets/" + field.name, step, H5T_NATIVE_INT64, &steps_);
  }
  write_value(file, "/VTKHDF/Steps/Values", step, H5T_NATIVE_DOUBLE, &time);
  // Readers trust the number of steps: it is raised when everything else is in the file.
  file.flush();
  vtkhdf::write_step_count(file, steps_ + 1);
  file.close();
  ++steps_;
  if (options_.views) write_grid_views(path_, step);
}

void VtkhdfGridFile::keep_steps(std::int64_t count) {
  vtkhdf::require_steps(path_, steps_, count);
  if (count == 0) {
    std::error_code failure;
    std::filesystem::remove(path_, failure);
    if (failure) throw_file_error(path_, "remove", failure.value());
    remove_grid_views(path_);
  } else if (count < steps_) {
    File file = File::open(path_, true);
    vtkhdf::write_step_count(file, count);
    file.flush();
    for (const std::string& name : vtkhdf::member_names(file, "/VTKHDF/PointData")) {
      set_steps(file, "/VTKHDF/PointData/" + name, count);
      set_steps(file, "/VTKHDF/Steps/PointDataOffsets/" + name, count);
    }
    set_steps(file, "/VTKHDF/Steps/Values", count);
    file.close();
  }
  if (count > 0 && options_.views) write_grid_views(path_);
  steps_ = count;
}

}  // namespace spume
