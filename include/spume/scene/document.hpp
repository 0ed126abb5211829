// SPDX-License-Identifier: MIT
// A case file as a tree of values that know their place, with the overrides of the command line merged in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spume/core/error.hpp"

namespace spume {

struct Place {
  int line = 0;  // 1-based; 0: no place in the file
  int column = 0;
  auto operator<=>(const Place&) const = default;  // NOLINT(modernize-use-nullptr): of the code that it stands for
};

struct Node {
  enum class Kind { table, array, string, integer, number, boolean, date };
  Kind kind = Kind::table;
  std::string text;  // contents of a string, or a date as written
  double number = 0;
  std::int64_t integer = 0;
  bool boolean = false;

  std::vector<std::string> keys;  // of a table, beside `children`, in file order
  std::vector<Node> children;     // values of a table or elements of an array

  Place place;                // of the value; of the header for a table
  Place key_place;            // of the key
  std::string override_text;  // "--set key=value" or "--until value" for a value from the command line, else empty
  std::string raw;            // that value as typed

  const Node* find(const std::string& key) const;
  Node* find(const std::string& key);
  Node& insert(const std::string& key, Node value);  // replaces an existing value
  bool is_number() const { return kind == Kind::integer || kind == Kind::number; }
};

// All problems of one case, put into file order (command-line problems last) when thrown.
class Problems {
 public:
  explicit Problems(std::string file) : file_(std::move(file)) {}
  void add(Place place, std::string text);
  void add(const Node& node, std::string text);      // at the value
  void add_key(const Node& node, std::string text);  // at the key
  // At character `offset` (0-based, bytes) of a string value; `source` is the text of the case file.
  void add_in_string(const Node& node, std::size_t offset, std::string text, const std::string& source);
  bool empty() const { return problems_.empty(); }
  void throw_if_any();
  // What a run takes and its user should know; at the value.
  void warn(const Node& node, std::string text);
  const std::vector<Problem>& warnings() const { return warnings_; }

 private:
  Problem at(const Node& node, std::string text) const;

  std::string file_;
  std::vector<Problem> problems_, warnings_;
};

// Parses TOML text; throws InputError with the place of the syntax error.
Node parse_document(const std::string& text, const std::string& file);

// Parses one TOML value; throws InputError.
Node parse_value(const std::string& text);

// Applies "a.b=c" or "a.0.b=c" to the document; `repeated` names the sections that are arrays of tables. An option of
// the command line in front, "--until time.end=20", takes the place of --set in messages and origins.
void apply_override(Node& document, const std::string& text, const std::vector<std::string>& repeated,
                    Problems& problems);

// The place of byte `offset` of the string literal that starts at `start` in `source`, escapes counted.
Place place_in_string(const std::string& source, Place start, std::size_t offset);

// "a string", "an integer", ... for messages.
std::string kind_in_words(const Node& node);

// TOML text of a value, on one line, that parses back to the same value.
std::string to_toml(const Node& node);
std::string to_toml_string(const std::string& text);
std::string to_toml_key(const std::string& key);
std::string to_toml_number(double value);  // never an integer: 30.0
std::string shortest(double value);        // shortest decimal text that reads back to the same double

// A number in a message: six digits.
std::string brief(double value);

// The candidate nearest to `word` by edit distance when near enough to be meant, else "".
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);
// "; did you mean 'x'?" or "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace spume
