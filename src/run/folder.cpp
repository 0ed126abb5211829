// SPDX-License-Identifier: MIT
#include "spume/run/folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/io/file.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

void make_folders(const fs::path& path) {
  std::error_code failure;
  fs::create_directories(path, failure);
  if (failure) throw_file_error(path, "create folder", failure.value());
}

// False when something of that name is there already.
bool make_folder(const fs::path& path) {
  if (::mkdir(path.c_str(), 0755) == 0) return true;
  if (errno == EEXIST) return false;
  throw_file_error(path, "create folder", errno);
}

std::string run_name(const fs::path& case_file) {
  const fs::path full = fs::absolute(case_file / "").lexically_normal().parent_path();  // without a trailing slash
  std::error_code ignored;
  fs::path name = full.stem();
  if (fs::is_directory(full, ignored)) name = full.filename();
  if (full.filename() == "case.toml") name = full.parent_path().filename();
  return name.empty() ? "case" : name.string();
}

fs::path make_numbered_folder(const fs::path& case_file) {
  make_folders("runs");
  for (int n = 1;; ++n) {
    fs::path path = fs::path("runs") / (run_name(case_file) + '-' + std::to_string(n));
    if (make_folder(path)) return path;
  }
}

void make_wanted_folder(const fs::path& path) {
  if (path.has_parent_path()) make_folders(path.parent_path());
  if (make_folder(path)) return;
  if (!fs::is_directory(path))
    throw InputError("'" + path.string() + "' is a file; give a folder that does not exist yet");
  if (!fs::is_empty(path))
    throw InputError("folder '" + path.string() +
                     "' is not empty and results are never overwritten; choose another with -o");
}

}  // namespace

RunFolder RunFolder::create(const fs::path& case_file, const std::optional<fs::path>& wanted) {
  fs::path path = wanted ? *wanted : make_numbered_folder(case_file);
  if (path.filename().empty() && path.has_parent_path()) path = path.parent_path();  // "dir/"
  if (wanted) make_wanted_folder(path);
  const auto log_path = path / "log.txt";
  const int log = ::open(log_path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644);
  if (log < 0 && errno == EEXIST)
    throw InputError("folder '" + path.string() + "' was taken by another run at this moment; choose another with -o");
  if (log < 0) throw_file_error(log_path, "create", errno);
  ::flock(log, LOCK_EX | LOCK_NB);
  return RunFolder(path, log);
}

RunFolder RunFolder::open(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) throw InputError("there is no run folder '" + folder.string() + "'");
  for (const char* name : {"case.toml", "checkpoint.h5"})
    if (!fs::exists(folder / name, ignored))
      throw InputError("folder '" + folder.string() + "' holds no " + name + ", so there is no run to continue");
  const auto log_path = folder / "log.txt";
  const int log = ::open(log_path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (log < 0) throw_file_error(log_path, "write", errno);
  RunFolder opened(folder, log);
  if (::flock(log, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw InputError("another program is running in folder '" + folder.string() + "'; wait for it or stop it first");
  return opened;
}

RunFolder::RunFolder(RunFolder&& other) noexcept : path_(std::move(other.path_)), log_(std::exchange(other.log_, -1)) {}

RunFolder::~RunFolder() {
  if (log_ >= 0) ::close(log_);
}

void RunFolder::log(const std::string& text) {
  const std::string lines = text.ends_with('\n') ? text : text + '\n';
  [[maybe_unused]] const ssize_t written = ::write(log_, lines.data(), lines.size());
}

}  // namespace spume
