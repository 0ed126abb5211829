// SPDX-License-Identifier: MIT
#include "spume/scene/document.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>

namespace spume {
namespace {

Place place_of(const toml::source_position& position) {
  return {static_cast<int>(position.line), static_cast<int>(position.column)};
}

Node convert(const toml::node& value) {
  Node node;
  node.place = place_of(value.source().begin);
  if (const auto* table = value.as_table()) {
    node.kind = Node::Kind::table;
    std::vector<std::pair<std::string, Node>> members;
    for (const auto& [key, member] : *table) {
      Node child = convert(member);
      child.key_place = place_of(key.source().begin);
      members.emplace_back(std::string(key.str()), std::move(child));
    }
    std::stable_sort(members.begin(), members.end(),
                     [](const auto& a, const auto& b) { return a.second.key_place < b.second.key_place; });
    for (auto& [key, child] : members) {
      node.keys.push_back(std::move(key));
      node.children.push_back(std::move(child));
    }
  } else if (const auto* array = value.as_array()) {
    node.kind = Node::Kind::array;
    for (const auto& element : *array) {
      node.children.push_back(convert(element));
      node.children.back().key_place = node.children.back().place;
    }
  } else if (const auto* text = value.as_string()) {
    node.kind = Node::Kind::string;
    node.text = text->get();
  } else if (const auto* integer = value.as_integer()) {
    node.kind = Node::Kind::integer;
    node.integer = integer->get();
    node.number = static_cast<double>(node.integer);
  } else if (const auto* number = value.as_floating_point()) {
    node.kind = Node::Kind::number;
    node.number = number->get();
  } else if (const auto* boolean = value.as_boolean()) {
    node.kind = Node::Kind::boolean;
    node.boolean = boolean->get();
  } else {
    node.kind = Node::Kind::date;
    std::ostringstream out;
    if (const auto* date = value.as_date()) out << *date;
    if (const auto* time = value.as_time()) out << *time;
    if (const auto* date_time = value.as_date_time()) out << *date_time;
    node.text = out.str();
  }
  return node;
}

void mark_override(Node& node, const std::string& override_text) {
  node.override_text = override_text;
  node.place = node.key_place = {};
  for (Node& child : node.children) mark_override(child, override_text);
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

Node* element(Node& array, const std::string& index_text) {
  std::size_t index = 0;
  const char* last = index_text.data() + index_text.size();
  const auto [end, error] = std::from_chars(index_text.data(), last, index);
  if (error != std::errc{} || end != last || index > array.children.size()) return nullptr;
  if (index == array.children.size()) array.children.emplace_back();
  return &array.children[index];
}

// Keys may be joined by dots to any depth, and every part is a table within a table: 20,000 parts exhaust the stack of
// the parser. The deepest option has 3 parts; the parser itself bounds values within values at 256.
constexpr std::size_t most_key_parts = 16;

// Where a key of more parts stands in the text of a document; nothing for none. Outside strings and comments more than
// so many dots without a separator between them are nothing else.
std::optional<std::size_t> overlong_key(const std::string& text) {
  std::size_t dots = 0, start = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size()) - 1;
    } else if (c == '"' || c == '\'') {
      const bool block = text.compare(at, 3, std::string(3, c)) == 0;
      const std::string quote(block ? 3 : 1, c);
      for (at += quote.size(); at < text.size() && text.compare(at, quote.size(), quote) != 0; ++at) {
        if (c == '"' && text[at] == '\\') ++at;
        if (!block && text[at] == '\n') break;
      }
      at += quote.size() - 1;
    } else if (std::strchr("=,[]{}\n", c) != nullptr) {
      dots = 0, start = at + 1;
    } else if (c == '.' && ++dots >= most_key_parts) {
      return start;
    }
  }
  return std::nullopt;
}

std::string too_many_parts() {
  return "a key has more than " + std::to_string(most_key_parts) +
         " parts joined by dots; expected section.key, as in fluid.reynolds";
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      // Two letters swapped are one slip of the fingers.
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
      }
    }
  }
  return cost[a.size()][b.size()];
}

}  // namespace

const Node* Node::find(const std::string& key) const {
  if (kind != Kind::table) return nullptr;
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &children[static_cast<std::size_t>(found - keys.begin())];
}

Node* Node::find(const std::string& key) {
  return const_cast<Node*>(std::as_const(*this).find(key));
}

Node& Node::insert(const std::string& key, Node value) {
  if (Node* present = find(key)) return *present = std::move(value);
  keys.push_back(key);
  children.push_back(std::move(value));
  return children.back();
}

void Problems::add(Place place, std::string text) {
  problems_.push_back({file_, place.line, place.column, std::move(text)});
}

