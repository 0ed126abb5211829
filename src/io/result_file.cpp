// SPDX-License-Identifier: MIT
#include "spume/io/result_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/io/hdf5.hpp"
#include "spume/io/vtkhdf_steps.hpp"

namespace spume {
namespace {

using hdf5::File;
using hdf5::Id;

constexpr hsize_t most_numbers = hsize_t{1} << 31U;  // of an array that is read; a damaged file may tell of any number
constexpr std::size_t most_components = 9;
constexpr const char* vtk = "/VTKHDF";

[[noreturn]] void refuse(const File& file, const std::string& why) {
  throw FileError("cannot read '" + file.path().string() + "': " + why);
}

H5T_class_t class_of(const File& file, hid_t data) {
  const Id type = file.take(H5Dget_type(data), H5Tclose, "read");
  return H5Tget_class(type);
}

bool is_number(H5T_class_t kind) {
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

// Part of an array. Throws FileError for a part that is not there.
template <class T>
std::vector<T> read_part(const File& file, hid_t data, const std::vector<hsize_t>& start,
                         const std::vector<hsize_t>& count, hid_t type) {
  const std::vector<hsize_t> size = extent_of(file, data);
  hsize_t numbers = 1;
  for (std::size_t axis = 0; axis < count.size(); ++axis) {
    if (size.size() != count.size() || start[axis] > size[axis] || count[axis] > size[axis] - start[axis])
      refuse(file, "an array is shorter than the steps tell");
    if (count[axis] > 0 && numbers > most_numbers / count[axis]) refuse(file, "an array has more than 2^31 numbers");
    numbers *= count[axis];
  }
  std::vector<T> values(numbers);
  if (numbers == 0) return values;
  const Id space = file.take(H5Dget_space(data), H5Sclose, "read");
  file.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), "read");
  const Id memory =
      file.take(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose, "read");
  file.check(H5Dread(data, type, memory, space, H5P_DEFAULT, values.data()), "read");
  return values;
}

std::vector<std::int64_t> read_integers(const File& file, const std::string& name) {
  const Id data = file.dataset(name);
  const std::vector<hsize_t> size = extent_of(file, data);
  if (size.size() != 1) refuse(file, name + " is no list");
  return read_part<std::int64_t>(file, data, {0}, size, H5T_NATIVE_INT64);
}

// A number that is kept per step.
std::int64_t integer_of_step(const File& file, const std::string& name, std::size_t step, std::int64_t otherwise) {
  if (!file.exists(name)) return otherwise;
  const Id data = file.dataset(name);
  if (extent_of(file, data).size() != 1) refuse(file, name + " is no list");
  const std::int64_t value = read_part<std::int64_t>(file, data, {step}, {1}, H5T_NATIVE_INT64)[0];
  if (value < 0) refuse(file, name + " has the entry " + std::to_string(value));
  return value;
}

std::vector<double> attribute_numbers(const File& file, const char* object, const char* name, std::size_t count) {
  const Id attribute = file.take(H5Aopen_by_name(file.id(), object, name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "read");
  const Id space = file.take(H5Aget_space(attribute), H5Sclose, "read");
  if (H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(count))
    refuse(file, std::string(name) + " has another size");
  std::vector<double> values(count);
  file.check(H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()), "read");
  return values;
}

std::string type_of(const File& file) {
  if (H5Aexists_by_name(file.id(), vtk, "Type", H5P_DEFAULT) <= 0) return "";
  const Id attribute = file.take(H5Aopen_by_name(file.id(), vtk, "Type", H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "read");
  const Id type = file.take(H5Aget_type(attribute), H5Tclose, "read");
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || H5Tget_size(type) > 64) return "";
  std::string text(H5Tget_size(type), '\0');
  file.check(H5Aread(attribute, type, text.data()), "read");
  return text.substr(0, text.find('\0'));
}

std::vector<double> step_times(const File& file) {
  if (!file.exists(std::string(vtk) + "/Steps")) return {0};
  const Id attribute =
      file.take(H5Aopen_by_name(file.id(), "/VTKHDF/Steps", "NSteps", H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "read");
  std::int64_t steps = 0;
  file.check(H5Aread(attribute, H5T_NATIVE_INT64, &steps), "read");
  if (steps < 0) refuse(file, "it tells of " + std::to_string(steps) + " steps");
  const Id data = file.dataset("/VTKHDF/Steps/Values");
  return read_part<double>(file, data, {0}, {static_cast<hsize_t>(steps)}, H5T_NATIVE_DOUBLE);
}

// Rows [first, first + count) of a list or of a table, one list per column. Fields of other shapes are left out.
void add_field(const File& file, const std::string& name, hid_t data, hsize_t first, hsize_t count, ResultStep& into,
               std::vector<ParticleField>& fields) {
  const std::vector<hsize_t> size = extent_of(file, data);
  const H5T_class_t kind = class_of(file, data);
  const std::size_t columns = size.size() == 2 ? size[1] : 1;
  if (!is_number(kind) || size.empty() || size.size() > 2 || columns == 0 || columns > most_components) return;
  std::vector<hsize_t> start{first}, part{count};
  if (size.size() == 2) start.push_back(0), part.push_back(columns);
  ParticleField field{name, {}, {}};
  const auto split = [&](auto values, auto& kept, auto& pointers) {
    for (std::size_t column = 0; column < columns; ++column) {
      auto& one = kept.emplace_back(count);
      for (std::size_t i = 0; i < count; ++i) one[i] = values[i * columns + column];
      pointers.push_back(one.data());
    }
  };
  if (kind == H5T_INTEGER)
    split(read_part<std::int64_t>(file, data, start, part, H5T_NATIVE_INT64), into.integers, field.i64);
  else
    split(read_part<double>(file, data, start, part, H5T_NATIVE_DOUBLE), into.reals, field.f64);
  fields.push_back(std::move(field));
}

void read_vtkhdf_particles(const File& file, std::size_t step, const std::string& family, ResultStep& into) {
  const std::string root = vtk, steps = root + "/Steps";
  const std::vector<std::int64_t> points = read_integers(file, root + "/NumberOfPoints");
  const bool over_time = file.exists(steps);
  const auto part = static_cast<std::size_t>(
      over_time ? integer_of_step(file, steps + "/PartOffsets", step, static_cast<std::int64_t>(step)) : 0);
  const auto parts = static_cast<std::size_t>(over_time ? integer_of_step(file, steps + "/NumberOfParts", step, 1)
                                                        : static_cast<std::int64_t>(points.size()));
  if (part > points.size() || parts > points.size() - part) refuse(file, "a step has parts that are not there");
  std::int64_t before = 0, count = 0;
  for (std::size_t k = 0; k < part + parts; ++k) {
    if (points[k] < 0 || points[k] > static_cast<std::int64_t>(most_numbers))
      refuse(file, "a part has an impossible number of points");
    (k < part ? before : count) += points[k];
  }
  const auto first = static_cast<hsize_t>(integer_of_step(file, steps + "/PointOffsets", step, before));
  const auto size = static_cast<hsize_t>(count);

  ParticleSnapshot snapshot{family, size, {}, {}};
  std::vector<ParticleField> position;
  add_field(file, "position", file.dataset(root + "/Points"), first, size, into, position);
  if (position.empty() || position[0].f64.size() != 3) refuse(file, "its Points are no places in space");
  snapshot.position = position[0].f64;
  if (file.exists(root + "/PointData"))
    for (const std::string& name : vtkhdf::member_names(file, root + "/PointData")) {
      const auto at = static_cast<hsize_t>(
          integer_of_step(file, steps + "/PointDataOffsets/" + name, step, static_cast<std::int64_t>(first)));
      add_field(file, name, file.dataset(root + "/PointData/" + name), at, size, into, snapshot.fields);
    }
  into.families.push_back(std::move(snapshot));
}

void read_vtkhdf_grid(const File& file, std::size_t step, const std::string& family, ResultStep& into) {
  const std::string root = vtk;
  const std::vector<double> whole = attribute_numbers(file, vtk, "WholeExtent", 6);
  const std::vector<double> origin = attribute_numbers(file, vtk, "Origin", 3),
                            spacing = attribute_numbers(file, vtk, "Spacing", 3);
  GridSnapshot grid;
  grid.name = family;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double points = whole[2 * axis + 1] - whole[2 * axis] + 1;
    if (!(points >= 1 && points <= 1e6)) refuse(file, "its WholeExtent holds no points");
    grid.points[axis] = static_cast<std::size_t>(points);
    grid.origin[axis] = origin[axis] + whole[2 * axis] * spacing[axis];
    grid.spacing[axis] = spacing[axis];
  }
  grid.periodic = file.exists("/Spume");  // other programs write both ends
  const bool over_time = file.exists(root + "/Steps");
  if (!file.exists(root + "/PointData")) refuse(file, "it has no PointData");
  const auto [nx, ny, nz] = grid.points;
  for (const std::string& name : vtkhdf::member_names(file, root + "/PointData")) {
    const Id data = file.dataset(root + "/PointData/" + name);
    const std::vector<hsize_t> size = extent_of(file, data);
    const std::size_t axes = over_time ? 4 : 3;
    if (!is_number(class_of(file, data)) || size.size() < axes || size.size() > axes + 1) continue;
    const std::size_t components = size.size() > axes ? size[axes] : 1;
    if (components == 0 || components > most_components) continue;
    std::vector<hsize_t> start(size.size(), 0), count{nz, ny, nx};
    if (over_time) {
      count.insert(count.begin(), 1);
      start[0] = static_cast<hsize_t>(
          integer_of_step(file, root + "/Steps/PointDataOffsets/" + name, step, static_cast<std::int64_t>(step)));
    }
    if (size.size() > axes) count.push_back(components);
    const std::vector<float> values = read_part<float>(file, data, start, count, H5T_NATIVE_FLOAT);
    GridSnapshot::Field field{name, {}};
    for (std::size_t c = 0; c < components; ++c) {
      std::vector<float>& one = into.grid_values.emplace_back(nx * ny * nz);
      for (std::size_t z = 0; z < nz; ++z)
        for (std::size_t y = 0; y < ny; ++y)
          for (std::size_t x = 0; x < nx; ++x)
            one[(x * ny + y) * nz + z] = values[((z * ny + y) * nx + x) * components + c];
      field.components.push_back(one.data());
    }
    grid.fields.push_back(std::move(field));
  }
  into.grids.push_back(std::move(grid));
}

// "velocity" and 1 of "velocity_1"; and -1 of a name without a number at its end.
std::pair<std::string, int> split_name(const std::string& name) {
  const std::size_t end = name.rfind('_');
  if (end == std::string::npos || end + 2 != name.size() || name[end + 1] < '0' || name[end + 1] > '8')
    return {name, -1};
  return {name.substr(0, end), name[end + 1] - '0'};
}

void read_h5part(const File& file, const std::string& group, const std::string& family, ResultStep& into) {
  ParticleSnapshot snapshot{family, 0, {}, {}};
  std::map<std::string, std::vector<ParticleField>> parts;
  std::optional<hsize_t> count;
  const auto read = [&](const std::string& name) {
    const Id data = file.dataset(group + '/' + name);
    const std::vector<hsize_t> size = extent_of(file, data);
    std::vector<ParticleField> one;
    if (size.size() != 1) return one;
    if (!count) count = size[0];
    if (size[0] == *count) add_field(file, name, data, 0, *count, into, one);
    return one;
  };
  for (const char* axis : {"x", "y", "z"}) {
    if (!file.exists(group + '/' + axis)) {
      if (*axis != 'z' || !count) refuse(file, group + " has no " + axis);
      snapshot.position.push_back(into.reals.emplace_back(*count, 0.0).data());
      continue;
    }
    const std::vector<ParticleField> one = read(axis);
    if (one.empty() || one[0].f64.empty()) refuse(file, group + '/' + axis + " is no list of real numbers");
    snapshot.position.push_back(one[0].f64[0]);
  }
  snapshot.size = *count;
  for (const std::string& name : vtkhdf::member_names(file, group)) {
    if (name == "x" || name == "y" || name == "z") continue;
    H5O_info_t info;
    if (H5Oget_info_by_name(file.id(), (group + '/' + name).c_str(), &info, H5P_DEFAULT) < 0 ||
        info.type != H5O_TYPE_DATASET)
      continue;
    std::vector<ParticleField> one = read(name);
    if (one.empty()) continue;
    const auto [whole, component] = split_name(name);
    std::vector<ParticleField>& list = parts[component < 0 ? name : whole];
    list.push_back(std::move(one[0]));
  }
  for (auto& [name, list] : parts) {
    // Components come in the order of their numbers; integers and single ones stay as they are.
    const bool vector =
        list.size() > 1 && std::all_of(list.begin(), list.end(), [](const auto& one) { return !one.f64.empty(); });
    ParticleField field{name, {}, {}};
    if (!vector) {
      for (ParticleField& one : list) snapshot.fields.push_back(std::move(one));
      continue;
    }
    for (const ParticleField& one : list) field.f64.push_back(one.f64[0]);
    snapshot.fields.push_back(std::move(field));
  }
  into.families.push_back(std::move(snapshot));
}

}  // namespace

