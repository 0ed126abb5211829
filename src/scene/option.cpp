// SPDX-License-Identifier: MIT
#include "spume/scene/option.hpp"

#include <algorithm>

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
