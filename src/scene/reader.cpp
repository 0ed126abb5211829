// SPDX-License-Identifier: MIT
#include "reader.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

namespace spume {
namespace {

std::string in_section(const std::string& section, bool repeated) {
  if (section.empty()) return "";
  return repeated ? " in [[" + section + "]]" : " in [" + section + "]";
}

std::string example_value(const Option& option) {
  switch (option.type) {
    case OptionType::number:
      return "<number>";
    case OptionType::integer:
    case OptionType::integers:
      return "<integer>";
    case OptionType::boolean:
      return "true";
    case OptionType::word:
      return option.words.size() == 1 ? to_toml_string(option.words[0]) : "<word>";
    case OptionType::numbers:
      return "[<number>, <number>]";
    case OptionType::points:
      return "[[<number>, <number>], ...]";
    case OptionType::strings:
      return "[\"<text>\"]";
    case OptionType::expressions:
      return "[\"<expression>\", ...]";
    default:
      return "\"<text>\"";
  }
}

std::string belongs_elsewhere(const Owners& owners, const std::string& method) {
  return (owners.names.empty() ? " is taken by no method of this version"
                               : " belongs to method " + words_in_words(owners.names)) +
         ", and this case is of method " + to_toml_string(method);
}

// Reads one section's table into the draft.
class SectionReader {
 public:
  SectionReader(const CaseSchema& schema, Draft& draft, Problems& problems, const Section& section, std::string prefix,
                std::string method)
      : schema_(schema),
        draft_(draft),
        problems_(problems),
        section_(section),
        prefix_(std::move(prefix)),
        method_(std::move(method)) {}

  // `table` is null for a section that the file does not name; `document` then gives the place.
  void read(const Node* table, const Node& document) {
    for (const Option& option : section_.options) {
      if (option.type == OptionType::free_table) continue;
      const std::string name = prefix_.empty() ? option.key : prefix_ + "." + option.key;
      const Node* node = table ? table->find(option.key) : nullptr;
      Value value;
      if (!option.owners.include(method_)) {
        if (!node) continue;
        problems_.add_key(*node, name + belongs_elsewhere(option.owners, method_) + "; remove it");
        draft_.bad[name] = true;
      } else if (node) {
        draft_.given[name] = node;
        if (convert(option, name, *node, value)) {
          option.set(draft_, value);
        } else {
          draft_.bad[name] = true;
        }
      } else if (option.required && method_.empty() && !option.owners.all) {
        draft_.bad[name] = true;  // nobody knows whether it is needed
      } else if (option.required) {
        draft_.bad[name] = true;
        missing(option, table, document);
      } else if (!option.default_text.empty()) {
        const Node standard = parse_value(option.default_text);
        convert(option, name, standard, value);
        option.set(draft_, value);
      }
    }
  }

 private:
  void missing(const Option& option, const Node* table, const Node& document) {
    std::string text = "missing key '" + option.key + "'" + in_section(section_.name, section_.repeated) + "; add  " +
                       option.key + " = " + example_value(option);
    const std::string unit = option.unit == "1" ? "" : option.unit;
    const std::string range = option.range.in_words();
    if (!unit.empty() || !range.empty()) text += "  # " + unit + (unit.empty() || range.empty() ? "" : ", ") + range;
    const Node& place = table ? *table : document;
    if (place.override_text.empty()) {
      problems_.add(place.place.line > 0 ? place.place : Place{1, 1}, text);
    } else {
      problems_.add(place, text);
    }
  }

  bool refuse(const Node& node, const std::string& text) {
    problems_.add(node, text);
    return false;
  }

