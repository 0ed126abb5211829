// SPDX-License-Identifier: MIT
#include "spume/scene/expression.hpp"

#include <muParser.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <numbers>
#include <set>

#include "spume/scene/document.hpp"

namespace spume {
namespace {

bool name_start(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) || c == '_';
}
bool name_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}
bool digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c));
}

void define_common(mu::Parser& parser) {
  parser.DefineConst("pi", std::numbers::pi);
  parser.DefineConst("e", std::numbers::e);
  parser.DefineFun("floor", static_cast<mu::fun_type1>([](double v) { return std::floor(v); }));
  parser.DefineFun("ceil", static_cast<mu::fun_type1>([](double v) { return std::ceil(v); }));
  parser.DefineFun("cbrt", static_cast<mu::fun_type1>([](double v) { return std::cbrt(v); }));
  parser.DefineFun("erf", static_cast<mu::fun_type1>([](double v) { return std::erf(v); }));
  parser.DefineFun("mod", static_cast<mu::fun_type2>([](double a, double b) { return a - b * std::floor(a / b); }));
}

const std::set<std::string>& function_names() {
  static const std::set<std::string> names = [] {
    mu::Parser parser;
    define_common(parser);
    std::set<std::string> found;
    for (const auto& entry : parser.GetFunDef()) found.insert(entry.first);
    return found;
  }();
  return names;
}

struct Name {
  std::size_t position;
  std::string text;
};

// The names in an expression. Numbers are stepped over with their exponent, so that 1e5 holds no name.
std::vector<Name> scan_names(const std::string& text) {
  std::vector<Name> names;
  for (std::size_t i = 0; i < text.size();) {
    if (digit(text[i]) || text[i] == '.') {
      while (i < text.size() && (digit(text[i]) || text[i] == '.')) ++i;
      if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        std::size_t j = i + 1;
        if (j < text.size() && (text[j] == '+' || text[j] == '-')) ++j;
        if (j < text.size() && digit(text[j])) {
          while (j < text.size() && digit(text[j])) ++j;
          i = j;
        }
      }
    } else if (name_start(text[i])) {
      const std::size_t first = i;
      while (i < text.size() && name_char(text[i])) ++i;
      names.push_back({first, text.substr(first, i - first)});
    } else {
      ++i;
    }
  }
  return names;
}

// What muParser would accept and a case file must not: characters of other alphabets, strings, assignments.
void refuse_odd_characters(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool blank = c == ' ' || c == '\t' || c == '\n' || c == '\r';
    if (!blank && !name_char(c) && std::string("+-*/^()<>=!&|?:,.").find(c) == std::string::npos) {
      throw ExpressionError(i, std::isprint(static_cast<unsigned char>(c))
                                   ? std::string("unexpected character '") + c + "'"
                                   : "unexpected character; only plain ASCII can stand in an expression");
    }
    const char before = i > 0 ? text[i - 1] : ' ', after = i + 1 < text.size() ? text[i + 1] : ' ';
    if (c == '=' && after != '=' && std::string("=<>!").find(before) == std::string::npos) {
      throw ExpressionError(i, "unexpected '='; an expression assigns nothing (to compare, write ==)");
    }
  }
}

// Parentheses are checked here because muParser reports a missing one at the end without its partner.
void check_parentheses(const std::string& text) {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '(') open.push_back(i);
    if (text[i] == ')') {
      if (open.empty()) throw ExpressionError(i, "unmatched ')'");
      open.pop_back();
    }
  }
  if (!open.empty()) throw ExpressionError(open.back(), "this '(' is never closed");
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) throw ExpressionError(0, "the expression is empty");
}

[[noreturn]] void rethrow(const mu::Parser::exception_type& error, const std::string& text) {
  std::string message = error.GetMsg();
  // The place is given by line and column of the case file instead.
  for (const char* tail : {" found at position", " at position", " at expression position"}) {
    const std::size_t found = message.find(tail);
    if (found != std::string::npos) message.erase(found);
  }
  for (char& c : message) c = c == '"' ? '\'' : c;
  if (!message.empty()) message[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(message[0])));
  std::size_t position = error.GetPos() < 0 ? text.size() : static_cast<std::size_t>(error.GetPos());
  const std::string& token = error.GetToken();
  const bool about_arguments = error.GetCode() == mu::ecTOO_MANY_PARAMS || error.GetCode() == mu::ecTOO_FEW_PARAMS;
  if (about_arguments && !token.empty()) {
    const std::size_t found = text.rfind(token, position);
    if (found != std::string::npos) position = found;
  }
  throw ExpressionError(std::min(position, text.size()), message);
}

