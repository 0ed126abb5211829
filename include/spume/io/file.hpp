// SPDX-License-Identifier: MIT
// Small file operations whose failures are FileErrors that name the file and the system's reason.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace spume {

// Throws FileError "cannot <action> '<path>': <reason of error_number>".
[[noreturn]] void throw_file_error(const std::filesystem::path& path, std::string_view action, int error_number);

// The whole file. Throws FileError.
std::string read_text(const std::filesystem::path& path);

// Writes to a temporary name in the same folder, syncs it and renames it over `path`: readers see the old or
// the new text, never a part. Throws FileError and leaves no temporary file.
void write_text_atomically(const std::filesystem::path& path, std::string_view text);

// Syncs a written file to the disk, renames it to `to` and syncs the folder. Throws FileError.
void sync_and_rename(const std::filesystem::path& from, const std::filesystem::path& to);

// Blocks promised to a file for writing `bytes` past its end, given back by the destructor where unused. A full
// disk is thereby noticed before the file is touched, not in the middle of an update of its metadata. File
// systems that cannot promise space are asked how much is free. Throws FileError when the space is not there or
// the file would exceed the user's limit.
class ReservedSpace {
 public:
  ReservedSpace(std::filesystem::path path, std::int64_t bytes);
  ReservedSpace(const ReservedSpace&) = delete;
  ReservedSpace& operator=(const ReservedSpace&) = delete;
  ~ReservedSpace();

 private:
  std::filesystem::path path_;
};

}  // namespace spume
