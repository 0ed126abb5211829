// SPDX-License-Identifier: MIT
#include "resolved.hpp"

#include <algorithm>
#include <filesystem>

#include "checks.hpp"
#include "reader.hpp"

namespace spume {
namespace {

class Writer {
 public:
  Writer(const Node& document, const CaseSchema& schema, const Draft& draft)
      : document_(document), schema_(schema), draft_(draft) {}

  std::string write() {
    for (const Section& section : schema_.sections()) {
      if (!section.owners.include(draft_.options.method)) continue;
      const Node* table = find_section(document_, section.name);
      if (section.repeated) {
        for (std::size_t i = 0; table && i < table->children.size(); ++i) {
          text_ += "\n[[" + section.name + "]]\n";
          options(section, &table->children[i]);
        }
      } else if (section.options[0].type == OptionType::free_table) {
        if (table) free_table(section.name, *table);
      } else {
        // Sections in which nothing is set and nothing has a default would be all comments.
        const bool empty = !table && std::none_of(section.options.begin(), section.options.end(), [&](const Option& o) {
          return !o.default_text.empty() && o.owners.include(draft_.options.method);
        });
        if (empty || (!table && section.optional)) continue;
        if (!section.name.empty()) text_ += "\n[" + section.name + "]\n";
        options(section, table);
      }
    }
    return text_;
  }

 private:
  std::string unit_in_case(const std::string& unit) const {
    if (!uses_si(draft_)) return unit;
    if (unit == "length") return "m";
    if (unit == "time") return "s";
    if (unit == "length/time") return "m/s";
    return unit == "length/time2" ? "m/s2" : unit;
  }

  static std::string origin(const Node& node) {
    return node.override_text.empty() ? "case" : node.override_text.substr(0, node.override_text.find(' '));
  }

  void line(const std::string& assignment, const std::string& comment) {
    text_ += assignment;
    if (assignment.size() < 40) text_.append(40 - assignment.size(), ' ');
    text_ += "  # " + comment + "\n";
  }

  void options(const Section& section, const Node* table) {
    for (const Option& option : section.options) {
      if (!option.owners.include(draft_.options.method)) continue;
      const Node* node = table ? table->find(option.key) : nullptr;
      const std::string unit = unit_in_case(option.unit);
      const std::string tail = unit.empty() || unit == "1" ? "" : ", " + unit;
      if (node) {
        if (option.beside_case && node->kind == Node::Kind::string) {
          const auto folder = std::filesystem::absolute(draft_.options.path).parent_path();
          line(option.key + " = " + to_toml_string((folder / node->text).lexically_normal().string()), origin(*node));
          continue;
        }
        // A title of digits from the command line is text.
        const bool quoted = option.type == OptionType::string && node->kind != Node::Kind::string;
        line(option.key + " = " + (quoted ? to_toml_string(node->raw) : to_toml(*node)), origin(*node) + tail);
      } else if (section.name.empty() && option.key == "title") {
        line("title = " + to_toml_string(draft_.options.title), "default");
      } else if (!option.default_text.empty()) {
        line(option.key + " = " + option.default_text, "default" + tail);
      } else if (option.chosen) {
        line(option.key + " = " + option.chosen(draft_), "default" + tail);
      } else {
        line("# " + option.key, "not set: " + option.absent + tail);
      }
    }
  }

  void free_table(const std::string& name, const Node& table) {
    text_ += "\n[" + name + "]\n";
    for (std::size_t i = 0; i < table.keys.size(); ++i) {
      if (table.children[i].kind == Node::Kind::table) continue;
      line(to_toml_key(table.keys[i]) + " = " + to_toml(table.children[i]), origin(table.children[i]));
    }
    for (std::size_t i = 0; i < table.keys.size(); ++i) {
      if (table.children[i].kind == Node::Kind::table)
        free_table(name + "." + to_toml_key(table.keys[i]), table.children[i]);
    }
  }

  const Node& document_;
  const CaseSchema& schema_;
  const Draft& draft_;
  std::string text_;
};

}  // namespace

std::string resolved_text(const Node& document, const CaseSchema& schema, const Draft& draft) {
  return Writer(document, schema, draft).write();
}

}  // namespace spume