ResultFile::ResultFile(std::filesystem::path path) : path_(std::move(path)), family_(path_.stem().string()) {
  refresh();
}

void ResultFile::refresh() {
  const File file = File::open(path_, false);
  groups_.clear();
  if (file.exists(vtk)) {
    const std::string type = type_of(file);
    if (type == "ImageData")
      kind_ = Kind::vtkhdf_grid;
    else if (type == "PolyData" || type == "UnstructuredGrid")
      kind_ = Kind::vtkhdf_particles;
    else
      refuse(file, "its VTKHDF type is '" + type + "'; PolyData, UnstructuredGrid and ImageData are shown");
    times_ = step_times(file);
    return;
  }
  kind_ = Kind::h5part;
  std::vector<std::pair<double, std::string>> steps;
  for (const std::string& name : vtkhdf::member_names(file, "/")) {
    if (!name.starts_with("Step#")) continue;
    const std::string group = '/' + name;
    const bool timed = H5Aexists_by_name(file.id(), group.c_str(), "TimeValue", H5P_DEFAULT) > 0;
    steps.emplace_back(
        timed ? attribute_numbers(file, group.c_str(), "TimeValue", 1)[0] : std::strtod(name.c_str() + 5, nullptr),
        group);
  }
  if (steps.empty()) refuse(file, "it holds neither VTKHDF nor H5Part steps");
  std::stable_sort(steps.begin(), steps.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  times_.clear();
  for (auto& [time, group] : steps) {
    times_.push_back(time);
    groups_.push_back(std::move(group));
  }
}

void ResultFile::read(std::size_t step, ResultStep& into) const {
  const File file = File::open(path_, false);
  switch (kind_) {
    case Kind::vtkhdf_particles:
      return read_vtkhdf_particles(file, step, family_, into);
    case Kind::vtkhdf_grid:
      return read_vtkhdf_grid(file, step, family_, into);
    case Kind::h5part:
      return read_h5part(file, groups_[step], family_, into);
  }
}

}  // namespace spume
