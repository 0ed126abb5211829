// SPDX-License-Identifier: MIT
// What a method tells of a run beside its fields: spectra, remarks, invariants.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "spume/core/array_info.hpp"
#include "spume/core/step_limit.hpp"
#include "spume/io/record_table.hpp"

namespace spume {

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
// s = factor max |scale column| + floor over the rows, or of what `scale` gives in its place, the value compared with
// the bound is
//   drift:   max |x(t) - x(0)| / |x(0)|
//   growth:  max (x(t) - x(0), 0) / s
//   change:  max |x(t) - x(0)| / s
//   largest: max |x(t)|, with a scale column max |x(t)| / |scale column(t)|
struct Invariant {
  enum class Kind { drift, growth, change, largest };
  std::string quantity;  // its name in summary.json
  Kind kind = Kind::largest;
  std::string column;
  double bound = 0;
  std::string scale_column = {};  // of growth, change and largest
  double scale_factor = 1, scale_floor = 0;
  // Of the present state; they live as long as the method.
  std::function<double()> beside = {};  // added to the column
  std::function<double()> scale = {};   // in place of the scale column of growth and change
};

}  // namespace spume
