// SPDX-License-Identifier: MIT
#include "spume/scene/resolved_case.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

#include "spume/scene/document.hpp"

namespace spume {
namespace {

using Values = std::vector<std::pair<std::string, std::string>>;

// 1, 1.0 and 1e0 are one value.
std::string plain_text(const Node& node) {
  if (node.is_number()) return shortest(node.number);
  if (node.kind != Node::Kind::array) return to_toml(node);
  std::string text;
  for (const Node& child : node.children) text += (text.empty() ? "" : ", ") + plain_text(child);
  return "[" + text + "]";
}

void collect(const Node& node, const std::string& name, Values& values) {
  const bool tables =
      node.kind == Node::Kind::array && !node.children.empty() && node.children.front().kind == Node::Kind::table;
  if (node.kind != Node::Kind::table && !tables) {
    values.emplace_back(name, plain_text(node));
    return;
  }
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    const std::string key = tables ? std::to_string(i) : node.keys[i];
    collect(node.children[i], name.empty() ? key : name + "." + key, values);
  }
}

Values values_of(const std::string& text) {
  Values values;
  collect(parse_document(text, "the case"), "", values);
  return values;
}

// A line up to its comment, without the blanks before that.
std::string assignment_of(const std::string& line) {
  bool quoted = false;
  std::size_t end = 0;
  for (; end < line.size() && (quoted || line[end] != '#'); ++end) {
    if (quoted && line[end] == '\\')
      ++end;
    else if (line[end] == '"')
      quoted = !quoted;
  }
  const std::size_t last = line.substr(0, end).find_last_not_of(' ');
  return last == std::string::npos ? std::string{} : line.substr(0, last + 1);
}

// Calls `use(key, line)` for every line; the key is empty for lines that assign nothing, and tells section and
// assignment of the others.
template <class Use>
void for_each_line(const std::string& text, Use&& use) {
  std::map<std::string, int> sections;  // how many headers of that text there were: [[liquid]] comes again
  std::string section;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string assignment = assignment_of(line);
    const bool header = assignment.starts_with('[');
    if (header) section = assignment + std::to_string(sections[assignment]++);
    use(header || assignment.empty() ? std::string{} : section + '\n' + assignment, line);
  }
}

}  // namespace

std::vector<ChangedValue> changed_values(const std::string& before, const std::string& now) {
  const Values earlier = values_of(before), later = values_of(now);
  const auto find = [](const Values& values, const std::string& name) {
    const auto found =
        std::find_if(values.begin(), values.end(), [&](const auto& value) { return value.first == name; });
    return found == values.end() ? std::string{} : found->second;
  };
  std::vector<ChangedValue> changes;
  for (const auto& [name, value] : later)
    if (const std::string old = find(earlier, name); old != value) changes.push_back({name, old, value});
  for (const auto& [name, value] : earlier)
    if (find(later, name).empty()) changes.push_back({name, value, {}});
  return changes;
}

std::string with_origins_of(const std::string& before, const std::string& now) {
  std::map<std::string, std::string> known;
  for_each_line(before, [&](const std::string& key, const std::string& line) {
    if (!key.empty()) known.emplace(key, line);
  });
  std::string text;
  for_each_line(now, [&](const std::string& key, const std::string& line) {
    const auto found = known.find(key);
    text += (found == known.end() ? line : found->second) + '\n';
  });
  return text;
}

}  // namespace spume
