// SPDX-License-Identifier: MIT
#include "spume/io/journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "spume/core/error.hpp"
#include "spume/io/file.hpp"

namespace spume::hdf5 {
namespace {

constexpr haddr_t page_bytes = 4096;
constexpr char mark[16] = "SPUME JOURNAL 1";

bool read_at(int descriptor, haddr_t address, std::size_t size, unsigned char* out) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t got = ::pread(descriptor, out + done, size - done, static_cast<off_t>(address + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return false;
    if (got == 0) {  // beyond the end a file holds zeros
      std::memset(out + done, 0, size - done);
      return true;
    }
    done += static_cast<std::size_t>(got);
  }
  return true;
}

bool write_at(int descriptor, haddr_t address, std::size_t size, const unsigned char* data) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t put = ::pwrite(descriptor, data + done, size - done, static_cast<off_t>(address + done));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    done += static_cast<std::size_t>(put);
  }
  return true;
}

struct Journal {
  std::uint64_t final_bytes = 0;                          // size of the file after the change
  std::map<haddr_t, std::vector<unsigned char>> changes;  // by address
};

std::string journal_of(const std::string& path) {
  return path + ".journal";
}

void add(std::vector<unsigned char>& out, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  out.insert(out.end(), bytes, bytes + size);
}

std::uint32_t sum_of(const std::vector<unsigned char>& text) {
  return static_cast<std::uint32_t>(::crc32_z(::crc32(0, nullptr, 0), text.data(), text.size()));
}

// False with errno set. mark, crc32 of what follows, size of what follows, final size, then address, size and bytes of
// each change.
bool write_journal(const Journal& journal, const std::string& path) {
  std::vector<unsigned char> body, text;
  add(body, &journal.final_bytes, sizeof journal.final_bytes);
  for (const auto& [address, bytes] : journal.changes) {
    const std::uint64_t head[2] = {address, bytes.size()};
    add(body, head, sizeof head);
    add(body, bytes.data(), bytes.size());
  }
  const std::uint64_t size = body.size();
  const std::uint32_t sum = sum_of(body);
  add(text, mark, sizeof mark);
  add(text, &sum, sizeof sum);
  add(text, &size, sizeof size);
  add(text, body.data(), body.size());
  const std::string temporary = journal_of(path) + ".part";
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) return false;
  bool good = write_at(descriptor, 0, text.size(), text.data());
  int reason = errno;
  if (::close(descriptor) != 0 && good) {
    good = false;
    reason = errno;
  }
  if (good && ::rename(temporary.c_str(), journal_of(path).c_str()) == 0) return true;
  if (good) reason = errno;
  ::unlink(temporary.c_str());
  errno = reason;
  return false;
}

// False: the journal is not whole, so that nothing of it has been copied.
bool read_journal(int descriptor, Journal& journal) {
  struct stat status {};
  constexpr std::size_t head = sizeof mark + sizeof(std::uint32_t) + sizeof(std::uint64_t);
  if (::fstat(descriptor, &status) != 0 || static_cast<std::size_t>(status.st_size) < head + 8) return false;
  std::vector<unsigned char> text(static_cast<std::size_t>(status.st_size));
  if (!read_at(descriptor, 0, text.size(), text.data())) return false;
  std::uint32_t sum = 0;
  std::uint64_t size = 0;
  std::memcpy(&sum, &text[sizeof mark], sizeof sum);
  std::memcpy(&size, &text[sizeof mark + sizeof sum], sizeof size);
  if (std::memcmp(text.data(), mark, sizeof mark) != 0 || size != text.size() - head) return false;
  text.erase(text.begin(), text.begin() + head);
  if (sum_of(text) != sum) return false;
  std::memcpy(&journal.final_bytes, text.data(), sizeof journal.final_bytes);
  for (std::size_t at = sizeof journal.final_bytes; at + 16 <= text.size();) {
    std::uint64_t entry[2];
    std::memcpy(entry, &text[at], sizeof entry);
    at += sizeof entry;
    if (entry[1] > text.size() - at) return false;
    journal.changes[entry[0]].assign(&text[at], &text[at] + entry[1]);
    at += entry[1];
  }
  return true;
}

bool copy_changes(int descriptor, const Journal& journal) {
  for (const auto& [address, bytes] : journal.changes)
    if (!write_at(descriptor, address, bytes.size(), bytes.data())) return false;
  return ::ftruncate(descriptor, static_cast<off_t>(journal.final_bytes)) == 0;
}

// What HDF5 holds of an open file. The library's part comes first.
struct OpenFile {
  H5FD_t library{};
  std::string path;
  int descriptor = -1;
  haddr_t end_of_allocation = 0;
  haddr_t settled = 0;  // bytes of the file when it was opened
  haddr_t end = 0;      // largest address written
  bool writable = false;
  int failed = 0;  // the reason of a write that failed: the file stays as it was
  std::map<haddr_t, std::vector<unsigned char>> pages;
};

OpenFile& of(H5FD_t* file) {
  return *reinterpret_cast<OpenFile*>(file);
}
const OpenFile& of(const H5FD_t* file) {
  return *reinterpret_cast<const OpenFile*>(file);
}

H5FD_t* open_file(const char* name, unsigned flags, hid_t, haddr_t) {
  auto file = std::make_unique<OpenFile>();
  file->writable = (flags & H5F_ACC_RDWR) != 0;
  if ((flags & (H5F_ACC_TRUNC | H5F_ACC_CREAT)) != 0) return nullptr;
  file->path = name;
  file->descriptor = ::open(name, (file->writable ? O_RDWR : O_RDONLY) | O_CLOEXEC);
  struct stat status {};
  if (file->descriptor < 0) return nullptr;
  if (::fstat(file->descriptor, &status) != 0) {
    ::close(file->descriptor);
    return nullptr;
  }
  file->settled = file->end = static_cast<haddr_t>(status.st_size);
  return &file.release()->library;
}