class ConstantExpression final : public Expression {
 public:
  explicit ConstantExpression(double value) : value_(value) {}
  double operator()(double, double, double, double) const override { return value_; }
  std::unique_ptr<Expression> clone() const override { return std::make_unique<ConstantExpression>(value_); }

 private:
  double value_;
};

// What a compiled expression is built from; shared by its clones.
struct Recipe {
  int dimensions = 3;
  std::string text;
  struct Part {
    std::string name, text;
    unsigned coordinates;  // bits of the coordinates that it depends on
  };
  std::vector<Part> parts;  // varying constants, each after those it uses
  std::vector<std::pair<std::string, double>> numbers;
};

class Evaluator {
 public:
  explicit Evaluator(std::shared_ptr<const Recipe> recipe)
      : recipe_(std::move(recipe)), part_values_(recipe_->parts.size()) {
    for (std::size_t i = 0; i < recipe_->parts.size(); ++i) {
      parts_.push_back(std::make_unique<mu::Parser>());
      prepare(*parts_.back(), i);
      parts_.back()->SetExpr(recipe_->parts[i].text);
    }
    prepare(main_, recipe_->parts.size());
    main_.SetExpr(recipe_->text);
    (*this)(0, 0, 0, 0);  // compiles to bytecode, so that errors appear here
    if (main_.GetNumResults() != 1) {
      throw ExpressionError(recipe_->text.find(','), "unexpected ','; one value is expected");
    }
  }

  double operator()(double x, double y, double z, double t) const {
    // A part is evaluated again only when a coordinate that it depends on has other bits: down a column of
    // particles the shape of the surface is computed once. Bits, because 1/x differs between 0 and -0.
    const std::array<double, 4> now{x, y, z, t};
    unsigned changed = fresh_ ? 15u : 0u;
    for (std::size_t c = 0; c < 4; ++c) {
      changed |= std::bit_cast<std::uint64_t>(now[c]) != std::bit_cast<std::uint64_t>(coordinates_[c]) ? 1u << c : 0u;
    }
    coordinates_ = now;
    fresh_ = false;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (recipe_->parts[i].coordinates & changed) part_values_[i] = parts_[i]->Eval();
    }
    return main_.Eval();
  }

 private:
  void prepare(mu::Parser& parser, std::size_t parts_known) {
    define_common(parser);
    parser.DefineVar("x", &coordinates_[0]);
    parser.DefineVar("y", &coordinates_[1]);
    if (recipe_->dimensions == 3) parser.DefineVar("z", &coordinates_[2]);
    parser.DefineVar("t", &coordinates_[3]);
    for (const auto& [name, number] : recipe_->numbers) parser.DefineConst(name, number);
    for (std::size_t i = 0; i < parts_known; ++i) parser.DefineVar(recipe_->parts[i].name, &part_values_[i]);
  }

  std::shared_ptr<const Recipe> recipe_;
  mutable std::array<double, 4> coordinates_{};
  mutable bool fresh_ = true;  // no part has a value yet
  mutable std::vector<double> part_values_;
  std::vector<std::unique_ptr<mu::Parser>> parts_;
  mu::Parser main_;
};

// Those of one expression that no copy of it uses. A sweep makes a copy for every block of particles: to parse the text
// takes 100 us, to evaluate it 0.1.
class Evaluators {
 public:
  explicit Evaluators(std::shared_ptr<const Recipe> recipe) : recipe_(std::move(recipe)) {}

  std::unique_ptr<Evaluator> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Evaluator> one = std::move(idle_.back());
        idle_.pop_back();
        return one;
      }
      idle_.reserve(++made_);
    }
    return std::make_unique<Evaluator>(recipe_);
  }
  void give_back(std::unique_ptr<Evaluator> one) {  // allocates nothing: there is room for all
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(one));
  }

 private:
  const std::shared_ptr<const Recipe> recipe_;
  std::mutex mutex_;
  std::size_t made_ = 0;
  std::vector<std::unique_ptr<Evaluator>> idle_;
};

