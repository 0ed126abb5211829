// SPDX-License-Identifier: MIT
// The declaration of an option: all that the reader, the messages, `spume options` and the resolved case know of it.
// Type and default are those of the member that it fills. A section is declared in a chain of calls, one an option:
//
//   section<PressureOptions>("pressure")
//       .word("solver", &P::solver, {{"bicgstab", PressureSolver::bicgstab}, ...}, "Krylov method")
//       .option("tolerance", &P::tolerance, "1", above_up_to(0, 0.1), "residual relative to the right-hand side")
//       .option("cell_ratio", &P::cell_ratio, "spacing", between(1, 8), "side of the multigrid cells")
//       .when("preconditioner", {"multigrid"});
#pragma once

#include <array>
#include <concepts>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "spume/scene/draft.hpp"

namespace spume {

struct MethodDeclaration;
// What an option or a section is for: a property of the methods that take it. Null: every method takes it.
using MethodProperty = bool (*)(const MethodDeclaration&);

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
  points,
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
inline constexpr Range any_value{};
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
inline Range at_least(double low) {
  return {low, unbounded, false, false};
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
  std::vector<std::array<double, 2>> points;
  ExpressionText expression;
  std::vector<ExpressionText> expressions;
};

// The methods that take an option or a section.
struct Owners {
  bool all = true;
  std::vector<std::string> names;  // unless all do
  // True for the method, and where the case names none that exists: nobody then knows better.
  bool include(const std::string& method) const;
  bool operator==(const Owners&) const = default;
};

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
  std::function<std::string(const Draft&)> chosen = {};  // the value that an absent one got from the method, as TOML
  bool required = false;
  Range range = {};
  std::vector<std::string> words = {};
  std::vector<std::string> elsewhere = {};  // what it is called in other sections: a hint for who writes that
  std::string description = {};
  std::function<void(Draft&, const Value&)> set = {};
  MethodProperty property = nullptr;
  Owners owners = {};        // set by the schema
  Needs needs = {};          // no words: always
  bool steerable = false;    // may change while a run goes on
  bool one_alone = false;    // of a list: a value stands for a list of one
  bool beside_case = false;  // a path from the folder of the case; the resolved case, elsewhere, names it in full
};

// Compiles the expression of the option `name`, with the constants of the case. A fault is reported at its place and
// gives null.
enum class Arguments;
using CompileExpression =
    std::function<std::shared_ptr<const Expression>(const ExpressionText&, const std::string& name, Arguments)>;

struct Section {
  std::string name = {};
  bool repeated = false;                         // written [[name]], any number of times
  std::function<void(Draft&)> begin_entry = {};  // of a repeated section: appends an empty entry
  std::function<void(Case&)> declare = {};       // makes the group of options that the section fills
  // Makes of what was read what needs compiled expressions; runs after the checks, also when they found problems.
  std::function<void(Draft&, const CompileExpression&)> compile = {};
  std::vector<Option> options = {};
  MethodProperty property = nullptr;
  Owners owners = {};         // set by the schema
  bool optional = false;      // a case without it does without its subject: the resolved case leaves it out too
  std::string after = {};     // of a method's options in a section of the scene: the key behind which they stand
  bool after_output = false;  // of a method's section: listed behind those of the output, not before [time]
};

