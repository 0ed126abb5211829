// SPDX-License-Identifier: MIT
#include "spume/io/vtkhdf.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <numeric>
#include <optional>
#include <system_error>

#include "spume/core/error.hpp"
#include "spume/io/file.hpp"
#include "spume/io/hdf5.hpp"
#include "spume/io/journal.hpp"
#include "spume/io/vtkhdf_steps.hpp"

namespace spume {
namespace {

using hdf5::File;
using hdf5::Id;
using hdf5::write_attribute;

constexpr std::array<const char*, 4> topologies = {"Vertices", "Lines", "Polygons", "Strips"};
constexpr hsize_t metadata_chunk = 256;
constexpr hsize_t largest_chunk = 65536;

// A file that is closed between snapshots forgets its free space, so a last chunk that is rewritten larger leaks
// its old copy. An eighth of a snapshot per chunk keeps that loss near 6 %; above half a million particles the
// chunk of about 1 MB is smaller than that anyway.
hsize_t chunk_rows(std::size_t particles) {
  return std::clamp(std::bit_floor(static_cast<hsize_t>(particles) / 8), hsize_t{1024}, largest_chunk);
}

int stored_components(const ParticleField& field) {
  const int components = static_cast<int>(std::max(field.f64.size(), field.i64.size()));
  return components == 2 ? 3 : components;
}

// columns 0: a one-dimensional dataset.
void create_dataset(const File& file, const std::string& name, hid_t type, hsize_t columns, hsize_t chunk,
                    bool compress) {
  if (columns == 0)
    vtkhdf::create_array(file, name, type, {}, {chunk}, compress);
  else
    vtkhdf::create_array(file, name, type, {columns}, {chunk, columns}, compress);
}

void create_layout(const File& file, const ParticleSnapshot& snapshot, const vtkhdf::Notes& notes) {
  const hsize_t chunk = chunk_rows(snapshot.size);
  const auto metadata = [&](const std::string& name, hid_t type, hsize_t columns) {
    create_dataset(file, "/VTKHDF/" + name, type, columns, metadata_chunk, false);
  };
  const auto particles = [&](const std::string& name, hid_t type, hsize_t columns) {
    create_dataset(file, "/VTKHDF/" + name, type, columns, chunk, true);
  };
  metadata("NumberOfPoints", H5T_STD_I64LE, 0);
  particles("Points", H5T_IEEE_F32LE, 3);
  for (const std::string topology : topologies) {
    metadata(topology + "/NumberOfCells", H5T_STD_I64LE, 0);
    metadata(topology + "/NumberOfConnectivityIds", H5T_STD_I64LE, 0);
    if (topology == topologies[0]) {
      particles(topology + "/Offsets", H5T_STD_I64LE, 0);
      particles(topology + "/Connectivity", H5T_STD_I64LE, 0);
    } else {
      metadata(topology + "/Offsets", H5T_STD_I64LE, 0);
      metadata(topology + "/Connectivity", H5T_STD_I64LE, 0);
    }
  }
  for (const auto& field : snapshot.fields) {
    const int components = stored_components(field);
    particles("PointData/" + field.name, field.i64.empty() ? H5T_IEEE_F32LE : H5T_STD_I64LE,
              components == 1 ? 0 : static_cast<hsize_t>(components));
  }
  metadata("Steps/Values", H5T_IEEE_F64LE, 0);
  for (const char* name : {"PartOffsets", "NumberOfParts", "PointOffsets"})
    metadata(std::string("Steps/") + name, H5T_STD_I64LE, 0);
  for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
    metadata(std::string("Steps/") + name, H5T_STD_I64LE, 4);

  vtkhdf::write_header(file, "PolyData", notes);
}

std::int64_t particle_step_count(const File& file) {
  return vtkhdf::read_step_count(file, true, "particles");
}

template <class T>
std::vector<T> read_column(const File& file, const std::string& name, hid_t type, std::int64_t rows) {
  const Id data = file.dataset(name);
  const Id space = file.take(H5Dget_space(data), H5Sclose, "read");
  if (H5Sget_simple_extent_npoints(space) < rows)
    throw FileError("cannot read '" + file.path().string() + "': " + name + " is shorter than the number of steps");
  std::vector<T> values(static_cast<std::size_t>(rows));
  if (rows == 0) return values;
  const hsize_t first = 0, count = static_cast<hsize_t>(rows);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &count, nullptr);
  const Id memory = file.take(H5Screate_simple(1, &count, nullptr), H5Sclose, "read");
  file.check(H5Dread(data, type, memory, space, H5P_DEFAULT, values.data()), "read");
  return values;
}

// An open dataset with its size and chunk.
struct Rows {
  Id data;
  int rank = 1;
  hsize_t columns = 1;
  hsize_t chunk = 1;
};

Rows open_rows(const File& file, const std::string& name) {
  Rows rows;
  rows.data = file.dataset(name);
  const Id space = file.take(H5Dget_space(rows.data), H5Sclose, "read");
  const Id creation = file.take(H5Dget_create_plist(rows.data), H5Pclose, "read");
  hsize_t size[2] = {0, 1}, chunk[2] = {1, 1};
  rows.rank = H5Sget_simple_extent_ndims(space);
  if (rows.rank > 2) throw FileError("cannot write '" + file.path().string() + "': " + name + " has a foreign shape");
  file.check(H5Sget_simple_extent_dims(space, size, nullptr), "read");
  file.check(H5Pget_chunk(creation, 2, chunk), "read");
  rows.columns = rows.rank == 2 ? size[1] : 1;
  rows.chunk = chunk[0];
  return rows;
}

void set_rows(const File& file, const Rows& rows, hsize_t count) {
  const hsize_t size[2] = {count, rows.columns};
  file.check(H5Dset_extent(rows.data, size), "write");
}

void write_rows(const File& file, const Rows& rows, hsize_t first, hsize_t count, hid_t type, const void* values) {
  const hsize_t start[2] = {first, 0}, size[2] = {count, rows.columns};
  const Id space = file.take(H5Dget_space(rows.data), H5Sclose, "write");
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, size, nullptr);
  const Id memory = file.take(H5Screate_simple(rows.rank, size, nullptr), H5Sclose, "write");
  file.check(H5Dwrite(rows.data, type, memory, space, H5P_DEFAULT, values), "write");
}

