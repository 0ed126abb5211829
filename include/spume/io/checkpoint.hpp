// SPDX-License-Identifier: MIT
// Checkpoints: named arrays of float64 and int64 with the case and the program that wrote them, in one HDF5 file.
//
// The first 512 bytes (an HDF5 user block) are a text: the mark, the format number, the length of the file and
// the CRC-32 of everything after them. A foreign, shortened or damaged file is therefore recognised before the
// HDF5 library sees it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spume/core/array.hpp"

namespace spume {

inline constexpr int checkpoint_format = 2;

struct CheckpointOrigin {
  std::string program_version;
  std::string commit;
  std::string case_text;       // the resolved case
  std::string case_file = {};  // that the run was started with; may be empty
};

// Writes beside `path` and takes its place on commit(); without commit nothing is left behind and an earlier
// checkpoint stays. Names may hold '/' for groups. Every member throws FileError.
class CheckpointWriter {
 public:
  CheckpointWriter(const std::filesystem::path& path, const CheckpointOrigin& origin);
  ~CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;
  CheckpointWriter& operator=(const CheckpointWriter&) = delete;

  void f64(const std::string& name, std::span<const double> values);
  void i64(const std::string& name, std::span<const std::int64_t> values);
  void commit();

 private:
  struct Open;
  std::filesystem::path path_, temporary_;
  std::unique_ptr<Open> open_;
};

// Checks the whole file when it is opened. Every member throws FileError with the file and the reason: not a
// checkpoint, another format, shortened, damaged, an array absent or of another type.
class CheckpointReader {
 public:
  explicit CheckpointReader(const std::filesystem::path& path);
  ~CheckpointReader();
  CheckpointReader(const CheckpointReader&) = delete;
  CheckpointReader& operator=(const CheckpointReader&) = delete;

  struct Entry {
    std::string name;
    std::string type;  // "f64" or "i64"
    std::int64_t size = 0;
  };
  const CheckpointOrigin& origin() const { return origin_; }
  std::vector<Entry> entries() const;
  bool has(const std::string& name) const;
  void f64(const std::string& name, Array<double>& values) const;
  void i64(const std::string& name, Array<std::int64_t>& values) const;

 private:
  struct Open;
  std::filesystem::path path_;
  std::unique_ptr<Open> open_;
  CheckpointOrigin origin_;
};

}  // namespace spume
