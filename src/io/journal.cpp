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
#include <optional>
#include <string>
#include <string_view>

#include "spume/io/file.hpp"

namespace spume::hdf5 {
namespace {

constexpr haddr_t page_bytes = 4096;
constexpr std::string_view mark("SPUME JOURNAL 1\0", 16);

// Functions that return int give 0, or the error number of the system.

int read_at(int descriptor, haddr_t address, std::size_t size, char* out) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t got = ::pread(descriptor, out + done, size - done, static_cast<off_t>(address + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    if (got == 0) {  // beyond the end a file holds zeros
      std::memset(out + done, 0, size - done);
      return 0;
    }
    done += static_cast<std::size_t>(got);
  }
  return 0;
}

int write_at(int descriptor, haddr_t address, std::string_view data) {
  while (!data.empty()) {
    const ssize_t put = ::pwrite(descriptor, data.data(), data.size(), static_cast<off_t>(address));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return errno;
    data.remove_prefix(static_cast<std::size_t>(put));
    address += static_cast<haddr_t>(put);
  }
  return 0;
}

int set_size(int descriptor, haddr_t size) {
  return ::ftruncate(descriptor, static_cast<off_t>(size)) == 0 ? 0 : errno;
}

// Parts of a file as they will be, by address, and its size then.
struct Change {
  haddr_t bytes = 0;
  std::map<haddr_t, std::string> parts;

  int apply(int descriptor) const {
    for (const auto& [address, part] : parts)
      if (const int reason = write_at(descriptor, address, part); reason != 0) return reason;
    return set_size(descriptor, bytes);
  }
};

// A change as the text of a journal: the mark, crc32 and size of what follows, the size of the file, then address, size
// and bytes of each part.
template <class Number>
void put(std::string& text, Number number) {
  text.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <class Number>
Number take(std::string_view& text) {
  Number number = 0;
  std::memcpy(&number, text.data(), sizeof number);
  text.remove_prefix(sizeof number);
  return number;
}

std::uint32_t sum_of(std::string_view text) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
  return static_cast<std::uint32_t>(::crc32_z(::crc32(0, nullptr, 0), bytes, text.size()));
}

std::string text_of(const Change& change) {
  std::string body, text(mark);
  put<std::uint64_t>(body, change.bytes);
  for (const auto& [address, part] : change.parts) {
    put<std::uint64_t>(body, address);
    put<std::uint64_t>(body, part.size());
    body += part;
  }
  put(text, sum_of(body));
  put<std::uint64_t>(text, body.size());
  return text + body;
}

// Nothing for a journal that is not whole: of such a one nothing has been copied.
std::optional<Change> change_of(std::string_view text) {
  constexpr std::size_t number = sizeof(std::uint64_t);
  if (!text.starts_with(mark) || text.size() < mark.size() + sizeof(std::uint32_t) + 2 * number) return {};
  text.remove_prefix(mark.size());
  const auto sum = take<std::uint32_t>(text);
  const auto bytes = take<std::uint64_t>(text);
  if (bytes != text.size() || sum != sum_of(text)) return {};
  Change change{take<std::uint64_t>(text), {}};
  while (text.size() >= 2 * number) {
    const auto address = take<std::uint64_t>(text);
    const auto size = take<std::uint64_t>(text);
    change.parts[address] = text.substr(0, size);
    text.remove_prefix(std::min<std::size_t>(size, text.size()));
  }
  return change;
}

std::string journal_of(const std::string& path) {
  return path + ".journal";
}

int write_journal(const std::string& path, const Change& change) {
  const std::string temporary = journal_of(path) + ".part";
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) return errno;
  int reason = write_at(descriptor, 0, text_of(change));
  if (::close(descriptor) != 0 && reason == 0) reason = errno;
  if (reason == 0 && ::rename(temporary.c_str(), journal_of(path).c_str()) != 0) reason = errno;
  if (reason != 0) ::unlink(temporary.c_str());
  return reason;
}

// What HDF5 holds of an open file. The library's part comes first.
struct OpenFile {
  H5FD_t library{};
  std::string path;
  int descriptor = -1;
  haddr_t settled = 0;  // bytes of the file when it was opened
  haddr_t end = 0;      // largest address written
  int failed = 0;       // the reason of a write that failed: the file stays as it was
  Change change;        // pages below `settled`; the size is what HDF5 has allocated
};

OpenFile& of(H5FD_t* file) {
  return *reinterpret_cast<OpenFile*>(file);
}
const OpenFile& of(const H5FD_t* file) {
  return *reinterpret_cast<const OpenFile*>(file);
}

// Tells the library why, in the words in which its own drivers do.
herr_t result(int reason) {
  if (reason == 0) return 0;
  H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_VFL, H5E_WRITEERROR,
           "errno = %d, error message = '%s'", reason, std::strerror(reason));
  return -1;
}

