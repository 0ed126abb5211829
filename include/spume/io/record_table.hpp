// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "spume/io/series.hpp"

namespace spume {

// A table beside series.csv that a method fills itself, written to <name>.csv.
struct RecordTable {
  std::string name, title;
  std::vector<SeriesColumn> columns;
  bool with_series = false;  // filled with every row of series.csv; else at output times
};

}  // namespace spume