Problem Problems::at(const Node& node, std::string text) const {
  if (!node.override_text.empty()) return {node.override_text, 0, 0, std::move(text)};
  return {file_, node.place.line, node.place.column, std::move(text)};
}

void Problems::add(const Node& node, std::string text) {
  problems_.push_back(at(node, std::move(text)));
}

void Problems::warn(const Node& node, std::string text) {
  warnings_.push_back(at(node, std::move(text)));
}

void Problems::add_key(const Node& node, std::string text) {
  if (node.override_text.empty() && node.key_place.line > 0) {
    add(node.key_place, std::move(text));
  } else {
    add(node, std::move(text));
  }
}

void Problems::add_in_string(const Node& node, std::size_t offset, std::string text, const std::string& source) {
  if (!node.override_text.empty()) {
    problems_.push_back({node.override_text, 0, 0, text + " (character " + std::to_string(offset + 1) + ")"});
  } else if (node.kind != Node::Kind::string) {
    add(node.place, std::move(text));
  } else {
    add(place_in_string(source, node.place, offset), std::move(text));
  }
}

void Problems::throw_if_any() {
  if (problems_.empty()) return;
  std::stable_sort(problems_.begin(), problems_.end(), [](const Problem& a, const Problem& b) {
    const auto order = [](const Problem& p) { return std::tuple(p.line == 0, p.line, p.column); };
    return order(a) < order(b);
  });
  throw InputError(std::move(problems_));
}

Node parse_document(const std::string& text, const std::string& file) {
  if (const auto at = overlong_key(text)) {
    const auto begin = text.begin(), key = begin + static_cast<std::ptrdiff_t>(*at);
    const auto line = std::count(begin, key, '\n');
    throw InputError(
        {Problem{file, static_cast<int>(line) + 1,
                 static_cast<int>(*at - (line > 0 ? text.rfind('\n', *at - 1) : std::size_t(-1))), too_many_parts()}});
  }
  try {
    return convert(toml::parse(std::string_view(text), std::string_view(file)));
  } catch (const toml::parse_error& error) {
    const Place place = place_of(error.source().begin);
    std::string finding(error.description());
    throw InputError({Problem{file, std::max(1, place.line), std::max(1, place.column), "not valid TOML: " + finding}});
  }
}

Node parse_value(const std::string& text) {
  Node document = parse_document("value = " + text, "");
  if (document.keys.size() != 1) throw InputError("not one value");
  return std::move(document.children[0]);
}

namespace {

// The assignment of an override, and how the user gave it: "time.end=20" came as "--set time.end=20", and
// "--until time.end=20" as "--until 20".
std::pair<std::string, std::string> split_override(const std::string& text) {
  const std::size_t blank = text.find(' ');
  if (!text.starts_with("--") || blank == std::string::npos) return {text, "--set " + text};
  const std::string assignment = text.substr(blank + 1);
  return {assignment, text.substr(0, blank + 1) + assignment.substr(assignment.find('=') + 1)};
}

}  // namespace

void apply_override(Node& document, const std::string& text, const std::vector<std::string>& repeated,
                    Problems& problems) {
  const auto [assignment, label] = split_override(text);
  Node place;
  place.override_text = label;
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    problems.add(place, "expected section.key=value, for example --set fluid.mach=0.1");
    return;
  }
  std::vector<std::string> path;
  std::istringstream parts(assignment.substr(0, equals));
  for (std::string part; std::getline(parts, part, '.');) path.push_back(trimmed(part));
  if (path.size() > most_key_parts) {
    place.override_text = label.substr(0, 40) + "...";
    problems.add(place, too_many_parts());
    return;
  }
  if (path.empty() || std::find(path.begin(), path.end(), "") != path.end()) {
    problems.add(place, "expected section.key=value, for example --set fluid.mach=0.1");
    return;
  }

  Node value;
  const std::string raw = trimmed(assignment.substr(equals + 1));
  try {
    value = parse_value(raw);
  } catch (const InputError&) {
    value.kind = Node::Kind::string;
    value.text = raw;
  }
  mark_override(value, label);
  value.raw = raw;

  Node* at = &document;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool last = i + 1 == path.size();
    if (at->kind == Node::Kind::array) {
      const bool tables = i == 1 && std::find(repeated.begin(), repeated.end(), path[0]) != repeated.end();
      const std::size_t present = at->children.size();
      Node* next = element(*at, path[i]);
      if (!next || (present != at->children.size() && !tables)) {
        at->children.resize(present);
        problems.add(place, "'" + path[i] + "' is not an entry of '" + path[i - 1] + "', which has " +
                                std::to_string(present) + " (the first is 0)");
        return;
      }
      if (present != at->children.size()) next->override_text = label;
      at = next;
      if (last) *at = value;
    } else if (at->kind == Node::Kind::table) {
      if (last) {
        at->insert(path[i], value);
      } else if (Node* next = at->find(path[i])) {
        at = next;
      } else {
        Node created;
        const bool array = i == 0 && std::find(repeated.begin(), repeated.end(), path[0]) != repeated.end();
        created.kind = array ? Node::Kind::array : Node::Kind::table;
        created.override_text = label;
        at = &at->insert(path[i], std::move(created));
      }
    } else {
      problems.add(place, "'" + path[i - 1] + "' is " + kind_in_words(*at) + " and has no entry '" + path[i] + "'");
      return;
    }
  }
}