// What a member holds decides the type of its option, how a value gets into it, and the text of its default. A type
// without a text has no default: the option is then required, or says what its absence means.
namespace member {

// The member that `place` names: of the target, of the draft or of its case.
template <class T, class Place>
decltype(auto) reach(T& target, Draft& draft, const Place& place) {
  if constexpr (std::is_invocable_v<const Place&, T&>)
    return std::invoke(place, target);
  else if constexpr (std::is_invocable_v<const Place&, Draft&>)
    return std::invoke(place, draft);
  else
    return std::invoke(place, draft.options);
}
template <class T, class Place>
using Held =
    std::remove_cvref_t<decltype(reach(std::declval<T&>(), std::declval<Draft&>(), std::declval<const Place&>()))>;

template <class M>
constexpr OptionType type_of() {
  if constexpr (std::is_same_v<M, bool>) return OptionType::boolean;
  if constexpr (std::integral<M>) return OptionType::integer;
  if constexpr (std::is_same_v<M, std::string>) return OptionType::string;
  if constexpr (std::is_same_v<M, std::vector<double>>) return OptionType::numbers;
  if constexpr (std::is_same_v<M, std::vector<std::int64_t>>) return OptionType::integers;
  if constexpr (std::is_same_v<M, std::vector<std::string>>) return OptionType::strings;
  if constexpr (std::is_same_v<M, std::vector<std::array<double, 2>>>) return OptionType::points;
  if constexpr (std::is_same_v<M, std::optional<ExpressionText>>) return OptionType::expression;
  if constexpr (std::is_same_v<M, std::vector<ExpressionText>>) return OptionType::expressions;
  return OptionType::number;
}

template <class M>
void assign(M& target, const Value& value) {
  if constexpr (std::is_same_v<M, bool>)
    target = value.boolean;
  else if constexpr (std::integral<M>)
    target = static_cast<M>(value.integer);
  else if constexpr (std::is_same_v<M, std::string>)
    target = value.text;
  else if constexpr (std::is_same_v<M, std::vector<double>>)
    target = value.numbers;
  else if constexpr (std::is_same_v<M, std::vector<std::int64_t>>)
    target = value.integers;
  else if constexpr (std::is_same_v<M, std::vector<std::string>>)
    target = value.texts;
  else if constexpr (std::is_same_v<M, std::vector<std::array<double, 2>>>)
    target = value.points;
  else if constexpr (std::is_same_v<M, std::optional<ExpressionText>>)
    target = value.expression;
  else if constexpr (std::is_same_v<M, std::vector<ExpressionText>>)
    target = value.expressions;
  else
    target = value.number;  // double or std::optional<double>
}

template <class M>
std::string default_text(const M& standard) {
  if constexpr (std::is_same_v<M, bool>)
    return standard ? "true" : "false";
  else if constexpr (std::integral<M>)
    return std::to_string(standard);
  else if constexpr (std::is_same_v<M, double>)
    return to_toml_number(standard);
  else if constexpr (std::is_same_v<M, std::vector<std::string>>)
    return "[]";
  else
    return {};
}

}  // namespace member

// What a chain does whatever type its section fills: compiled once, where a template would be for every type.
class SectionChain : public Section {
 protected:
  using Assign = std::function<void(void* target, Draft&, const Value&)>;
  using AssignWord = std::function<void(void* target, Draft&, std::size_t word)>;

  SectionChain(const std::string& section_name, std::function<void*(Draft&)> target);
  void add(const char* key, OptionType type, const char* unit, const std::string& default_text, const Range& range,
           const char* description, Assign assign);
  // `standard`: the index of the default, or that behind the last.
  void add_word(const char* key, std::vector<std::string> words, std::size_t standard, const char* description,
                AssignWord assign);
  void make_required();
  void set_absent(const std::string& meaning);
  void set_needs(const char* key, std::initializer_list<const char*> words);
  void set_chosen(std::function<std::string(const Draft&)> value);

 private:
  std::function<void*(Draft&)> target_;
};

// A section whose options fill a T. The place of a value is a member of T, of Draft or of Case, or a function from one
// of these to it. What follows an option in the chain (when, absent, required, ...) speaks of that option.
template <class T>
class SectionOf : public SectionChain {
 public:
  using Target = std::function<T&(Draft&)>;
  SectionOf(const std::string& section_name, Target target)
      : SectionChain(section_name, [target = std::move(target)](Draft& d) -> void* { return &target(d); }) {}

