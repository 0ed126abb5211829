// SPDX-License-Identifier: MIT
#include "spume/scene/options.hpp"

#include "option.hpp"

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

std::string method_of(const Node& document) {
  const Node* node = document.find("method");
  if (!node || node->kind != Node::Kind::string) return {};
  const std::vector<std::string>& known = sections()[0].options[1].words;
  return std::find(known.begin(), known.end(), node->text) == known.end() ? std::string{} : node->text;
}

const std::vector<Section>& sections() {
  static const std::vector<Section> table = [] {
    std::vector<Section> all;
    for (auto part : {scene_sections(), bubble_sections(), method_sections(), spectral_sections(), particle_sections()})
      all.insert(all.end(), part.begin(), part.end());
    for (Section& section : all) {
      for (Option& option : section.options) option.section = section.name;
    }
    return all;
  }();
  return table;
}

const std::vector<OptionInfo>& option_table() {
  static const std::vector<OptionInfo> table = [] {
    std::vector<OptionInfo> rows;
    for (const Section& section : sections()) {
      for (const Option& option : section.options) {
        std::string type = type_in_words(option.type);
        for (const std::string article : {"an ", "a "}) {
          if (type.rfind(article, 0) == 0) type.erase(0, article.size());
        }
        if (const std::size_t bracket = type.find(" ("); bracket != std::string::npos) type.erase(bracket);
        std::string owners;
        for (const std::string& method : option.methods.empty() ? section.methods : option.methods)
          owners += (owners.empty() ? "" : ", ") + method;
        std::string default_text = option.default_text;
        if (option.required)
          default_text = "(required)";
        else if (default_text.empty())
          default_text = "(" + option.absent + ")";
        rows.push_back({option.section, option.key, type, option.unit, default_text,
                        option.words.empty() ? option.range.in_words() : "one of " + words_in_words(option.words),
                        option.description + (owners.empty() ? "" : " [" + owners + "]")});
      }
    }
    return rows;
  }();
  return table;
}

}  // namespace spume
