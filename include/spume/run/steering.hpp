// SPDX-License-Identifier: MIT
// Changes that are made to a run by hand, between two steps: steering.csv with the columns step, t, key, value.
//
// A change of an option takes effect after the step of its row, as if the run had been stopped there and resumed with
// the changed case. The file tells all changes of a run, also those that a replay has yet to make, so that a run that
// was killed continues with the same bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace spume {

struct SteeringRow {
  std::int64_t step = 0;
  double time = 0;
  std::string key;    // "section.key" of an option, or snapshot_key
  std::string value;  // as TOML; empty for a snapshot
  bool operator==(const SteeringRow&) const = default;
};

// The option that a key means: "phase.viscosity" of "phase.0.viscosity", an entry of [[phase]].
std::string steered_option(const std::string& key);

// In place of an option: a snapshot beside those of output.every.
inline constexpr const char* snapshot_key = "snapshot";

// "section.key=value" of every option in the rows, in their order.
std::vector<std::string> steering_overrides(const std::vector<SteeringRow>& rows);

// Rows in the order of their steps. Throws FileError, InputError with "file:line:" for a file that holds no such rows.
std::vector<SteeringRow> read_steering(const std::filesystem::path& path);
// Replaces the file as a whole. Throws FileError.
void write_steering(const std::filesystem::path& path, const std::vector<SteeringRow>& rows);

}  // namespace spume
