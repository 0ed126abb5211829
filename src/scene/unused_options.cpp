// SPDX-License-Identifier: MIT
#include "unused_options.hpp"

#include <algorithm>

#include "checks.hpp"

namespace spume {
namespace {

// The words that Option::needs compares: of a text itself, else as TOML.
std::string word_of(const Node& node) {
  return node.kind == Node::Kind::string ? node.text : to_toml(node);
}

std::string text_of(const Option& option, const std::string& word) {
  return option.type == OptionType::word ? to_toml_string(word) : word;
}

void examine(const Draft& draft, const Section& section, const std::string& prefix, const std::string& file,
             std::vector<Problem>& remarks) {
  for (const Option& option : section.options) {
    const Node* given = draft.node(prefix + "." + option.key);
    if (option.needs.words.empty() || !given) continue;
    if (!option.default_text.empty() && to_toml(*given) == to_toml(parse_value(option.default_text))) continue;
    const auto decides = std::find_if(section.options.begin(), section.options.end(),
                                      [&](const Option& other) { return other.key == option.needs.key; });
    const std::string switch_name = prefix + "." + decides->key;
    const Node* chosen = draft.node(switch_name);
    const std::string word = chosen ? word_of(*chosen) : word_of(parse_value(decides->default_text));
    const auto& words = option.needs.words;
    if (std::find(words.begin(), words.end(), word) != words.end()) continue;
    std::string wanted;
    for (const std::string& one : words) wanted += (wanted.empty() ? "" : " or ") + text_of(*decides, one);
    const std::string text = prefix + "." + option.key + " is not used with " + switch_name + " = " +
                             text_of(*decides, word) + "; it takes effect with " + wanted + "; remove it or set " +
                             switch_name;
    remarks.push_back(given->override_text.empty() ? Problem{file, given->key_place.line, given->key_place.column, text}
                                                   : Problem{given->override_text, 0, 0, text});
  }
}

// A wall that lets liquid slip is felt by its motion along its normal alone.
void examine_walls(const Draft& draft, const std::string& file, std::vector<Problem>& remarks) {
  for (const auto& [side, velocity] : draft.wall_velocity) {
    const auto kind = draft.sides.find(side);
    if (kind == draft.sides.end() || kind->second != BoundaryKind::free_slip) continue;
    for (std::size_t axis = 0; axis < velocity.size(); ++axis) {
      const auto names = side_names(static_cast<int>(axis), draft.dimensions);
      if ((side != names[0] && side != names[1]) || velocity[axis].text != "0") continue;
      const std::string key = "domain.wall_velocity." + side;
      const Node& given = *draft.node(key);
      const std::string text = key + " moves a free-slip wall along itself, which no liquid feels; set domain." + side +
                               " = \"no-slip\", or give a velocity along " + "xyz"[axis];
      remarks.push_back(given.override_text.empty() ? Problem{file, given.key_place.line, given.key_place.column, text}
                                                    : Problem{given.override_text, 0, 0, text});
    }
  }
}

}  // namespace

std::vector<Problem> unused_options(const Draft& draft, const CaseSchema& schema, const std::string& file) {
  std::vector<Problem> remarks;
  for (const Section& section : schema.sections()) {
    if (!section.owners.include(draft.options.method) || section.name.empty()) continue;
    if (!section.repeated) examine(draft, section, section.name, file, remarks);
    for (std::size_t i = 0; section.repeated && draft.node(section.name + "." + std::to_string(i)); ++i)
      examine(draft, section, section.name + "." + std::to_string(i), file, remarks);
  }
  examine_walls(draft, file, remarks);
  std::stable_sort(remarks.begin(), remarks.end(), [](const Problem& a, const Problem& b) {
    return (a.line == 0) != (b.line == 0) ? b.line == 0 : a.line < b.line;
  });
  return remarks;
}

}  // namespace spume
