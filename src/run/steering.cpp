// SPDX-License-Identifier: MIT
#include "spume/run/steering.hpp"

#include <charconv>
#include <cmath>
#include <sstream>

#include "spume/core/error.hpp"
#include "spume/io/file.hpp"

namespace spume {
namespace {

constexpr const char* steering_columns = "step,t,key,value";

// As in other CSV files: quoted where it holds a comma or a quote, which is then written twice.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return quoted + '"';
}

std::vector<std::string> csv_fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        fields.back() += line[i++];
      else
        quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  return fields;
}

template <class Number>
bool read_number(const std::string& text, Number& number) {
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  return read.ec == std::errc() && read.ptr == end;
}

}  // namespace

std::string steered_option(const std::string& key) {
  std::string option;
  std::istringstream parts(key);
  for (std::string part; std::getline(parts, part, '.');)
    if (part.empty() || part.find_first_not_of("0123456789") != std::string::npos)
      option += (option.empty() ? "" : ".") + part;
  return option;
}

std::vector<std::string> steering_overrides(const std::vector<SteeringRow>& rows) {
  std::vector<std::string> overrides;
  for (const SteeringRow& row : rows)
    if (row.key != snapshot_key) overrides.push_back(row.key + "=" + row.value);
  return overrides;
}

std::vector<SteeringRow> read_steering(const std::filesystem::path& path) {
  std::vector<SteeringRow> rows;
  std::vector<Problem> problems;
  std::istringstream lines(read_text(path));
  int number = 0;
  bool headed = false;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.starts_with('#')) continue;
    if (!headed) {
      if (line != steering_columns)
        throw InputError({{path.string(), number, 1, std::string("expected the columns ") + steering_columns}});
      headed = true;
      continue;
    }
    const std::vector<std::string> fields = csv_fields(line);
    SteeringRow row;
    const auto fault = [&](const std::string& text) { problems.push_back({path.string(), number, 1, text}); };
    if (fields.size() != 4)
      fault("expected " + std::string(steering_columns) + ", found " + std::to_string(fields.size()) + " entries");
    else if (!read_number(fields[0], row.step) || row.step < 0)
      fault("step '" + fields[0] + "' is no number of a step");
    else if (!read_number(fields[1], row.time) || !std::isfinite(row.time))
      fault("t '" + fields[1] + "' is no time");
    else if (!rows.empty() && row.step < rows.back().step)
      fault("step " + fields[0] + " comes after step " + std::to_string(rows.back().step));
    else
      rows.push_back({row.step, row.time, fields[2], fields[3]});
  }
  if (!headed) throw InputError({{path.string(), 1, 1, std::string("expected the columns ") + steering_columns}});
  if (!problems.empty()) throw InputError(std::move(problems));
  return rows;
}

void write_steering(const std::filesystem::path& path, const std::vector<SteeringRow>& rows) {
  std::string text =
      "# changes made by hand after the steps; spume run CASE --replay steering.csv makes them again\n"
      "# t: time\n";
  text += std::string(steering_columns) + '\n';
  for (const SteeringRow& row : rows) {
    char time[32];
    const auto written = std::to_chars(time, time + sizeof time, row.time);
    text += std::to_string(row.step) + ',' + std::string(time, written.ptr) + ',' + csv_field(row.key) + ',' +
            csv_field(row.value) + '\n';
  }
  write_text_atomically(path, text);
}

}  // namespace spume
