// SPDX-License-Identifier: MIT
#include <cstdio>
#include <set>

#include "spume/core/error.hpp"
#include "verbs.hpp"

namespace spume {

int options_verb(const std::string& section, const Program& program) {
  std::string wanted = section, heading = "\n";
  while (!wanted.empty() && wanted.front() == '[') wanted.erase(0, 1);
  while (!wanted.empty() && wanted.back() == ']') wanted.pop_back();
  std::string known;
  std::set<std::string> seen;
  bool found = false;
  for (const auto& option : program.option_table()) {
    if (!option.section.empty() && seen.insert(option.section).second)
      known += (known.empty() ? "" : ", ") + option.section;
    if (!wanted.empty() && option.section != wanted) continue;
    found = true;
    if (option.section != heading) {
      heading = option.section;
      std::printf("%s\n", heading.empty() ? "(top of the file)" : ('[' + heading + ']').c_str());
    }
    std::string facts = option.type;
    if (!option.unit.empty() && option.unit != "1") facts += ", " + option.unit;
    if (!option.range.empty()) facts += ", " + option.range;
    if (!option.default_text.empty()) facts += "; default " + option.default_text;
    if (option.steerable) facts += "; steerable";
    std::printf("  %-24s %s\n  %-24s   %s\n", option.key.c_str(), option.description.c_str(), "", facts.c_str());
  }
  if (section.empty() && !program.methods.empty()) {
    std::printf("(methods)\n");
    for (const auto& [name, description] : program.methods)
      std::printf("  %-24s %s\n", name.c_str(), description.c_str());
  }
  if (!found) throw InputError("there is no section '" + wanted + "'; there are " + known);
  return exit_done;
}

}  // namespace spume