class ParsedExpression final : public Expression {
 public:
  explicit ParsedExpression(std::shared_ptr<Evaluators> all) : all_(std::move(all)), own_(all_->take()) {}
  ~ParsedExpression() override { all_->give_back(std::move(own_)); }
  ParsedExpression(const ParsedExpression&) = delete;
  ParsedExpression& operator=(const ParsedExpression&) = delete;

  double operator()(double x, double y, double z, double t) const override { return (*own_)(x, y, z, t); }
  std::unique_ptr<Expression> clone() const override { return std::make_unique<ParsedExpression>(all_); }

 private:
  std::shared_ptr<Evaluators> all_;
  std::unique_ptr<Evaluator> own_;
};

}  // namespace

ExpressionScope::ExpressionScope(int dimensions) : dimensions_(dimensions) {}

ExpressionScope::Names ExpressionScope::names_in(const std::string& text) const {
  Names names;
  for (const Name& name : scan_names(text)) {
    const std::size_t coordinate = name.text.size() == 1 ? std::string("xyzt").find(name.text) : std::string::npos;
    if (coordinate != std::string::npos) {
      if (name.text == "z" && dimensions_ == 2) {
        throw ExpressionError(name.position, "z in a two-dimensional case; up is y");
      }
      names.coordinates |= 1u << coordinate;
    } else if (constants_.count(name.text)) {
      if (std::find(names.constants.begin(), names.constants.end(), name.text) == names.constants.end()) {
        names.constants.push_back(name.text);
      }
    } else if (name.text != "pi" && name.text != "e" && !function_names().count(name.text)) {
      std::vector<std::string> known{"x", "y", "t", "pi", "e"};
      if (dimensions_ == 3) known.push_back("z");
      for (const auto& entry : constants_) known.push_back(entry.first);
      known.insert(known.end(), function_names().begin(), function_names().end());
      std::string suggestion = did_you_mean(name.text, known);
      if (suggestion.empty()) suggestion = "; define it in [constants]";
      throw ExpressionError(name.position, "unknown name '" + name.text + "'" + suggestion);
    }
  }
  return names;
}

void ExpressionScope::order_varying(const std::string& name, std::vector<std::string>& ordered) const {
  if (std::find(ordered.begin(), ordered.end(), name) != ordered.end()) return;
  const Constant& constant = constants_.at(name);
  if (constant.coordinates == 0) return;
  for (const std::string& used : constant.uses) order_varying(used, ordered);
  ordered.push_back(name);
}

std::unique_ptr<Expression> ExpressionScope::build(const std::string& text, const Names& names) const {
  auto recipe = std::make_shared<Recipe>();
  recipe->dimensions = dimensions_;
  recipe->text = text;
  std::vector<std::string> ordered;
  unsigned coordinates = names.coordinates;
  for (const std::string& name : names.constants) {
    if (constants_.at(name).faulty) return constant_expression(std::nan(""));
    coordinates |= constants_.at(name).coordinates;
    order_varying(name, ordered);
  }
  std::set<std::string> numbers(names.constants.begin(), names.constants.end());
  for (const std::string& name : ordered) {
    recipe->parts.push_back({name, constants_.at(name).text, constants_.at(name).coordinates});
    numbers.insert(constants_.at(name).uses.begin(), constants_.at(name).uses.end());
  }
  for (const std::string& name : numbers) {
    if (const auto& number = constants_.at(name).number) recipe->numbers.emplace_back(name, *number);
  }
  try {
    auto parsed = std::make_unique<ParsedExpression>(std::make_shared<Evaluators>(recipe));
    if (coordinates != 0) return parsed;
    return constant_expression((*parsed)(0, 0, 0, 0));
  } catch (const mu::Parser::exception_type& error) {
    rethrow(error, text);
  }
}

void ExpressionScope::refuse_time(const std::string& text) const {
  for (const Name& name : scan_names(text)) {
    const auto constant = constants_.find(name.text);
    const std::string hint = "; this describes the start and is a function of " +
                             std::string(dimensions_ == 3 ? "x, y and z" : "x and y") + " only";
    if (name.text == "t") throw ExpressionError(name.position, "unknown name 't'" + hint);
    if (constant != constants_.end() && (constant->second.coordinates & 8u) != 0)
      throw ExpressionError(name.position, "the constant '" + name.text + "' depends on t" + hint);
  }
}

