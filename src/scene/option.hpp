// SPDX-License-Identifier: MIT
// The declaration of an option: all that the reader, the messages, `spume options` and the resolved case know.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "draft.hpp"

namespace spume {

enum class OptionType {
  number,
  integer,
  boolean,
  string,
  word,
  expression,
  numbers,
  strings,
  expressions,
  integers,
  free_table
};

struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;  // the bound itself is excluded
  bool high_open = false;
  bool contains(double value) const;
  std::string in_words() const;  // "> 0 and <= 1"; "" without bounds
};
inline constexpr double unbounded = std::numeric_limits<double>::infinity();
inline Range positive() {
  return {0, unbounded, true, false};
}
inline Range not_negative() {
  return {0, unbounded, false, false};
}
inline Range between(double low, double high) {
  return {low, high, false, false};
}
inline Range above_up_to(double low, double high) {
  return {low, high, true, false};
}

// A value of an option's type, read from the file or from the default text.
struct Value {
  double number = 0;
  std::int64_t integer = 0;
  bool boolean = false;
  std::string text;
  std::vector<double> numbers;
  std::vector<std::int64_t> integers;
  std::vector<std::string> texts;
  ExpressionText expression;
  std::vector<ExpressionText> expressions;
};

// Methods that an option or a section belongs to; empty: all.
using Methods = std::vector<std::string>;
inline bool belongs(const Methods& methods, const std::string& method) {
  return methods.empty() || method.empty() || std::find(methods.begin(), methods.end(), method) != methods.end();
}

// What an option takes effect with: another option of its section with one of these words ("true" of a switch).
struct Needs {
  std::string key = {};
  std::vector<std::string> words = {};
};

struct Option {
  std::string section = {};
  std::string key = {};
  OptionType type = OptionType::number;
  std::string unit = {};
  std::string default_text = {};                         // TOML; empty: none
  std::string absent = {};                               // what an absent value means, when there is no default
  std::function<std::string(const Draft&)> chosen = {};  // the value that an absent one got from the scene, as TOML
  bool required = false;
  Range range = {};
  std::vector<std::string> words = {};
  std::string description = {};
  std::function<void(Draft&, const Value&)> set = {};
  Methods methods = {};
  Needs needs = {};          // no words: always
  bool beside_case = false;  // a path from the folder of the case; the resolved case, elsewhere, names it in full
};

// The option, of use only where another one of its section has one of these words.
inline Option with(Needs needs, Option option) {
  option.needs = std::move(needs);
  return option;
}

struct Section {
  std::string name;
  bool repeated = false;                      // written [[name]], any number of times
  std::function<void(Draft&)> begin_entry{};  // of a repeated section: appends an empty entry
  std::vector<Option> options{};
  Methods methods{};
  bool optional = false;  // a case without it does without its subject: the resolved case leaves it out too
};

// The method that a document names; empty when it names none that exists.
std::string method_of(const Node& document);

// All sections in the order of the resolved case; the first has no name.
const std::vector<Section>& sections();

// Parts of the table, by subject.
std::vector<Section> scene_sections();     // domain, solids, fluid, liquid
std::vector<Section> bubble_sections();    // bubbles, spargers, clouds
std::vector<Section> method_sections();    // turbulence ... output, probes
std::vector<Section> particle_sections();  // particles
std::vector<Section> spectral_sections();  // spectral, forcing

// "a number", "a list of expressions", ...
std::string type_in_words(OptionType type);
// "one of "a", "b" or "c"".
std::string words_in_words(const std::vector<std::string>& words);

}  // namespace spume