// Tells the library why, in the words in which its own drivers do.
void report(int reason) {
  H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_VFL, H5E_WRITEERROR,
           "errno = %d, error message = '%s'", reason, std::strerror(reason));
}

bool settle(OpenFile& file) {
  if (!file.writable) return true;
  if (file.failed != 0) {
    [[maybe_unused]] const int result = ::ftruncate(file.descriptor, static_cast<off_t>(file.settled));
    return false;
  }
  Journal journal;
  journal.final_bytes = file.end_of_allocation;
  for (const auto& [address, bytes] : file.pages) {
    const haddr_t here = std::min(page_bytes, file.settled - address);
    journal.changes[address].assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(here));
  }
  if (journal.changes.empty()) return ::ftruncate(file.descriptor, static_cast<off_t>(journal.final_bytes)) == 0;
  if (!write_journal(journal, file.path)) {
    file.failed = errno;
    [[maybe_unused]] const int result = ::ftruncate(file.descriptor, static_cast<off_t>(file.settled));
    return false;
  }
  if (!copy_changes(file.descriptor, journal)) return false;
  ::unlink(journal_of(file.path).c_str());
  return true;
}

herr_t close_file(H5FD_t* library) {
  std::unique_ptr<OpenFile> file(&of(library));
  bool good = settle(*file);
  int reason = file->failed != 0 ? file->failed : errno;
  if (::close(file->descriptor) != 0 && good) {
    good = false;
    reason = errno;
  }
  if (!good) report(reason);
  return good ? 0 : -1;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  struct stat one {
  }, two{};
  if (::fstat(of(a).descriptor, &one) != 0 || ::fstat(of(b).descriptor, &two) != 0) return -1;
  if (one.st_dev != two.st_dev) return one.st_dev < two.st_dev ? -1 : 1;
  return one.st_ino < two.st_ino ? -1 : one.st_ino > two.st_ino ? 1 : 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  if (flags != nullptr)
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t end_of_allocation(const H5FD_t* file, H5FD_mem_t) {
  return of(file).end_of_allocation;
}
herr_t set_end_of_allocation(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  of(file).end_of_allocation = address;
  return 0;
}
haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) {
  return of(file).end;
}

herr_t read_file(H5FD_t* library, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* buffer) {
  OpenFile& file = of(library);
  auto* out = static_cast<unsigned char*>(buffer);
  if (!read_at(file.descriptor, address, size, out)) return -1;
  const haddr_t last = std::min(address + size, file.settled);
  for (haddr_t page = address / page_bytes * page_bytes; page < last; page += page_bytes) {
    const auto changed = file.pages.find(page);
    if (changed == file.pages.end()) continue;
    const haddr_t from = std::max(page, address), to = std::min(page + page_bytes, last);
    std::memcpy(out + (from - address), changed->second.data() + (from - page), to - from);
  }
  return 0;
}

herr_t fail(OpenFile& file) {
  file.failed = errno;
  report(file.failed);
  return -1;
}

herr_t write_file(H5FD_t* library, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, const void* buffer) {
  OpenFile& file = of(library);
  const auto* data = static_cast<const unsigned char*>(buffer);
  const haddr_t end = address + size, old = std::min(end, file.settled);
  for (haddr_t from = address; from < old;) {
    const haddr_t page = from / page_bytes * page_bytes, to = std::min(page + page_bytes, old);
    auto [changed, fresh] = file.pages.try_emplace(page, page_bytes);
    if (fresh && !read_at(file.descriptor, page, page_bytes, changed->second.data())) return fail(file);
    std::memcpy(changed->second.data() + (from - page), data + (from - address), to - from);
    from = to;
  }
  const haddr_t from = std::max(address, file.settled);
  if (from < end && !write_at(file.descriptor, from, end - from, data + (from - address))) return fail(file);
  file.end = std::max(file.end, end);
  return 0;
}

// Sizes are set when the file is settled.
herr_t leave(H5FD_t*, hid_t, hbool_t) {
  return 0;
}

hid_t driver() {
  static const hid_t id = [] {
    H5FD_class_t table{};
    table.name = "spume-journal";
    table.maxaddr = static_cast<haddr_t>(INT64_MAX);
    table.fc_degree = H5F_CLOSE_WEAK;
    table.open = open_file;
    table.close = close_file;
    table.cmp = compare;
    table.query = query;
    table.get_eoa = end_of_allocation;
    table.set_eoa = set_end_of_allocation;
    table.get_eof = end_of_file;
    table.read = read_file;
    table.write = write_file;
    table.flush = leave;
    table.truncate = leave;
    const H5FD_mem_t kinds[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(kinds), std::end(kinds), std::begin(table.fl_map));
    return H5FDregister(&table);
  }();
  return id;
}

}  // namespace

void use_journal(hid_t access) {
  H5Pset_driver(access, driver(), nullptr);
}

void replay_journal(const std::filesystem::path& path) {
  const std::string name = journal_of(path.string());
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  Journal journal;
  const bool whole = read_journal(descriptor, journal);
  ::close(descriptor);
  if (whole) {
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (file < 0) throw_file_error(path, "write", errno);
    const bool good = copy_changes(file, journal);
    const int reason = errno;
    ::close(file);
    if (!good) throw_file_error(path, "complete", reason);
  }
  ::unlink(name.c_str());
}

void remove_with_journal(const std::filesystem::path& path) {
  ::unlink(path.c_str());
  ::unlink(journal_of(path.string()).c_str());
}

}  // namespace spume::hdf5
