// SPDX-License-Identifier: MIT
// The rows of series.csv so far, thinned so that their number stays bounded: of a run of any length every so many rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace spume {

class SeriesHistory {
 public:
  explicit SeriesHistory(std::size_t most_rows = 4000) : most_rows_(most_rows) {}

  void add(std::span<const double> row);
  void clear();

  std::size_t rows() const { return width_ == 0 ? 0 : values_.size() / width_; }
  std::span<const double> row(std::size_t k) const { return std::span(values_).subspan(k * width_, width_); }
  // Changes when rows were taken out: who has read some of them reads all of them again.
  std::int64_t edition() const { return edition_; }

 private:
  std::size_t most_rows_;
  std::size_t width_ = 0;
  std::size_t stride_ = 1;   // rows that came per row that is kept
  std::size_t waiting_ = 0;  // rows that came since the last one kept
  std::int64_t edition_ = 0;
  std::vector<double> values_;
};

}  // namespace spume
