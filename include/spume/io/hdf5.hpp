// SPDX-License-Identifier: MIT
// Handles and errors of the HDF5 C library: identifiers that close themselves, failures as FileErrors.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace spume::hdf5 {

// Owns one identifier of the library.
class Id {
 public:
  using Close = herr_t (*)(hid_t);
  Id() = default;
  Id(hid_t id, Close close) : id_(id), close_(close) {}
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  hid_t release() { return std::exchange(id_, -1); }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

// Throws FileError "cannot <action> '<path>': <reason>", where the reason is the system's own words when the
// library reports them, and the library's innermost message otherwise.
[[noreturn]] void throw_error(const std::filesystem::path& path, std::string_view action);

// One open file. Every member throws FileError.
class File {
 public:
  enum class Format { compatible, latest };  // latest: metadata carry checksums
  static File create(const std::filesystem::path& path, Format format, std::int64_t user_block_bytes = 0);
  static File open(const std::filesystem::path& path, bool writable);

  hid_t id() const { return id_; }
  const std::filesystem::path& path() const { return path_; }

  void check(herr_t status, std::string_view action) const {
    if (status < 0) throw_error(path_, action);
  }
  Id take(hid_t id, Id::Close close, std::string_view action) const {
    if (id < 0) throw_error(path_, action);
    return Id(id, close);
  }
  bool exists(const std::string& name) const;  // every part of the name exists
  Id dataset(const std::string& name) const;

  void flush() const { check(H5Fflush(id_, H5F_SCOPE_LOCAL), "write"); }
  void close();  // closes everything that is open in the file and reports what could not be written

 private:
  File(std::filesystem::path path, Id id) : path_(std::move(path)), id_(std::move(id)) {}
  std::filesystem::path path_;
  Id id_;
};

// Of an array, along its axes; none of a single number.
std::vector<hsize_t> extent_of(const File& file, hid_t data);

// Makes or overwrites an attribute; without a count it is a scalar.
void write_attribute(const File& file, hid_t object, const char* name, hid_t file_type, hid_t memory_type,
                     std::optional<hsize_t> count, const void* value);
// The properties that every dataset starts from: without the time of its making, which would tell two files of one
// state apart.
Id dataset_creation();
// The groups above that name that do not exist, without times as well.
void make_groups(const File& file, const std::string& name);

// A string of fixed length: readers of VTKHDF accept no other.
void write_fixed_string(const File& file, hid_t object, const char* name, const std::string& text);

// A text as a one-dimensional dataset of bytes; missing groups of the name are made.
void write_text(const File& file, const std::string& name, std::string_view text);
std::string read_text(const File& file, const std::string& name);

}  // namespace spume::hdf5
