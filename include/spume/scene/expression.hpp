// SPDX-License-Identifier: MIT
// Expressions of the case file: text in x, y, z, t and the constants of [constants], compiled by muParser.
//
// Operators + - * / ^ (right-associative, binds tighter than a minus sign), comparisons, && ||, and
// condition ? a : b; the numbers pi and e; the functions of muParser (sin ... atan2, sqrt, exp, log = ln,
// min, max, abs, sign, rint ...) and floor, ceil, mod(a, b), cbrt, erf.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "spume/scene/scene.hpp"

namespace spume {

// A text that is not an expression: `position` is the 0-based byte where the fault was noticed.
class ExpressionError : public std::runtime_error {
 public:
  ExpressionError(std::size_t position, const std::string& text) : std::runtime_error(text), position_(position) {}
  std::size_t position() const { return position_; }

 private:
  std::size_t position_;
};

// What an expression may depend on. The start of a run is described by the place alone.
enum class Arguments { place_and_time, place };

// The names that expressions may use, and the compiler.
class ExpressionScope {
 public:
  explicit ExpressionScope(int dimensions = 3);

  // A fault in the definition of a constant.
  struct Fault {
    std::size_t constant;  // index into the list given to define
    std::size_t position;  // 0-based byte in its text; npos for a fault of the name itself
    std::string text;
  };

  // Adds named expressions, which may use each other in any order. Those that depend on x, y, z or t are
  // evaluated at every call, once each; the others become numbers. Returns every fault found; an expression
  // that uses a faulty constant compiles, without a second report, to not-a-number.
  std::vector<Fault> define(const std::vector<std::pair<std::string, std::string>>& constants);

  // Throws ExpressionError. The result is not thread-safe; its clone() is independent of it.
  std::unique_ptr<Expression> compile(const std::string& text, Arguments arguments = Arguments::place_and_time) const;

  // The constant's value when it does not depend on x, y, z or t.
  std::optional<double> value(const std::string& constant) const;

 private:
  struct Constant {
    std::string text;
    std::vector<std::string> uses;  // names of constants
    unsigned coordinates = 0;       // which of x, y, z, t its value depends on: bits 0 to 3
    bool faulty = false;
    std::optional<double> number;
  };
  struct Names {  // what a text refers to
    std::vector<std::string> constants;
    unsigned coordinates = 0;  // named directly: bits 0 to 3
  };
  Names names_in(const std::string& text) const;
  std::unique_ptr<Expression> build(const std::string& text, const Names& names) const;
  void refuse_time(const std::string& text) const;
  void order_varying(const std::string& name, std::vector<std::string>& ordered) const;

  int dimensions_;
  std::map<std::string, Constant> constants_;
};

// An expression with the same value everywhere.
std::unique_ptr<Expression> constant_expression(double value);

// The value of an expression that is the same everywhere, so that callers can drop terms that are zero.
std::optional<double> constant_value(const Expression& expression);

}  // namespace spume
