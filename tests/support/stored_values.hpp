// SPDX-License-Identifier: MIT
// What a file of snapshots holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

#include "spume/io/hdf5.hpp"

namespace spume::test {

// All values of an array of the file, in their order there.
template <class T = float>
std::vector<T> stored_values(const hdf5::File& file, const std::string& array) {
  const auto data = file.dataset(array);
  const auto space = file.take(H5Dget_space(data), H5Sclose, "read");
  std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  const hid_t type = std::is_same_v<T, float>    ? H5T_NATIVE_FLOAT
                     : std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE
                                                 : H5T_NATIVE_INT64;
  static_assert(std::is_same_v<T, float> || std::is_same_v<T, double> || std::is_same_v<T, std::int64_t>);
  if (!values.empty()) file.check(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read");
  return values;
}

template <class T = float>
std::vector<T> stored_values(const std::filesystem::path& path, const std::string& array) {
  return stored_values<T>(hdf5::File::open(path, false), array);
}

}  // namespace spume::test
