// SPDX-License-Identifier: MIT
// Options that set a member of a group of options, declared in one line each.
#pragma once

#include <type_traits>
#include <utility>

#include "option.hpp"

namespace spume {

// A setter for a member of a group of options: set(&Case::time, &TimeOptions::end).
template <class Group, class Member>
std::function<void(Draft&, const Value&)> set(Group Case::*group, Member Group::*member) {
  return [group, member](Draft& d, const Value& v) {
    Member& target = d.options.*group.*member;
    if constexpr (std::is_same_v<Member, bool>) {
      target = v.boolean;
    } else if constexpr (std::is_same_v<Member, int>) {
      target = static_cast<int>(v.integer);
    } else if constexpr (std::is_same_v<Member, double>) {
      target = v.number;
    } else {
      target = v.texts;
    }
  };
}

// An option whose words stand for the values of an enumeration.
template <class Group, class Word>
Option word_option(const char* key, const char* standard, const char* description, Group Case::*group,
                   Word Group::*member,
                   const std::vector<std::pair<std::string, std::type_identity_t<Word>>>& meanings) {
  Option option{.key = key, .type = OptionType::word, .default_text = standard, .description = description};
  for (const auto& meaning : meanings) option.words.push_back(meaning.first);
  option.set = [=](Draft& d, const Value& v) {
    for (const auto& [word, value] : meanings) {
      if (word == v.text) d.options.*group.*member = value;
    }
  };
  return option;
}

template <class Group, class Member>
Option option(const char* key, const char* unit, const char* standard, Range range, const char* description,
              Group Case::*group, Member Group::*member, const Methods& methods = {}) {
  const OptionType type = std::is_same_v<Member, bool>     ? OptionType::boolean
                          : std::is_same_v<Member, int>    ? OptionType::integer
                          : std::is_same_v<Member, double> ? OptionType::number
                                                           : OptionType::strings;
  return {.key = key,
          .type = type,
          .unit = unit,
          .default_text = standard,
          .range = range,
          .description = description,
          .set = set(group, member),
          .methods = methods};
}

}  // namespace spume