  bool wrong_type(const Option& option, const std::string& name, const Node& node) {
    const std::string unit = option.unit.empty() || option.unit == "1" ? "" : " (" + option.unit + ")";
    const std::string expected =
        option.type == OptionType::word ? words_in_words(option.words) : type_in_words(option.type);
    // TOML has integers of 64 bits: digits that are more are no value on the command line, and are taken for a text.
    const std::size_t sign = node.text.find_first_of("+-") == 0 ? 1 : 0;
    const bool digits = !node.override_text.empty() && node.kind == Node::Kind::string && node.text.size() > sign &&
                        node.text.find_first_not_of("0123456789", sign) == std::string::npos;
    return refuse(node,
                  name + " must be " + expected + unit + ", found " +
                      (digits ? node.text + ", beyond the integers from -2^63 to 2^63 - 1" : kind_in_words(node)));
  }

  bool in_range(const Option& option, const std::string& name, const Node& node, double value) {
    if (!std::isfinite(value)) return refuse(node, name + " must be finite, found " + shortest(value));
    if (option.range.contains(value)) return true;
    const std::string unit = option.unit.empty() || option.unit == "1" ? "" : " (" + option.unit + ")";
    return refuse(node, name + " must be " + option.range.in_words() + unit + ", found " + to_toml(node));
  }

  // An expression may be written as a number.
  static bool expression(const Node& node, ExpressionText& out) {
    if (node.kind != Node::Kind::string && !node.is_number()) return false;
    out = {node.kind == Node::Kind::string ? node.text : to_toml(node), &node};
    return true;
  }

  bool convert(const Option& option, const std::string& name, const Node& node, Value& value) {
    switch (option.type) {
      case OptionType::number:
        if (!node.is_number()) return wrong_type(option, name, node);
        value.number = node.number;
        return in_range(option, name, node, node.number);
      case OptionType::integer:
        if (node.kind != Node::Kind::integer) return wrong_type(option, name, node);
        value.integer = node.integer;
        return in_range(option, name, node, node.number);
      case OptionType::boolean:
        if (node.kind != Node::Kind::boolean) return wrong_type(option, name, node);
        value.boolean = node.boolean;
        return true;
      case OptionType::string:
        if (node.kind != Node::Kind::string) {
          // On the command line `title=2024` means the text.
          if (node.override_text.empty()) return wrong_type(option, name, node);
          value.text = node.raw;
          return true;
        }
        value.text = node.text;
        return true;
      case OptionType::word:
        return word(option, name, node, value);
      case OptionType::expression:
        return expression(node, value.expression) ? true : wrong_type(option, name, node);
      case OptionType::integers:
        return integers(option, name, node, value);
      case OptionType::points:
        return points(option, name, node, value);
      case OptionType::numbers:
      case OptionType::strings:
      case OptionType::expressions:
        return list(option, name, node, value);
      case OptionType::free_table:
        break;
    }
    return true;
  }

  bool word(const Option& option, const std::string& name, const Node& node, Value& value) {
    if (node.kind != Node::Kind::string) return wrong_type(option, name, node);
    value.text = node.text;
    if (std::find(option.words.begin(), option.words.end(), node.text) != option.words.end()) return true;
    if (node.text == "periodic" && section_.name == "domain") {
      return refuse(node, name + " is one side; a periodic direction is written by its axis: x = \"periodic\"");
    }
    const bool is_key = std::any_of(section_.options.begin(), section_.options.end(),
                                    [&](const Option& other) { return other.key == node.text; });
    if (is_key && node.text != option.key)
      return refuse(node, name + " must be " + words_in_words(option.words) + "; '" + node.text +
                              "' is a key of its own: write  " + node.text + " = ...  in its place");
    const std::string best = nearest(node.text, option.words);
    return refuse(node, name + " must be " + words_in_words(option.words) + ", found " + to_toml(node) +
                            (best.empty() ? "" : "; did you mean \"" + best + "\"?"));
  }

