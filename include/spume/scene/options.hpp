// SPDX-License-Identifier: MIT
// An option of a case file in words, as `spume options` lists it. CaseSchema::option_table() makes the rows from the
// declarations that the reader, the error messages and the resolved case use.
#pragma once

#include <string>

namespace spume {

struct OptionInfo {
  std::string section;       // "" for keys above the first section; "liquid" stands for every [[liquid]]
  std::string key;           // "*" for a section whose keys the user chooses
  std::string type;          // in words: "number", "list of expressions", ...
  std::string unit;          // "length", "time", "kg/m3", ...; "1" without dimension, "" where none applies
  std::string default_text;  // as TOML, or in parentheses what an absent key means
  std::string range;         // "> 0", "one of ...", or ""
  std::string description;   // one line
  bool steerable = false;    // may change while a run goes on
};

}  // namespace spume
