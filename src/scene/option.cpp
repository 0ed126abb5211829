// SPDX-License-Identifier: MIT
#include "spume/scene/option.hpp"

#include <algorithm>
#include <utility>

namespace spume {

bool Range::contains(double value) const {
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::in_words() const {
  std::string words;
  if (low > -unbounded) words = (low_open ? "> " : ">= ") + shortest(low);
  if (high < unbounded)
    words += (words.empty() ? "" : " and ") + std::string(high_open ? "< " : "<= ") + shortest(high);
  return words;
}

bool Owners::include(const std::string& method) const {
  return all || method.empty() || std::find(names.begin(), names.end(), method) != names.end();
}

SectionChain::SectionChain(const std::string& section_name, std::function<void*(Draft&)> target)
    : target_(std::move(target)) {
  name = section_name;
}

void SectionChain::add(const char* key, OptionType type, const char* unit, const std::string& default_text,
                       const Range& range, const char* description, Assign assign) {
  options.push_back({.key = key,
                     .type = type,
                     .unit = unit,
                     .default_text = default_text,
                     .range = range,
                     .description = description,
                     .set = [target = target_, assign = std::move(assign)](Draft& d, const Value& value) {
                       assign(target(d), d, value);
                     }});
}

void SectionChain::add_word(const char* key, std::vector<std::string> words, std::size_t standard,
                            const char* description, AssignWord assign) {
  Option option{.key = key, .type = OptionType::word, .words = words, .description = description};
  if (standard < words.size()) option.default_text = to_toml_string(words[standard]);
  option.set = [target = target_, words = std::move(words), assign = std::move(assign)](Draft& d, const Value& value) {
    const auto found = std::find(words.begin(), words.end(), value.text);
    if (found != words.end()) assign(target(d), d, static_cast<std::size_t>(found - words.begin()));
  };
  options.push_back(std::move(option));
}

void SectionChain::make_required() {
  options.back().required = true;
  options.back().default_text.clear();
}

void SectionChain::set_absent(const std::string& meaning) {
  options.back().absent = meaning;
  options.back().default_text.clear();
}

void SectionChain::set_needs(const char* key, std::initializer_list<const char*> words) {
  options.back().needs = {key, {words.begin(), words.end()}};
}

void SectionChain::set_chosen(std::function<std::string(const Draft&)> value) {
  options.back().chosen = std::move(value);
}

std::string type_in_words(OptionType type) {
  switch (type) {
    case OptionType::number:
      return "a number";
    case OptionType::integer:
      return "an integer";
    case OptionType::boolean:
      return "true or false";
    case OptionType::string:
      return "a string";
    case OptionType::word:
      return "a word";
    case OptionType::expression:
      return "an expression (a string or a number)";
    case OptionType::numbers:
      return "a list of numbers";
    case OptionType::strings:
      return "a list of strings";
    case OptionType::expressions:
      return "a list of expressions (strings or numbers)";
    case OptionType::integers:
      return "an integer or a list of integers";
    case OptionType::points:
      return "a list of points [<number>, <number>]";
    case OptionType::free_table:
      return "a table";
  }
  return {};
}

std::string words_in_words(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + to_toml_string(words[i]);
  }
  return text;
}

}  // namespace spume