Place place_in_string(const std::string& source, Place start, std::size_t offset) {
  std::size_t at = 0;
  for (int line = 1; line < start.line && at < source.size(); ++line) {
    const std::size_t end = source.find('\n', at);
    at = end == std::string::npos ? source.size() : end + 1;
  }
  if (start.line == 1 && source.compare(0, 3, "\xEF\xBB\xBF") == 0) at += 3;
  Place place{start.line, 1};
  // toml++ counts columns in code points.
  const auto advance = [&] {
    if (at >= source.size()) return;
    if (source[at] == '\n') {
      ++place.line;
      place.column = 0;
    }
    ++at;
    while (at < source.size() && (static_cast<unsigned char>(source[at]) & 0xC0) == 0x80) ++at;
    ++place.column;
  };
  while (place.column < start.column && at < source.size() && source[at] != '\n') advance();
  const char quote = at < source.size() ? source[at] : '"';
  if (quote != '"' && quote != '\'') return start;
  const bool long_string = source.compare(at, 3, std::string(3, quote)) == 0;
  for (int i = 0; i < (long_string ? 3 : 1); ++i) advance();
  if (long_string) {
    if (at < source.size() && source[at] == '\r') advance();
    if (at < source.size() && source[at] == '\n') advance();
  }
  for (std::size_t passed = 0; passed < offset && at < source.size();) {
    const std::size_t before = at;
    if (quote == '"' && source[at] == '\\' && at + 1 < source.size()) {
      const char kind = source[at + 1];
      const int length = kind == 'u' ? 6 : kind == 'U' ? 10 : 2;
      for (int i = 0; i < length; ++i) advance();
      ++passed;
    } else {
      advance();
      passed += at - before;
    }
  }
  return place;
}

std::string kind_in_words(const Node& node) {
  switch (node.kind) {
    case Node::Kind::table:
      return "a table";
    case Node::Kind::array:
      return "a list";
    case Node::Kind::string:
      return "a string";
    case Node::Kind::integer:
      return "an integer";
    case Node::Kind::number:
      return "a number";
    case Node::Kind::boolean:
      return "a boolean";
    case Node::Kind::date:
      return "a date";
  }
  return {};
}

std::string shortest(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  char buffer[64];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  if (error != std::errc{}) return {};
  std::string text(buffer, end);
  // 1e-06 reads as 1e-6.
  const std::size_t exponent = text.find('e');
  if (exponent != std::string::npos && text[exponent + 2] == '0') text.erase(exponent + 2, 1);
  if (exponent != std::string::npos && text[exponent + 1] == '+') text.erase(exponent + 1, 1);
  return text;
}

std::string to_toml_number(double value) {
  const std::string text = shortest(value);
  // Without a point or an exponent it would read back as an integer.
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string brief(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

std::string to_toml_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (byte < 0x20 || byte == 0x7F) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04X", byte);
      out += escape;
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string to_toml_key(const std::string& key) {
  const bool bare = !key.empty() && key.find_first_not_of(
                                        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                        "0123456789_-") == std::string::npos;
  return bare ? key : to_toml_string(key);
}

std::string to_toml(const Node& node) {
  std::string out;
  switch (node.kind) {
    case Node::Kind::string:
      return to_toml_string(node.text);
    case Node::Kind::integer:
      return std::to_string(node.integer);
    case Node::Kind::boolean:
      return node.boolean ? "true" : "false";
    case Node::Kind::date:
      return node.text;
    case Node::Kind::number:
      return to_toml_number(node.number);
    case Node::Kind::array:
      for (const Node& child : node.children) out += (out.empty() ? "" : ", ") + to_toml(child);
      return "[" + out + "]";
    case Node::Kind::table:
      for (std::size_t i = 0; i < node.keys.size(); ++i) {
        out += (i == 0 ? " " : ", ") + to_toml_key(node.keys[i]) + " = " + to_toml(node.children[i]);
      }
      return node.keys.empty() ? "{}" : "{" + out + " }";
  }
  return out;
}

std::string nearest(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.size() > 100) return {};
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance && distance < std::max(word.size(), candidate.size())) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string best = nearest(word, candidates);
  return best.empty() ? "" : "; did you mean '" + best + "'?";
}

}  // namespace spume