std::unique_ptr<Expression> ExpressionScope::compile(const std::string& text, Arguments arguments) const {
  refuse_odd_characters(text);
  check_parentheses(text);
  const Names names = names_in(text);
  if (arguments == Arguments::place) refuse_time(text);
  return build(text, names);
}

std::vector<ExpressionScope::Fault> ExpressionScope::define(
    const std::vector<std::pair<std::string, std::string>>& constants) {
  std::vector<Fault> faults;
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < constants.size(); ++i) {
    const std::string& name = constants[i].first;
    const bool plain = !name.empty() && name_start(name[0]) && std::all_of(name.begin(), name.end(), name_char);
    const bool taken = name == "x" || name == "y" || name == "z" || name == "t" || name == "pi" || name == "e" ||
                       function_names().count(name);
    if (!plain) {
      faults.push_back({i, std::string::npos, "a name consists of letters, digits and _, and starts with a letter"});
    } else if (taken) {
      faults.push_back({i, std::string::npos, "this name is taken; choose another"});
    } else {
      index[name] = i;
      constants_[name] = {};
      constants_[name].text = constants[i].second;
    }
  }
  const auto fail = [&](const std::string& name, std::size_t position, const std::string& text) {
    constants_[name].faulty = true;
    faults.push_back({index[name], position, text});
  };
  for (const auto& [name, i] : index) {
    Constant& constant = constants_[name];
    try {
      refuse_odd_characters(constant.text);
      check_parentheses(constant.text);
      const Names names = names_in(constant.text);
      constant.uses = names.constants;
      constant.coordinates = names.coordinates;
    } catch (const ExpressionError& error) {
      fail(name, error.position(), error.what());
    }
  }

  // Depth first: a constant is finished after all that it uses; meeting an unfinished one again is a cycle.
  std::map<std::string, int> state;  // 0 new, 1 open, 2 finished
  std::vector<std::string> path;
  const auto visit = [&](const auto& self, const std::string& name) -> void {
    Constant& constant = constants_[name];
    if (state[name] == 2) return;
    if (state[name] == 1) {
      std::string loop;
      const auto first = std::find(path.begin(), path.end(), name);
      for (auto it = first; it != path.end(); ++it) loop += *it + " -> ";
      if (!constant.faulty) fail(name, 0, "the constants " + loop + name + " depend on each other");
      for (auto it = first; it != path.end(); ++it) constants_[*it].faulty = true;
      return;
    }
    state[name] = 1;
    path.push_back(name);
    for (const std::string& used : constant.uses) {
      self(self, used);
      constant.coordinates |= constants_[used].coordinates;
      constant.faulty = constant.faulty || constants_[used].faulty;
    }
    path.pop_back();
    state[name] = 2;
    if (constant.faulty) return;
    try {
      const auto expression = build(constant.text, {constant.uses, constant.coordinates});
      if (constant.coordinates != 0) return;
      constant.number = (*expression)(0, 0, 0, 0);
      if (!std::isfinite(*constant.number)) fail(name, 0, "its value is not finite");
    } catch (const ExpressionError& error) {
      fail(name, error.position(), error.what());
    }
  };
  for (const auto& entry : constants) {
    if (index.count(entry.first)) visit(visit, entry.first);
  }
  return faults;
}

std::optional<double> ExpressionScope::value(const std::string& constant) const {
  const auto found = constants_.find(constant);
  return found == constants_.end() ? std::nullopt : found->second.number;
}

std::unique_ptr<Expression> constant_expression(double value) {
  return std::make_unique<ConstantExpression>(value);
}

std::optional<double> constant_value(const Expression& expression) {
  if (!dynamic_cast<const ConstantExpression*>(&expression)) return std::nullopt;
  return expression(0, 0, 0, 0);
}

Vec3 VectorExpression::operator()(const Vec3& position, double t) const {
  Vec3 value{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (component[a]) value[a] = (*component[a])(position[0], position[1], position[2], t);
  }
  return value;
}

VectorExpression VectorExpression::clone() const {
  VectorExpression copy;
  for (std::size_t a = 0; a < 3; ++a) {
    if (component[a]) copy.component[a] = component[a]->clone();
  }
  return copy;
}

}  // namespace spume
