// SPDX-License-Identifier: MIT
// Comparing two resolved cases by their values: spelling of numbers, comments and order do not count.
#pragma once

#include <string>
#include <vector>

namespace spume {

struct ChangedValue {
  std::string name;         // "section.key", entries of lists of tables by number
  std::string before, now;  // as TOML; empty where the case does not have it
};

// The values in which two TOML texts differ, in the order of the later one, then those that it no longer has.
// Throws InputError for a text that is not TOML.
std::vector<ChangedValue> changed_values(const std::string& before, const std::string& now);

// The later text with the lines of the earlier one wherever both assign the same value in the same section: a resolved
// case that is read again calls every value the case's own, and only the earlier text knows defaults and overrides.
std::string with_origins_of(const std::string& before, const std::string& now);

}  // namespace spume
