// SPDX-License-Identifier: MIT
// What a method tells of a run beside its fields: step limit, memory, tables, remarks, invariants.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "spume/io/series.hpp"

namespace spume {

// One array of the state, for `spume check`: exists only because an active stage names it.
struct ArrayInfo {
  std::string name;
  double bytes = 0;
  std::size_t suspended = 0;  // particles in a flow on a grid that it belongs to; 0: it belongs to the liquid or grid
};

// The step a method would take next, and what limits it ("courant", "viscous", "capillary").
struct StepLimit {
  double dt = 0;
  std::string limited_by;
};

// A table beside series.csv, written to <name>.csv under "# <title of the case>: <title>". Its first column is the
// time. The file begins with the first row.
struct RecordTable {
  enum class When { series, output, spectrum };  // with every row of series.csv, at output times, at times of spectra
  std::string name, title;
  std::vector<SeriesColumn> columns;
  When when = When::output;
};

// spectrum.csv: the energy spectrum E(k) with the columns t, wavenumber, energy; and its rows of one time.
RecordTable spectrum_table();
void add_spectrum(double t, std::span<const double> wavenumber, std::span<const double> energy,
                  std::vector<double>& rows);

// What is to be known of the run as it stands, in words. The log keeps every remark.
struct Remark {
  std::string text;
  bool log_only = false;  // else whoever watches the run gets it as well
};

// A statement about a column of series.csv that holds for a whole run whatever its solution, so that no reference is
// needed to judge it: what summary.json gives as a verdict. With x(t) the column, and what lies beside it, and
// s = max |scale column| + floor over the rows, the value held against the bound is
//   drift:   max |x(t) - x(0)| / |x(0)|
//   growth:  max (x(t) - x(0), 0) / s
//   largest: max |x(t)|
struct Invariant {
  enum class Kind { drift, growth, largest };
  std::string quantity;  // its name in summary.json
  Kind kind = Kind::largest;
  std::string column;
  double bound = 0;
  std::string scale_column = {};  // of growth
  double scale_floor = 0;
  std::function<double()> beside = {};  // of the present state, added to the column; lives as long as the method
};

}  // namespace spume