// Rows [first, first + count) in blocks that end on chunk boundaries, so that no chunk is compressed twice and
// the buffer stays small. fill(buffer, local_first, local_count) gives `columns` values per row.
template <class T, class Fill>
void write_blocks(const File& file, const std::string& name, hsize_t first, hsize_t count, hid_t type, Fill&& fill) {
  const Rows rows = open_rows(file, name);
  set_rows(file, rows, first + count);
  const hsize_t block = std::max(rows.chunk, largest_chunk);
  std::vector<T> buffer(std::min(block, count) * rows.columns);
  for (hsize_t done = 0; done < count;) {
    const hsize_t row = first + done;
    const hsize_t here = std::min(count - done, (row / block + 1) * block - row);
    fill(buffer.data(), done, here);
    write_rows(file, rows, row, here, type, buffer.data());
    done += here;
  }
}

template <class Stored, class Given>
void write_components(const File& file, const std::string& name, hsize_t first, hsize_t count, hid_t type,
                      const std::vector<const Given*>& components, std::size_t columns) {
  write_blocks<Stored>(file, name, first, count, type, [&](Stored* out, hsize_t from, hsize_t rows) {
    for (std::size_t c = 0; c < columns; ++c)
      for (hsize_t i = 0; i < rows; ++i)
        out[i * columns + c] = c < components.size() ? static_cast<Stored>(components[c][from + i]) : Stored{0};
  });
}

template <class T>
void write_metadata(const File& file, const std::string& name, std::int64_t row, hid_t type, const T* values) {
  const Rows rows = open_rows(file, "/VTKHDF/" + name);
  set_rows(file, rows, static_cast<hsize_t>(row) + 1);
  write_rows(file, rows, static_cast<hsize_t>(row), 1, type, values);
}

// Rows of the particle arrays before step `step`, from the counts of the finished steps.
hsize_t rows_before(const File& file, std::int64_t step) {
  const auto counts = read_column<std::int64_t>(file, "/VTKHDF/NumberOfPoints", H5T_NATIVE_INT64, step);
  return static_cast<hsize_t>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
}

void write_particles(const File& file, const ParticleSnapshot& snapshot, std::int64_t step, hsize_t first) {
  const hsize_t size = snapshot.size;
  write_components<float>(file, "/VTKHDF/Points", first, size, H5T_NATIVE_FLOAT, snapshot.position, 3);
  for (const auto& field : snapshot.fields) {
    const std::string name = "/VTKHDF/PointData/" + field.name;
    const auto columns = static_cast<std::size_t>(stored_components(field));
    if (!file.exists(name) || open_rows(file, name).columns != columns)
      throw FileError("cannot write '" + file.path().string() + "': the field " + field.name +
                      " is not the one of the earlier snapshots");
    if (field.i64.empty())
      write_components<float>(file, name, first, size, H5T_NATIVE_FLOAT, field.f64, columns);
    else
      write_components<std::int64_t>(file, name, first, size, H5T_NATIVE_INT64, field.i64, columns);
  }
  const auto count_up = [](std::int64_t* out, hsize_t from, hsize_t rows) {
    std::iota(out, out + rows, static_cast<std::int64_t>(from));
  };
  // Every step has one offset more than it has cells.
  write_blocks<std::int64_t>(file, "/VTKHDF/Vertices/Offsets", first + static_cast<hsize_t>(step), size + 1,
                             H5T_NATIVE_INT64, count_up);
  write_blocks<std::int64_t>(file, "/VTKHDF/Vertices/Connectivity", first, size, H5T_NATIVE_INT64, count_up);
}

