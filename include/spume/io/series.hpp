// SPDX-License-Identifier: MIT
// A table that grows by rows: '#' lines with the units, one line of column names, then rows. Numbers are
// written with the fewest digits (at most 17) that read back to the same bits.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace spume {

struct SeriesColumn {
  std::string name;
  std::string unit;  // "1" without dimension; empty for a column of words
};

// Every member throws FileError with the file and the system's reason. Rows reach the file when it is flushed
// or closed, when a row arrives more than a second after the last flush, or when 64 kB are waiting.
class SeriesFile {
 public:
  // Creates the file; refuses one that exists.
  static SeriesFile create(const std::filesystem::path& path, const std::string& title,
                           const std::vector<SeriesColumn>& columns);
  // Opens an existing file, keeps its first `rows` rows and cuts the rest. Throws FileError when the column
  // names differ or fewer rows are there.
  static SeriesFile resume(const std::filesystem::path& path, const std::vector<SeriesColumn>& columns,
                           std::int64_t rows);

  SeriesFile(SeriesFile&& other) noexcept;
  SeriesFile& operator=(SeriesFile&& other) = delete;
  ~SeriesFile();  // writes what is waiting as far as that is possible

  void row(std::span<const double> values) { row({}, {}, values); }
  // A row with a word in it: the numbers before, the word, the numbers after.
  void row(std::span<const double> before, std::string_view word, std::span<const double> after);
  void flush();
  void sync();  // flush, and wait until the disk has it
  std::int64_t rows() const { return rows_; }

 private:
  SeriesFile(std::filesystem::path path, int descriptor, std::size_t columns, std::int64_t rows);
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::size_t columns_ = 0;
  std::int64_t rows_ = 0;
  std::string waiting_;
  std::chrono::steady_clock::time_point flushed_;
};

}  // namespace spume
