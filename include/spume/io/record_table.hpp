// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "spume/io/series.hpp"

namespace spume {

// A table beside series.csv, written to <name>.csv under "# <title of the case>: <title>". Its first column is the
// time. The file begins with the first row.
struct RecordTable {
  enum class When { series, output, spectrum };  // with every row of series.csv, at output times, at times of spectra
  std::string name, title;
  std::vector<SeriesColumn> columns;
  When when = When::output;
};

}  // namespace spume
