// SPDX-License-Identifier: MIT
// Every option of a case file, in the order in which `spume options` lists them. The table is the declaration
// itself: the reader, the error messages and the resolved case use the same entries.
#pragma once

#include <string>
#include <vector>

namespace spume {

struct OptionInfo {
  std::string section;       // "" for keys above the first section; "liquid" stands for every [[liquid]]
  std::string key;           // "*" for a section whose keys the user chooses
  std::string type;          // in words: "number", "list of expressions", ...
  std::string unit;          // "length", "time", "kg/m3", ...; "1" without dimension, "" where none applies
  std::string default_text;  // as TOML, or in parentheses what an absent key means
  std::string range;         // "> 0", "one of ...", or ""
  std::string description;   // one line
};

const std::vector<OptionInfo>& option_table();

}  // namespace spume
