// SPDX-License-Identifier: MIT
#include "time_table.hpp"

#include <algorithm>
#include <boost/math/interpolators/makima.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <vector>

namespace spume {
namespace {

class Interpolated final : public Expression {
 public:
  using Values = std::shared_ptr<const std::vector<double>>;
  Interpolated(Values times, Values values) : times_(std::move(times)), values_(std::move(values)) {}
  double operator()(double, double, double, double t) const override {
    const std::vector<double>&x = *times_, &y = *values_;
    const auto after = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), t) - x.begin());
    if (after == 0) return y.front();
    if (after == x.size()) return y.back();
    return y[after - 1] + (y[after] - y[after - 1]) * (t - x[after - 1]) / (x[after] - x[after - 1]);
  }
  std::unique_ptr<Expression> clone() const override { return std::make_unique<Interpolated>(*this); }

 private:
  Values times_, values_;
};

class Smooth final : public Expression {
 public:
  using Interpolator = boost::math::interpolators::makima<std::vector<double>>;
  Smooth(const std::vector<double>& times, const std::vector<double>& values)
      : first_(times.front()),
        last_(times.back()),
        value_(std::make_shared<const Interpolator>(std::vector<double>(times), std::vector<double>(values))) {}
  double operator()(double, double, double, double t) const override { return (*value_)(std::clamp(t, first_, last_)); }
  std::unique_ptr<Expression> clone() const override { return std::make_unique<Smooth>(*this); }

 private:
  double first_, last_;
  std::shared_ptr<const Interpolator> value_;
};

// What the interpolation needs, with both ends included.
constexpr std::size_t least_smooth_rows = 4;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else if (c != '\r')
      cells.back() += c;
  }
  for (std::string& cell : cells) {
    const auto first = cell.find_first_not_of(" \t");
    cell = first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(" \t") - first + 1);
  }
  return cells;
}

}  // namespace

TimeTable read_time_table(const std::string& file, TableValues values) {
  TimeTable table;
  std::ifstream in(file);
  if (!in) return {{}, "cannot read '" + file + "'"};
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::vector<std::string> cells = split(line);
    if ((cells.size() == 1 && cells[0].empty()) || cells[0].starts_with("#")) continue;
    const std::string place = "line " + std::to_string(number) + " of '" + file + "' ";
    if (names.empty()) {
      names = cells;
      columns.resize(names.size());
      if (names[0] != "t" || names.size() < 2)
        return {{}, place + "must name the columns, the first of them t, and has '" + line + "'"};
      continue;
    }
    if (cells.size() != names.size())
      return {
          {},
          place + "has " + std::to_string(cells.size()) + " values for " + std::to_string(names.size()) + " columns"};
    for (std::size_t k = 0; k < cells.size(); ++k) {
      char* end = nullptr;
      const double value = std::strtod(cells[k].c_str(), &end);
      if (cells[k].empty() || *end != '\0' || !std::isfinite(value))
        return {{}, place + "has '" + cells[k] + "', which is no number"};
      columns[k].push_back(value);
    }
    if (columns[0].size() > 1 && !(columns[0].back() > columns[0][columns[0].size() - 2]))
      return {{}, place + "has a time that does not come after the one before"};
  }
  if (columns.empty() || columns[0].empty()) return {{}, "'" + file + "' has no rows of numbers"};
  if (values == TableValues::smooth) {
    if (columns[0].size() < least_smooth_rows)
      return {{}, "'" + file + "' has " + std::to_string(columns[0].size()) + " rows, and a smooth motion needs 4"};
    for (std::size_t k = 1; k < names.size(); ++k)
      table.columns[names[k]] = std::make_shared<Smooth>(columns[0], columns[k]);
    return table;
  }
  const auto times = std::make_shared<const std::vector<double>>(columns[0]);
  for (std::size_t k = 1; k < names.size(); ++k)
    table.columns[names[k]] =
        std::make_shared<Interpolated>(times, std::make_shared<const std::vector<double>>(columns[k]));
  return table;
}

}  // namespace spume
