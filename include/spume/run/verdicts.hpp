// SPDX-License-Identifier: MIT
// Verdicts of a run that need no reference, for summary.json: the invariants of its method, watched at the rows of
// series.csv over the whole run, resumed runs included, and how many steps were refused.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "spume/io/series.hpp"
#include "spume/methods/method.hpp"

namespace spume {

struct Verdict {
  std::string quantity;
  double value = 0, bound = 0;
  bool pass() const { return value <= bound; }  // not for a value that is not a number
};

class InvariantWatch {
 public:
  // Throws std::logic_error when an invariant names a column that is not there.
  InvariantWatch(std::vector<Invariant> invariants, const std::vector<SeriesColumn>& columns);

  void observe(std::span<const double> row);  // one value per column
  std::vector<Verdict> verdicts() const;      // in the order of the invariants

  // What was seen so far, for the checkpoint. What another program version saw of other invariants is forgotten.
  std::vector<double> seen() const;
  void restore(std::span<const double> seen);

 private:
  struct Watched {
    Invariant invariant;
    std::size_t column = 0, scale = 0;
    double first = 0, least = 0, most = 0, largest_scale = 0;
  };
  static double scale_of(const Watched& w);
  std::vector<Watched> watched_;
  bool started_ = false;
};

// One step in a hundred may be refused, and one in any run: refusals are part of how the step is chosen.
Verdict refused_steps(std::int64_t refused, std::int64_t steps);

}  // namespace spume
