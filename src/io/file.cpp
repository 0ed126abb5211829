// SPDX-License-Identifier: MIT
#include "spume/io/file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "spume/core/error.hpp"

namespace spume {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  operator int() const { return value_; }

 private:
  int value_;
};

void sync_folder_of(const std::filesystem::path& path) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems refuse to sync a folder; the rename itself has then still happened.
  if (descriptor >= 0) ::fsync(descriptor);
}

// Why the file cannot grow from `size` by `bytes`, as an error number; 0 when it can.
int refusal(int descriptor, off_t size, std::int64_t bytes) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      static_cast<rlim_t>(size + bytes) > limit.rlim_cur)
    return EFBIG;
  if (::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, size, bytes) == 0) return 0;
  const int reason = errno;
  if (reason == ENOSPC || reason == EDQUOT) {
    // Blocks that were found before the disk was full are given back.
    [[maybe_unused]] const int result = ::ftruncate(descriptor, size);
    return reason;
  }
  struct statvfs system {};
  const bool known = ::fstatvfs(descriptor, &system) == 0;
  return known && system.f_bavail * system.f_frsize < static_cast<std::uint64_t>(bytes) ? ENOSPC : 0;
}

}  // namespace

void throw_file_error(const std::filesystem::path& path, std::string_view action, int error_number) {
  throw FileError("cannot " + std::string(action) + " '" + path.string() + "': " + std::strerror(error_number));
}

std::string read_text(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) throw_file_error(path, "read", EISDIR);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw_file_error(path, "open", errno != 0 ? errno : EIO);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) throw_file_error(path, "read", errno != 0 ? errno : EIO);
  return text;
}

void sync_and_rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  {
    const Descriptor descriptor(::open(from.c_str(), O_RDONLY | O_CLOEXEC));
    if (descriptor < 0 || ::fsync(descriptor) != 0) throw_file_error(from, "write", errno);
  }
  if (::rename(from.c_str(), to.c_str()) != 0) throw_file_error(to, "rename to", errno);
  sync_folder_of(to);
}

void write_text_atomically(const std::filesystem::path& path, std::string_view text) {
  const std::filesystem::path temporary = path.string() + ".part";
  try {
    {
      const Descriptor descriptor(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
      if (descriptor < 0) throw_file_error(path, "create", errno);
      for (std::size_t done = 0; done < text.size();) {
        const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw_file_error(path, "write", errno);
        done += static_cast<std::size_t>(written);
      }
    }
    sync_and_rename(temporary, path);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
}

ReservedSpace::ReservedSpace(std::filesystem::path path, std::int64_t bytes) : path_(std::move(path)) {
  const Descriptor descriptor(::open(path_.c_str(), O_WRONLY | O_CLOEXEC));
  if (descriptor < 0) throw_file_error(path_, "write", errno);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) throw_file_error(path_, "write", errno);
  if (const int reason = refusal(descriptor, status.st_size, bytes); reason != 0)
    throw_file_error(path_, "write", reason);
}

ReservedSpace::~ReservedSpace() {
  // Truncating a file to its own size releases the blocks past its end.
  const Descriptor descriptor(::open(path_.c_str(), O_WRONLY | O_CLOEXEC));
  struct stat status {};
  if (descriptor >= 0 && ::fstat(descriptor, &status) == 0) {
    [[maybe_unused]] const int result = ::ftruncate(descriptor, status.st_size);
  }
}

}  // namespace spume
