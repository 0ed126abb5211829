// SPDX-License-Identifier: MIT
#include "spume/run/verdicts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

std::size_t index_of(const std::string& name, const std::vector<SeriesColumn>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == name) return i;
  throw std::logic_error("an invariant is about '" + name + "', which is no column of the series");
}

// 0 / 0 is no change at all.
double relative(double change, double scale) {
  return change == 0 ? 0 : change / scale;
}

constexpr std::size_t numbers_seen = 4;

}  // namespace

InvariantWatch::InvariantWatch(std::vector<Invariant> invariants, const std::vector<SeriesColumn>& columns) {
  for (Invariant& one : invariants) {
    const std::size_t column = index_of(one.column, columns);
    const std::size_t scale = one.scale_column.empty() ? column : index_of(one.scale_column, columns);
    watched_.push_back({std::move(one), column, scale});
  }
}

void InvariantWatch::observe(std::span<const double> row) {
  for (Watched& w : watched_) {
    const double scale = std::abs(w.invariant.scale ? w.invariant.scale() : row[w.scale]);
    const double column = row[w.column] + (w.invariant.beside ? w.invariant.beside() : 0.0);
    const bool row_by_row = w.invariant.kind == Invariant::Kind::largest && w.scale != w.column;
    const double value = row_by_row ? relative(column, scale) : column;
    if (!started_) w.first = w.least = w.most = value, w.largest_scale = scale;
    w.most = larger_or_nan(w.most, value);
    w.least = -larger_or_nan(-w.least, -value);
    w.largest_scale = larger_or_nan(w.largest_scale, scale);
  }
  started_ = true;
}

double InvariantWatch::scale_of(const Watched& w) {
  return w.invariant.scale_factor * w.largest_scale + w.invariant.scale_floor;
}

std::vector<Verdict> InvariantWatch::verdicts() const {
  std::vector<Verdict> verdicts;
  for (const Watched& w : watched_) {
    double value = std::numeric_limits<double>::quiet_NaN();
    switch (w.invariant.kind) {
      case Invariant::Kind::drift:
        value = relative(larger_or_nan(w.most - w.first, w.first - w.least), std::abs(w.first));
        break;
      case Invariant::Kind::growth:
        value = relative(larger_or_nan(w.most - w.first, 0), scale_of(w));
        break;
      case Invariant::Kind::change:
        value = relative(larger_or_nan(w.most - w.first, w.first - w.least), scale_of(w));
        break;
      case Invariant::Kind::largest:
        value = larger_or_nan(w.most, -w.least) + 0.0;  // -0 of rows of 0 is 0
        break;
    }
    verdicts.push_back({w.invariant.quantity, value, w.invariant.bound});
  }
  return verdicts;
}

std::vector<double> InvariantWatch::seen() const {
  std::vector<double> numbers;
  if (!started_) return numbers;
  for (const Watched& w : watched_) numbers.insert(numbers.end(), {w.first, w.least, w.most, w.largest_scale});
  return numbers;
}

void InvariantWatch::restore(std::span<const double> seen) {
  if (seen.empty() || seen.size() != numbers_seen * watched_.size()) return;
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const auto numbers = seen.subspan(numbers_seen * i, numbers_seen);
    Watched& w = watched_[i];
    w.first = numbers[0], w.least = numbers[1], w.most = numbers[2], w.largest_scale = numbers[3];
  }
  started_ = true;
}

// A run that has one step in a hundred refused is badly set; one refused step is not a failure.
Verdict refused_steps(std::int64_t refused, std::int64_t steps) {
  return {"refused_steps", static_cast<double>(refused), std::max(1.0, static_cast<double>(steps) / 100)};
}

}  // namespace spume
