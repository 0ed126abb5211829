// SPDX-License-Identifier: MIT
#include "spume/io/vtkhdf_steps.hpp"

#include <optional>

#include "spume/core/error.hpp"

namespace spume::vtkhdf {

using hdf5::File;
using hdf5::Id;

void create_array(const File& file, const std::string& name, hid_t type, const std::vector<hsize_t>& row,
                  const std::vector<hsize_t>& chunk, bool compress) {
  std::vector<hsize_t> size{0}, limit{H5S_UNLIMITED};
  size.insert(size.end(), row.begin(), row.end());
  limit.insert(limit.end(), row.begin(), row.end());
  const int rank = static_cast<int>(size.size());
  const Id space = file.take(H5Screate_simple(rank, size.data(), limit.data()), H5Sclose, "write");
  const Id creation = hdf5::dataset_creation();
  H5Pset_chunk(creation, rank, chunk.data());
  if (compress) {
    H5Pset_shuffle(creation);
    H5Pset_deflate(creation, 1);
  }
  const Id links = file.take(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "write");
  H5Pset_create_intermediate_group(links, 1);
  const Id data =
      file.take(H5Dcreate2(file.id(), name.c_str(), type, space, links, creation, H5P_DEFAULT), H5Dclose, "write");
}

void write_header(const File& file, const char* type, const Notes& notes) {
  const Id root = file.take(H5Gopen2(file.id(), "/VTKHDF", H5P_DEFAULT), H5Gclose, "write");
  const std::int64_t version[2] = {2, 0};
  hdf5::write_attribute(file, root, "Version", H5T_STD_I64LE, H5T_NATIVE_INT64, 2, version);
  hdf5::write_fixed_string(file, root, "Type", type);
  write_step_count(file, 0);
  for (const auto& [name, text] : notes) hdf5::write_text(file, "/Spume/" + name, text);
}

std::int64_t read_step_count(const File& file, bool of_particles, const char* contents) {
  if (!file.exists("/VTKHDF/Steps/Values") || file.exists("/VTKHDF/NumberOfPoints") != of_particles)
    throw FileError("cannot read '" + file.path().string() + "': it holds no VTKHDF " + contents + " over time");
  const Id attribute = file.take(H5Aopen_by_name(file.id(), "/VTKHDF/Steps", "NSteps", H5P_DEFAULT, H5P_DEFAULT),
                                 H5Aclose, "read the number of steps of");
  std::int64_t steps = 0;
  file.check(H5Aread(attribute, H5T_NATIVE_INT64, &steps), "read");
  return steps;
}

void write_step_count(const File& file, std::int64_t steps) {
  const Id group = file.take(H5Gopen2(file.id(), "/VTKHDF/Steps", H5P_DEFAULT), H5Gclose, "write");
  hdf5::write_attribute(file, group, "NSteps", H5T_STD_I64LE, H5T_NATIVE_INT64, std::nullopt, &steps);
}

std::vector<std::string> member_names(const File& file, const std::string& group_name) {
  const Id group = file.take(H5Gopen2(file.id(), group_name.c_str(), H5P_DEFAULT), H5Gclose, "read");
  H5G_info_t info;
  file.check(H5Gget_info(group, &info), "read");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    char name[256];
    const auto length = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT);
    if (length > 0 && length < static_cast<ssize_t>(sizeof name)) names.emplace_back(name);
  }
  return names;
}

void require_steps(const std::filesystem::path& path, std::int64_t steps, std::int64_t count) {
  if (count > steps)
    throw FileError("cannot continue '" + path.string() + "': it holds " + std::to_string(steps) +
                    " snapshots, the checkpoint was made after " + std::to_string(count));
}

}  // namespace spume::vtkhdf