  // One integer stands for a list of one.
  bool integers(const Option& option, const std::string& name, const Node& node, Value& value) {
    if (node.kind != Node::Kind::array && node.kind != Node::Kind::integer) return wrong_type(option, name, node);
    const std::span<const Node> elements =
        node.kind == Node::Kind::array ? std::span<const Node>(node.children) : std::span<const Node>(&node, 1);
    bool good = true;
    for (const Node& element : elements) {
      if (element.kind != Node::Kind::integer) {
        good = refuse(element, name + " must hold integers, found " + kind_in_words(element));
      } else if (!in_range(option, name, element, element.number)) {
        good = false;
      }
      value.integers.push_back(element.integer);
    }
    return good;
  }

  bool points(const Option& option, const std::string& name, const Node& node, Value& value) {
    if (node.kind != Node::Kind::array) return wrong_type(option, name, node);
    bool good = true;
    for (std::size_t i = 0; i < node.children.size(); ++i) {
      const Node& point = node.children[i];
      const auto number = [](const Node& entry) { return entry.is_number() && std::isfinite(entry.number); };
      if (point.kind != Node::Kind::array || point.children.size() != 2 || !number(point.children[0]) ||
          !number(point.children[1])) {
        good = refuse(
            point, name + "[" + std::to_string(i) + "] must be a point of two finite numbers, found " + to_toml(point));
        continue;
      }
      value.points.push_back({point.children[0].number, point.children[1].number});
    }
    return good;
  }

  bool list(const Option& option, const std::string& name, const Node& node, Value& value) {
    const bool alone = option.one_alone && node.kind != Node::Kind::array && node.kind != Node::Kind::table;
    if (node.kind != Node::Kind::array && !alone) return wrong_type(option, name, node);
    const std::span<const Node> elements =
        alone ? std::span<const Node>(&node, 1) : std::span<const Node>(node.children);
    bool good = true;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const Node& element = elements[i];
      const std::string entry = alone ? name : name + "[" + std::to_string(i) + "]";
      if (option.type == OptionType::numbers) {
        if (!element.is_number()) {
          good = refuse(element, entry + " must be a number, found " + kind_in_words(element));
        } else if (!std::isfinite(element.number)) {
          good = refuse(element, entry + " must be finite, found " + shortest(element.number));
        }
        value.numbers.push_back(element.number);
      } else if (option.type == OptionType::strings) {
        if (element.kind != Node::Kind::string) {
          good = refuse(element, entry + " must be a string, found " + kind_in_words(element));
        }
        value.texts.push_back(element.text);
      } else {
        ExpressionText text;
        if (!expression(element, text)) {
          good =
              refuse(element, entry + " must be an expression (a string or a number), found " + kind_in_words(element));
        }
        value.expressions.push_back(text);
      }
    }
    return good;
  }

