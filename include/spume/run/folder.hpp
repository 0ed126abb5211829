// SPDX-License-Identifier: MIT
// The folder of a run: made once, never overwritten, held by one program at a time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace spume {

class RunFolder {
 public:
  // A new folder: `wanted`, or the first free runs/<name>-<n>, where <name> is the folder of the case (the stem of
  // a file that is not called case.toml). Two programs that start together get different folders.
  // Throws InputError when `wanted` holds anything already, FileError when it cannot be made.
  static RunFolder create(const std::filesystem::path& case_file, const std::optional<std::filesystem::path>& wanted);
  // An existing run to continue. Throws InputError when it is no run folder or another program works in it.
  static RunFolder open(const std::filesystem::path& folder);

  RunFolder(RunFolder&& other) noexcept;
  RunFolder& operator=(RunFolder&& other) = delete;
  ~RunFolder();

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  // Adds lines to log.txt. A log that cannot be written stops no run.
  void log(const std::string& text);

 private:
  RunFolder(std::filesystem::path path, int log) : path_(std::move(path)), log_(log) {}
  std::filesystem::path path_;
  int log_ = -1;  // descriptor of log.txt, which carries the lock
};

}  // namespace spume