  template <class Place>
  SectionOf& option(const char* key, Place place, const char* unit, Range range, const char* description) {
    using M = member::Held<T, Place>;
    T standard{};
    Draft draft;
    add(key, member::type_of<M>(), unit, member::default_text<M>(member::reach(standard, draft, place)), range,
        description, [place](void* target, Draft& d, const Value& value) {
          member::assign(member::reach(*static_cast<T*>(target), d, place), value);
        });
    return *this;
  }
  template <class Place>
  SectionOf& option(const char* key, Place place, const char* unit, const char* description) {
    return option(key, place, unit, any_value, description);
  }
  template <class Place>
  SectionOf& option(const char* key, Place place, const char* description) {
    return option(key, place, "", any_value, description);
  }

  // An option whose words stand for values of the member.
  template <class Place>
  SectionOf& word(const char* key, Place place,
                  std::initializer_list<std::pair<const char*, std::type_identity_t<member::Held<T, Place>>>> meanings,
                  const char* description) {
    T standard{};
    Draft draft;
    std::vector<std::string> words;
    std::vector<member::Held<T, Place>> values;
    std::size_t standard_word = meanings.size();
    for (const auto& [text, meaning] : meanings) {
      if (meaning == member::reach(standard, draft, place)) standard_word = words.size();
      words.emplace_back(text);
      values.push_back(meaning);
    }
    add_word(key, std::move(words), standard_word, description,
             [place, values = std::move(values)](void* target, Draft& d, std::size_t word) {
               member::reach(*static_cast<T*>(target), d, place) = values[word];
             });
    return *this;
  }

  SectionOf& required() {
    make_required();
    return *this;
  }
  // What it means that the case does not give it: the option has no default.
  SectionOf& absent(const std::string& meaning) {
    set_absent(meaning);
    return *this;
  }
  SectionOf& when(const char* key, std::initializer_list<const char*> words) {
    set_needs(key, words);
    return *this;
  }
  // Only methods with this property take the option.
  SectionOf& only(MethodProperty property_of_method) {
    options.back().property = property_of_method;
    return *this;
  }
  SectionOf& chosen(std::function<std::string(const Draft&)> value) {
    set_chosen(std::move(value));
    return *this;
  }
  // May change between two steps: the state of a run does not depend on it, as it would on the box or the spacing.
  SectionOf& steerable() {
    options.back().steerable = true;
    return *this;
  }
  SectionOf& beside_case() {
    options.back().beside_case = true;
    return *this;
  }
  SectionOf& or_one_alone() {
    options.back().one_alone = true;
    return *this;
  }
  SectionOf& elsewhere(const std::vector<std::string>& keys) {
    options.back().elsewhere = keys;
    return *this;
  }

  // Of the whole section: only methods with this property take it.
  SectionOf& whole_only(MethodProperty property_of_method) {
    property = property_of_method;
    return *this;
  }
  SectionOf& whole_optional() {
    optional = true;
    return *this;
  }
  SectionOf& behind(const char* key) {
    after = key;
    return *this;
  }
  SectionOf& behind_output() {
    after_output = true;
    return *this;
  }
};

// A section, or more options of a section of the scene, that fill a group of a method: Case::get<T>().
template <class T>
SectionOf<T> section(const std::string& name) {
  SectionOf<T> made(name, [](Draft& draft) -> T& { return draft.options.get<T>(); });
  made.declare = [](Case& options) { options.declare<T>(); };
  return made;
}

// A section that fills a part of the draft.
template <class T>
SectionOf<T> section(const std::string& name, typename SectionOf<T>::Target target) {
  return SectionOf<T>(name, std::move(target));
}

// A section [[name]] whose entries fill one element each of a list of the draft.
template <class T>
SectionOf<T> repeated_section(const std::string& name, std::function<std::vector<T>&(Draft&)> list) {
  SectionOf<T> made(name, [list](Draft& draft) -> T& { return list(draft).back(); });
  made.repeated = true;
  made.begin_entry = [list](Draft& draft) { list(draft).emplace_back(); };
  return made;
}

// "a number", "a list of expressions", ...
std::string type_in_words(OptionType type);
// "one of "a", "b" or "c"".
std::string words_in_words(const std::vector<std::string>& words);

}  // namespace spume