void write_step(const File& file, double time, std::int64_t size, std::int64_t step, hsize_t first) {
  const std::int64_t zero = 0, one = 1, row = static_cast<std::int64_t>(first);
  write_metadata(file, "NumberOfPoints", step, H5T_NATIVE_INT64, &size);
  for (const std::string topology : topologies) {
    const bool vertices = topology == topologies[0];
    write_metadata(file, topology + "/NumberOfCells", step, H5T_NATIVE_INT64, vertices ? &size : &zero);
    write_metadata(file, topology + "/NumberOfConnectivityIds", step, H5T_NATIVE_INT64, vertices ? &size : &zero);
    if (!vertices) write_metadata(file, topology + "/Offsets", step, H5T_NATIVE_INT64, &zero);
  }
  write_metadata(file, "Steps/Values", step, H5T_NATIVE_DOUBLE, &time);
  write_metadata(file, "Steps/PartOffsets", step, H5T_NATIVE_INT64, &step);
  write_metadata(file, "Steps/NumberOfParts", step, H5T_NATIVE_INT64, &one);
  write_metadata(file, "Steps/PointOffsets", step, H5T_NATIVE_INT64, &row);
  const std::int64_t cells[4] = {row, 0, 0, 0};
  write_metadata(file, "Steps/CellOffsets", step, H5T_NATIVE_INT64, cells);
  write_metadata(file, "Steps/ConnectivityIdOffsets", step, H5T_NATIVE_INT64, cells);
}

