// SPDX-License-Identifier: MIT
#include "spume/io/series.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/io/file.hpp"

namespace spume {
namespace {

constexpr std::size_t largest_wait_bytes = 64 * 1024;
constexpr std::chrono::seconds largest_wait{1};

std::string column_line(const std::vector<SeriesColumn>& columns) {
  std::string line;
  for (const auto& column : columns) line += (line.empty() ? "" : ",") + column.name;
  return line + '\n';
}

void append_number(std::string& text, double value) {
  // 0/0 has a sign on some machines.
  if (std::isnan(value)) {
    text += "nan";
    return;
  }
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

// The first column that only one of two lines of names has.
std::string column_difference(const std::string& found, const std::string& expected) {
  const auto first_missing = [](const std::string& in, const std::string& from) {
    std::istringstream names(in);
    for (std::string name; std::getline(names, name, ',');)
      if (("," + from + ",").find("," + name + ",") == std::string::npos) return name;
    return std::string();
  };
  if (const auto name = first_missing(expected, found); !name.empty()) return "it has no column '" + name + "'";
  if (const auto name = first_missing(found, expected); !name.empty())
    return "this program does not write its column '" + name + "'";
  return found == expected ? "its line of column names is incomplete" : "its columns are in another order";
}

}  // namespace

SeriesFile::SeriesFile(std::filesystem::path path, int descriptor, std::size_t columns, std::int64_t rows)
    : path_(std::move(path)),
      descriptor_(descriptor),
      columns_(columns),
      rows_(rows),
      flushed_(std::chrono::steady_clock::now()) {}

SeriesFile::SeriesFile(SeriesFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      columns_(other.columns_),
      rows_(other.rows_),
      waiting_(std::move(other.waiting_)),
      flushed_(other.flushed_) {}

SeriesFile::~SeriesFile() {
  if (descriptor_ < 0) return;
  try {
    flush();
  } catch (const FileError&) {
    // Whoever needs to know has called flush() before.
  }
  ::close(descriptor_);
}

SeriesFile SeriesFile::create(const std::filesystem::path& path, const std::string& title,
                              const std::vector<SeriesColumn>& columns) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor < 0) throw_file_error(path, "create", errno);
  SeriesFile file(path, descriptor, columns.size(), 0);
  file.waiting_ = "# " + title + '\n';
  for (const auto& column : columns)
    if (!column.unit.empty()) file.waiting_ += "# " + column.name + ": " + column.unit + '\n';
  file.waiting_ += column_line(columns);
  file.flush();
  return file;
}

SeriesFile SeriesFile::resume(const std::filesystem::path& path, const std::vector<SeriesColumn>& columns,
                              std::int64_t rows) {
  const std::string text = read_text(path);
  std::size_t at = 0;
  const auto line_end = [&] {
    const auto end = text.find('\n', at);
    return end == std::string::npos ? std::string::npos : end + 1;
  };
  while (at < text.size() && text[at] == '#' && line_end() != std::string::npos) at = line_end();
  const std::string names = column_line(columns);
  if (text.compare(at, names.size(), names) != 0) {
    const std::string found = text.substr(at, text.find('\n', at) - at), expected = names.substr(0, names.size() - 1);
    throw FileError("cannot continue '" + path.string() + "': " + column_difference(found, expected) +
                    "; resume with the program version named in log.txt, or run its case.toml again");
  }
  at += names.size();
  for (std::int64_t row = 0; row < rows; ++row) {
    if (at >= text.size() || line_end() == std::string::npos)
      throw FileError("cannot continue '" + path.string() + "': it holds " + std::to_string(row) +
                      " rows, the checkpoint was made after " + std::to_string(rows));
    at = line_end();
  }
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0) throw_file_error(path, "write", errno);
  SeriesFile file(path, descriptor, columns.size(), rows);
  if (::ftruncate(descriptor, static_cast<off_t>(at)) != 0) throw_file_error(path, "cut", errno);
  return file;
}

void SeriesFile::row(std::span<const double> before, std::string_view word, std::span<const double> after) {
  if (before.size() + (word.empty() ? 0 : 1) + after.size() != columns_)
    throw std::logic_error("a row of " + path_.string() + " does not have one value per column");
  const auto start = waiting_.size();
  const auto separate = [&] {
    if (waiting_.size() > start) waiting_ += ',';
  };
  for (const double value : before) separate(), append_number(waiting_, value);
  if (!word.empty()) separate(), waiting_ += word;
  for (const double value : after) separate(), append_number(waiting_, value);
  waiting_ += '\n';
  ++rows_;
  if (waiting_.size() > largest_wait_bytes || std::chrono::steady_clock::now() - flushed_ > largest_wait) flush();
}

void SeriesFile::flush() {
  std::size_t done = 0;
  while (done < waiting_.size()) {
    const ssize_t written = ::write(descriptor_, waiting_.data() + done, waiting_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int reason = errno;
      waiting_.erase(0, done);
      throw_file_error(path_, "write", reason);
    }
    done += static_cast<std::size_t>(written);
  }
  waiting_.clear();
  flushed_ = std::chrono::steady_clock::now();
}

void SeriesFile::sync() {
  flush();
  // A pipe or /dev/full cannot be synced; that is no loss of data.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) throw_file_error(path_, "write", errno);
}

}  // namespace spume
