// SPDX-License-Identifier: MIT
#include "spume/io/hdf5.hpp"

#include <cstdlib>
#include <mutex>

#include "spume/core/error.hpp"
#include "spume/io/journal.hpp"

namespace spume::hdf5 {
namespace {

void initialise() {
  static std::once_flag once;
  std::call_once(once, [] {
    // Without locks a viewer can open a result while the run goes on, and a run can append while a viewer looks.
    setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
    // After a failed write the library would try to flush again at exit, and complain or loop.
    H5dont_atexit();
    H5open();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  });
}

// The library quotes the system as: errno = 28, error message = 'No space left on device'.
herr_t find_reason(unsigned, const H5E_error2_t* error, void* data) {
  auto& reason = *static_cast<std::string*>(data);
  const std::string text = error->desc != nullptr ? error->desc : "";
  const std::string mark = "error message = '";
  if (const auto start = text.find(mark); start != std::string::npos) {
    const auto first = start + mark.size();
    reason = text.substr(first, text.find('\'', first) - first);
    return 1;
  }
  if (reason.empty()) reason = text;
  return 0;
}

Id property_list(hid_t kind) {
  return Id(H5Pcreate(kind), H5Pclose);
}

Id file_access() {
  Id access = property_list(H5P_FILE_ACCESS);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  return access;
}

}  // namespace

void throw_error(const std::filesystem::path& path, std::string_view action) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, find_reason, &reason);
  H5Eclear2(H5E_DEFAULT);
  if (reason.empty()) reason = "the HDF5 library gives no reason";
  if (reason == "inflate() failed") reason = "what it holds is damaged and does not unpack";
  throw FileError("cannot " + std::string(action) + " '" + path.string() + "': " + reason);
}

std::vector<hsize_t> extent_of(const File& file, hid_t data) {
  const Id space = file.take(H5Dget_space(data), H5Sclose, "read");
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) throw_error(file.path(), "read");
  std::vector<hsize_t> size(static_cast<std::size_t>(rank));
  if (rank > 0) file.check(H5Sget_simple_extent_dims(space, size.data(), nullptr), "read");
  return size;
}

Id dataset_creation() {
  Id creation = property_list(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(creation, false);
  return creation;
}

File File::create(const std::filesystem::path& path, Format format, std::int64_t user_block_bytes) {
  initialise();
  const Id access = file_access();
  if (format == Format::latest) H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const Id creation = property_list(H5P_FILE_CREATE);
  H5Pset_obj_track_times(creation, false);  // of the root
  if (user_block_bytes > 0) H5Pset_userblock(creation, static_cast<hsize_t>(user_block_bytes));
  const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access);
  if (id < 0) throw_error(path, "create");
  return File(path, Id(id, H5Fclose));
}

File File::open(const std::filesystem::path& path, bool writable) {
  initialise();
  const Id access = file_access();
  if (writable) {
    replay_journal(path);
    use_journal(access);
  }
  const hid_t id = H5Fopen(path.c_str(), writable ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access);
  if (id < 0) throw_error(path, "open");
  return File(path, Id(id, H5Fclose));
}

bool File::exists(const std::string& name) const {
  for (std::size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
    const std::string part = name.substr(0, end);
    const htri_t found = H5Lexists(id_, part.c_str(), H5P_DEFAULT);
    if (found <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

Id File::dataset(const std::string& name) const {
  return take(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), H5Dclose, "read '" + name + "' of");
}

void File::close() {
  check(H5Fflush(id_, H5F_SCOPE_GLOBAL), "write");
  const hid_t id = id_.release();
  check(H5Fclose(id), "write");
}

void write_attribute(const File& file, hid_t object, const char* name, hid_t file_type, hid_t memory_type,
                     std::optional<hsize_t> count, const void* value) {
  const Id space = file.take(count ? H5Screate_simple(1, &*count, nullptr) : H5Screate(H5S_SCALAR), H5Sclose, "write");
  const Id attribute =
      file.take(H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT)
                                            : H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT),
                H5Aclose, "write");
  file.check(H5Awrite(attribute, memory_type, value), "write");
}

void write_fixed_string(const File& file, hid_t object, const char* name, const std::string& text) {
  const Id type = file.take(H5Tcopy(H5T_C_S1), H5Tclose, "write");
  H5Tset_size(type, text.size());
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  write_attribute(file, object, name, type, type, std::nullopt, text.data());
}

void make_groups(const File& file, const std::string& name) {
  const Id creation = property_list(H5P_GROUP_CREATE);
  H5Pset_obj_track_times(creation, false);
  for (std::size_t end = name.find('/', 1); end != std::string::npos; end = name.find('/', end + 1)) {
    const std::string group = name.substr(0, end);
    if (!file.exists(group))
      file.take(H5Gcreate2(file.id(), group.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose, "write");
  }
}

void write_text(const File& file, const std::string& name, std::string_view text) {
  const hsize_t size = text.size();
  const Id space = file.take(H5Screate_simple(1, &size, nullptr), H5Sclose, "write");
  make_groups(file, name);
  const Id data =
      file.take(H5Dcreate2(file.id(), name.c_str(), H5T_STD_U8LE, space, H5P_DEFAULT, dataset_creation(), H5P_DEFAULT),
                H5Dclose, "write");
  if (size > 0) file.check(H5Dwrite(data, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "write");
}

std::string read_text(const File& file, const std::string& name) {
  const Id data = file.dataset(name);
  const Id space = file.take(H5Dget_space(data), H5Sclose, "read");
  std::string text(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), '\0');
  if (!text.empty()) file.check(H5Dread(data, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "read");
  return text;
}

}  // namespace spume::hdf5