// One column of a stored array, seen as a one-dimensional dataset of the step's group.
void link_column(const File& file, const std::string& view, const std::string& source, hid_t type, hsize_t column,
                 hsize_t first, hsize_t count) {
  const Rows rows = open_rows(file, source);
  const Id source_space = file.take(H5Dget_space(rows.data), H5Sclose, "write");
  const hsize_t start[2] = {first, column}, size[2] = {count, 1};
  H5Sselect_hyperslab(source_space, H5S_SELECT_SET, start, nullptr, size, nullptr);
  const Id space = file.take(H5Screate_simple(1, &count, nullptr), H5Sclose, "write");
  const Id creation = hdf5::dataset_creation();
  file.check(H5Pset_virtual(creation, space, ".", source.c_str(), source_space), "write");
  const Id data = file.take(H5Dcreate2(file.id(), view.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                            H5Dclose, "write");
}

void write_h5part_step(const File& file, double time, const ParticleSnapshot& snapshot, std::int64_t step,
                       hsize_t first) {
  const std::string group_name = "/Step#" + std::to_string(step);
  if (file.exists(group_name)) file.check(H5Ldelete(file.id(), group_name.c_str(), H5P_DEFAULT), "write");
  const Id group =
      file.take(H5Gcreate2(file.id(), group_name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "write");
  write_attribute(file, group, "TimeValue", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, std::nullopt, &time);
  const hsize_t size = snapshot.size;
  const std::array<const char*, 3> axes = {"x", "y", "z"};
  for (hsize_t axis = 0; axis < 3; ++axis)
    link_column(file, group_name + '/' + axes[axis], "/VTKHDF/Points", H5T_IEEE_F32LE, axis, first, size);
  for (const auto& field : snapshot.fields) {
    const int components = stored_components(field);
    for (int c = 0; c < components; ++c) {
      const std::string name = components == 1 ? field.name : field.name + '_' + std::to_string(c);
      link_column(file, group_name + '/' + name, "/VTKHDF/PointData/" + field.name,
                  field.i64.empty() ? H5T_IEEE_F32LE : H5T_STD_I64LE, static_cast<hsize_t>(c), first, size);
    }
  }
}

std::filesystem::path h5part_link(std::filesystem::path path) {
  return path.replace_extension(".h5part");
}

std::int64_t snapshot_bytes(const ParticleSnapshot& snapshot) {
  std::int64_t row = 3 * sizeof(float) + 2 * sizeof(std::int64_t);
  for (const auto& field : snapshot.fields)
    row +=
        stored_components(field) * static_cast<std::int64_t>(field.i64.empty() ? sizeof(float) : sizeof(std::int64_t));
  // Beside the rows: rewritten last chunks, their index, and the metadata of a step.
  constexpr std::int64_t beside = 512 * 1024;
  return static_cast<std::int64_t>(snapshot.size) * row * 5 / 4 + beside;
}

void cut_steps(const File& file, std::int64_t count, std::int64_t steps) {
  const hsize_t kept = rows_before(file, count), rows = static_cast<hsize_t>(count);
  vtkhdf::write_step_count(file, count);
  file.flush();
  const auto cut = [&](const std::string& name, hsize_t size) {
    set_rows(file, open_rows(file, "/VTKHDF/" + name), size);
  };
  cut("NumberOfPoints", rows);
  cut("Points", kept);
  for (const std::string topology : topologies) {
    const bool vertices = topology == topologies[0];
    cut(topology + "/NumberOfCells", rows);
    cut(topology + "/NumberOfConnectivityIds", rows);
    cut(topology + "/Offsets", vertices ? kept + rows : rows);
    if (vertices) cut(topology + "/Connectivity", kept);
  }
  if (file.exists("/VTKHDF/PointData"))
    for (const auto& name : vtkhdf::member_names(file, "/VTKHDF/PointData")) cut("PointData/" + name, kept);
  for (const char* name :
       {"Values", "PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"})
    cut(std::string("Steps/") + name, rows);
  for (std::int64_t step = count; step < steps; ++step) {
    const std::string name = "/Step#" + std::to_string(step);
    if (file.exists(name)) file.check(H5Ldelete(file.id(), name.c_str(), H5P_DEFAULT), "write");
  }
}

}  // namespace

VtkhdfContents read_vtkhdf_contents(const std::filesystem::path& path) {
  File file = File::open(path, false);
  const std::int64_t steps = particle_step_count(file);
  VtkhdfContents contents;
  contents.times = read_column<double>(file, "/VTKHDF/Steps/Values", H5T_NATIVE_DOUBLE, steps);
  contents.sizes = read_column<std::int64_t>(file, "/VTKHDF/NumberOfPoints", H5T_NATIVE_INT64, steps);
  if (file.exists("/VTKHDF/PointData"))
    for (const auto& name : vtkhdf::member_names(file, "/VTKHDF/PointData"))
      contents.fields.push_back({name, static_cast<int>(open_rows(file, "/VTKHDF/PointData/" + name).columns)});
  return contents;
}

VtkhdfFile::VtkhdfFile(std::filesystem::path path, Options options)
    : path_(std::move(path)), options_(std::move(options)) {
  if (!std::filesystem::exists(path_)) return;
  hdf5::replay_journal(path_);
  steps_ = particle_step_count(File::open(path_, false));
}

void VtkhdfFile::append(double time, const ParticleSnapshot& snapshot) {
  if (snapshot.size == 0) return;
  try {
    write(time, snapshot);
  } catch (const FileError&) {
    if (steps_ == 0) hdf5::remove_with_journal(path_);
    throw;
  }
}

void VtkhdfFile::write(double time, const ParticleSnapshot& snapshot) {
  if (!std::filesystem::exists(path_)) {
    File file = File::create(path_, File::Format::compatible);
    create_layout(file, snapshot, options_.notes);
    file.close();
  }
  const ReservedSpace space(path_, snapshot_bytes(snapshot));
  File file = File::open(path_, true);
  const hsize_t first = rows_before(file, steps_);
  write_particles(file, snapshot, steps_, first);
  write_step(file, time, static_cast<std::int64_t>(snapshot.size), steps_, first);
  if (options_.h5part_view) write_h5part_step(file, time, snapshot, steps_, first);
  // Readers trust the number of steps: it is raised when everything else is in the file.
  file.flush();
  vtkhdf::write_step_count(file, steps_ + 1);
  file.close();
  ++steps_;
  if (options_.h5part_view && steps_ == 1) {
    std::error_code refused;  // a file system without links loses only the second name
    std::filesystem::create_symlink(path_.filename(), h5part_link(path_), refused);
  }
}

void VtkhdfFile::keep_steps(std::int64_t count) {
  vtkhdf::require_steps(path_, steps_, count);
  if (count == 0) {
    std::error_code failure;
    std::filesystem::remove(h5part_link(path_), failure);
    std::filesystem::remove(path_, failure);
    if (failure) throw_file_error(path_, "remove", failure.value());
  } else if (count < steps_) {
    File file = File::open(path_, true);
    cut_steps(file, count, steps_);
    file.close();
  }
  steps_ = count;
}

}  // namespace spume