H5FD_t* open_file(const char* name, unsigned, hid_t, haddr_t) {
  auto file = std::make_unique<OpenFile>();
  file->path = name;
  file->descriptor = ::open(name, O_RDWR | O_CLOEXEC);
  if (file->descriptor < 0) return result(errno), nullptr;
  const off_t size = ::lseek(file->descriptor, 0, SEEK_END);
  if (size < 0) {
    result(errno);
    ::close(file->descriptor);
    return nullptr;
  }
  file->settled = file->end = static_cast<haddr_t>(size);
  return &file.release()->library;
}

int settle(const OpenFile& file) {
  int reason = file.failed;
  if (reason == 0) reason = write_journal(file.path, file.change);
  if (reason != 0) {
    set_size(file.descriptor, file.settled);
    return reason;
  }
  reason = file.change.apply(file.descriptor);
  if (reason == 0) ::unlink(journal_of(file.path).c_str());
  return reason;
}

herr_t close_file(H5FD_t* library) {
  const std::unique_ptr<OpenFile> file(&of(library));
  int reason = settle(*file);
  if (::close(file->descriptor) != 0 && reason == 0) reason = errno;
  return result(reason);
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  if (flags != nullptr)
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t end_of_allocation(const H5FD_t* file, H5FD_mem_t) {
  return of(file).change.bytes;
}
herr_t set_end_of_allocation(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  of(file).change.bytes = address;
  return 0;
}
haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) {
  return of(file).end;
}

herr_t read_file(H5FD_t* library, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* buffer) {
  const OpenFile& file = of(library);
  auto* out = static_cast<char*>(buffer);
  if (const int reason = read_at(file.descriptor, address, size, out); reason != 0) return result(reason);
  const haddr_t end = std::min(address + size, file.settled);
  for (haddr_t page = address / page_bytes * page_bytes; page < end; page += page_bytes) {
    const auto changed = file.change.parts.find(page);
    if (changed == file.change.parts.end()) continue;
    const haddr_t from = std::max(page, address), to = std::min(page + page_bytes, end);
    std::memcpy(out + (from - address), changed->second.data() + (from - page), to - from);
  }
  return 0;
}

// What lies below the settled end goes to pages, read from the file where they are new; the rest goes to the file.
int write_parts(OpenFile& file, haddr_t address, std::string_view data) {
  while (!data.empty() && address < file.settled) {
    const haddr_t page = address / page_bytes * page_bytes, end = std::min(page + page_bytes, file.settled);
    auto [changed, fresh] = file.change.parts.try_emplace(page, end - page, '\0');
    if (fresh)
      if (const int reason = read_at(file.descriptor, page, end - page, changed->second.data()); reason != 0)
        return reason;
    const std::string_view here = data.substr(0, end - address);
    here.copy(changed->second.data() + (address - page), here.size());
    data.remove_prefix(here.size());
    address += here.size();
  }
  file.end = std::max(file.end, address + data.size());
  return write_at(file.descriptor, address, data);
}

herr_t write_file(H5FD_t* library, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, const void* buffer) {
  OpenFile& file = of(library);
  const int reason = write_parts(file, address, {static_cast<const char*>(buffer), size});
  if (reason != 0) file.failed = reason;
  return result(reason);
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
  if (!std::filesystem::is_regular_file(name)) return;
  if (const auto change = change_of(spume::read_text(name))) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0) throw_file_error(path, "write", errno);
    const int reason = change->apply(descriptor);
    ::close(descriptor);
    if (reason != 0) throw_file_error(path, "complete", reason);
  }
  ::unlink(name.c_str());
}

void remove_with_journal(const std::filesystem::path& path) {
  ::unlink(path.c_str());
  ::unlink(journal_of(path.string()).c_str());
}

}  // namespace spume::hdf5