  const CaseSchema& schema_;
  Draft& draft_;
  Problems& problems_;
  const Section& section_;
  std::string prefix_;
  std::string method_;
};

bool is_free(const Section& section) {
  return section.options.size() == 1 && section.options[0].type == OptionType::free_table;
}

// What says in a section what a key of other sections says there; empty: nothing does.
std::string here_it_is(const CaseSchema& schema, const std::string& name, const std::string& key) {
  std::string hint;
  for (const Section& section : schema.sections())
    for (const Option& option : section.options)
      if (section.name == name &&
          std::find(option.elsewhere.begin(), option.elsewhere.end(), key) != option.elsewhere.end())
        hint += (hint.empty() ? "; here it is '" : ", '") + option.key + "'";
  return hint;
}

// Every key of a table must be an option of its section or a section below it.
void refuse_unknown_keys(const CaseSchema& schema, const Node& table, const std::string& name, bool repeated,
                         Problems& problems) {
  std::vector<std::string> known, elsewhere;
  std::map<std::string, std::string> owner;
  for (const Section& section : schema.sections()) {
    if (section.name == name) {
      for (const Option& option : section.options) known.push_back(option.key);
    } else {
      if (name.empty() && section.name.find('.') == std::string::npos) known.push_back(section.name);
      if (section.name.rfind(name + ".", 0) == 0) known.push_back(section.name.substr(name.size() + 1));
      // No hint leads to a section that no method takes.
      const bool taken = section.owners.all || !section.owners.names.empty();
      for (const Option& option : section.options)
        if (taken) owner.emplace(option.key, section.name);
    }
  }
  for (std::size_t i = 0; i < table.keys.size(); ++i) {
    const std::string& key = table.keys[i];
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const Node& child = table.children[i];
    const bool section = name.empty() && (child.kind == Node::Kind::table || child.kind == Node::Kind::array);
    std::string hint = here_it_is(schema, name, key);
    if (hint.empty()) hint = did_you_mean(key, known);
    if (hint.empty() && owner.count(key) && !owner[key].empty())
      hint = "; '" + key + "' belongs into [" + owner[key] + "]";
    if (hint.empty() && owner.count(key)) hint = "; '" + key + "' belongs above the first section";
    if (hint.empty() && !section) {
      hint = "; known keys: ";
      for (std::size_t k = 0; k < known.size(); ++k) hint += (k ? ", " : "") + known[k];
    }
    problems.add_key(
        child,
        (section ? "unknown section [" + key + "]" : "unknown key '" + key + "'" + in_section(name, repeated)) + hint);
  }
}

void read_repeated(const CaseSchema& schema, const Section& section, const Node* list, const Node& document,
                   const std::string& method, Draft& draft, Problems& problems) {
  if (!list) return;
  if (list->kind != Node::Kind::array) {
    problems.add_key(*list, list->kind == Node::Kind::table ? "[" + section.name + "] must be written [[" +
                                                                  section.name + "]]: there may be several"
                                                            : "'" + section.name + "' must be a section [[" +
                                                                  section.name + "]], found " + kind_in_words(*list));
    draft.bad[section.name] = true;
    return;
  }
  for (std::size_t i = 0; i < list->children.size(); ++i) {
    const Node& entry = list->children[i];
    const std::string prefix = section.name + "." + std::to_string(i);
    if (entry.kind != Node::Kind::table) {
      problems.add(entry, prefix + " must be a table, found " + kind_in_words(entry));
      draft.bad[section.name] = true;
      continue;
    }
    section.begin_entry(draft);
    draft.given[prefix] = &entry;
    SectionReader(schema, draft, problems, section, prefix, method).read(&entry, document);
    refuse_unknown_keys(schema, entry, section.name, true, problems);
  }
}

}  // namespace

const Node* find_section(const Node& document, const std::string& name) {
  const Node* at = &document;
  for (std::size_t first = 0; !name.empty() && first <= name.size() && at;) {
    const std::size_t dot = std::min(name.find('.', first), name.size());
    at = at->find(name.substr(first, dot - first));
    first = dot + 1;
  }
  return at;
}

void read_document(const Node& document, const CaseSchema& schema, Draft& draft, Problems& problems) {
  const std::string method = schema.method_of(document);
  schema.declare_groups(draft.options, method);
  for (const Section& section : schema.sections()) {
    const Node* table = find_section(document, section.name);
    if (!section.owners.include(method)) {
      if (table)
        problems.add_key(*table,
                         "[" + section.name + "]" + belongs_elsewhere(section.owners, method) + "; remove the section");
      continue;
    }
    if (table) draft.given[section.name] = table;
    if (section.repeated) {
      read_repeated(schema, section, table, document, method, draft, problems);
      continue;
    }
    if (table && table->kind != Node::Kind::table) {
      problems.add_key(
          *table, "'" + section.name + "' must be a section [" + section.name + "], found " + kind_in_words(*table));
      draft.bad[section.name] = true;
      continue;
    }
    if (is_free(section)) continue;
    SectionReader(schema, draft, problems, section, section.name, method).read(table, document);
    if (table) refuse_unknown_keys(schema, *table, section.name, false, problems);
  }
}

}  // namespace spume
