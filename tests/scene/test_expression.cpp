// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>
#include <random>

#include "spume/scene/expression.hpp"

namespace spume {
namespace {

double evaluate(const std::string& text, double x = 0, double y = 0, double z = 0, double t = 0) {
  return (*ExpressionScope().compile(text))(x, y, z, t);
}

// "position text" of the fault in a text.
std::string fault(const std::string& text, const ExpressionScope& scope = ExpressionScope()) {
  try {
    scope.compile(text);
  } catch (const ExpressionError& error) {
    return std::to_string(error.position()) + " " + error.what();
  }
  return "none";
}

TEST(Expression, FollowsTheUsualRules) {
  EXPECT_DOUBLE_EQ(evaluate("2^3^2"), 512);
  EXPECT_DOUBLE_EQ(evaluate("-2^2"), -4);
  EXPECT_DOUBLE_EQ(evaluate("sin(pi/6) + log(e) + 1e-3"), 0.5 + 1 + 1e-3);
  EXPECT_DOUBLE_EQ(evaluate("x + 2*y + 3*z + 4*t", 1, 10, 100, 1000), 4321);
  EXPECT_DOUBLE_EQ(evaluate("x < 1 ? 2 : 3", 0.5), 2);
  EXPECT_DOUBLE_EQ(evaluate("mod(-0.25, 1) + floor(1.5) + ceil(1.5) + cbrt(8) + erf(0)"), 0.75 + 1 + 2 + 2);
}

TEST(Expression, ConstantsMayUseEachOtherInAnyOrder) {
  ExpressionScope scope;
  EXPECT_TRUE(scope
                  .define({{"wave", "a*cos(k*x) + shift"},
                           {"a", "b/2"},
                           {"k", "2*pi"},
                           {"b", "3"},
                           {"shift", "t*slope"},
                           {"slope", "y"}})
                  .empty());
  const auto expression = scope.compile("wave - z + wave*0");
  for (const double x : {0.0, 0.1, 0.7}) {
    for (const double t : {0.0, 2.0}) {
      EXPECT_NEAR((*expression)(x, 5, 0.25, t), 1.5 * std::cos(2 * std::numbers::pi * x) + 5 * t - 0.25, 1e-14);
    }
  }
  EXPECT_EQ(scope.value("a"), 1.5);
  EXPECT_FALSE(scope.value("wave").has_value());
  EXPECT_FALSE(scope.value("unknown").has_value());
  EXPECT_EQ(constant_value(*scope.compile("2*a")), 3.0);
  EXPECT_FALSE(constant_value(*expression).has_value());
}

TEST(Expression, PartsFollowEveryCoordinateIncludingTheSignOfZero) {
  ExpressionScope scope;
  ASSERT_TRUE(scope.define({{"inverse", "1/x"}}).empty());
  const auto expression = scope.compile("inverse");
  EXPECT_EQ((*expression)(0.0, 0, 0, 0), INFINITY);
  EXPECT_EQ((*expression)(-0.0, 0, 0, 0), -INFINITY);
  EXPECT_EQ((*expression)(-0.0, 1, 1, 1), -INFINITY);
  EXPECT_EQ((*expression)(2.0, 1, 1, 1), 0.5);
}

TEST(Expression, CyclesAreReportedOnceWithTheirPath) {
  ExpressionScope scope;
  const auto faults = scope.define({{"a", "b + 1"}, {"b", "c*2"}, {"c", "a"}, {"d", "a + 1"}, {"good", "1"}});
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].constant, 0u);
  EXPECT_EQ(faults[0].text, "the constants a -> b -> c -> a depend on each other");
  EXPECT_TRUE(std::isnan((*scope.compile("d"))(0, 0, 0, 0)));  // no second report
  EXPECT_EQ(scope.define({{"self", "self"}}).at(0).text, "the constants self -> self depend on each other");
}

TEST(Expression, FaultyConstantsNameTheirPlace) {
  ExpressionScope scope;
  const auto faults =
      scope.define({{"pi", "3"}, {"half-depth", "1"}, {"q", "1/0"}, {"r", "2 +* 3"}, {"s", "2*cose(x)"}});
  ASSERT_EQ(faults.size(), 5u);
  EXPECT_EQ(faults[0].text, "this name is taken; choose another");
  EXPECT_EQ(faults[1].position, std::string::npos);
  for (const auto& found : faults) {
    EXPECT_NE(found.text, "");
    EXPECT_TRUE(found.constant != 2 || found.text == "its value is not finite");
    EXPECT_TRUE(found.constant != 3 || found.position == 3u);
    EXPECT_TRUE(found.constant != 4 || found.position == 2u);
  }
}

TEST(Expression, FaultsPointAtTheCharacter) {
  ExpressionScope scope;
  ASSERT_TRUE(scope.define({{"eta", "x"}}).empty());
  EXPECT_EQ(fault("etta - z", scope), "0 unknown name 'etta'; did you mean 'eta'?");
  EXPECT_EQ(fault("2*frobnicate(x)"), "2 unknown name 'frobnicate'; define it in [constants]");
  EXPECT_EQ(fault("1 + (2*x"), "4 this '(' is never closed");
  EXPECT_EQ(fault("1 + 2)*x"), "5 unmatched ')'");
  EXPECT_EQ(fault("x + * 2"), "4 unexpected operator '*'");
  EXPECT_EQ(fault("2 x"), "2 unexpected variable 'x'");
  EXPECT_EQ(fault("x ^"), "3 unexpected end of expression");
  EXPECT_EQ(fault("x = 3"), "2 unexpected '='; an expression assigns nothing (to compare, write ==)");
  EXPECT_EQ(fault("1, 2"), "1 unexpected ','; one value is expected");
  EXPECT_EQ(fault("x # 2"), "2 unexpected character '#'");
  EXPECT_EQ(fault("  "), "0 the expression is empty");
  EXPECT_EQ(fault("x + atan2(1)"), "4 too few parameters for function 'atan2'");
  EXPECT_EQ(fault("x < 1 ? 2").substr(0, 1), "9");
  EXPECT_EQ(fault("y - z", ExpressionScope(2)), "4 z in a two-dimensional case; up is y");
}

TEST(Expression, ClonesAreIndependent) {
  ExpressionScope scope;
  ASSERT_TRUE(scope.define({{"k", "sin(x) + t"}}).empty());
  const auto original = scope.compile("k*k + y");
  double worst = 0;
#pragma omp parallel reduction(max : worst) num_threads(4)
  {
    const auto own = original->clone();
    for (int i = 0; i < 2000; ++i) {
      const double x = omp_get_thread_num() + 0.01 * i, k = std::sin(x) + 2;
      worst = std::max(worst, std::abs((*own)(x, 3, 0, 2) - (k * k + 3)));
    }
  }
  EXPECT_LT(worst, 1e-14);
}

TEST(Expression, ACopyDoesNotKnowWhereThoseBeforeItWereEvaluated) {
  ExpressionScope scope;
  scope.define({{"depth", "1 + x^2"}, {"wave", "sin(t)"}});
  const auto original = scope.compile("depth*z + wave");
  for (const double x : {0.0, -0.0, 3.0, 0.0}) {
    for (const double t : {0.0, 2.0}) {
      const auto first = original->clone(), second = original->clone();
      EXPECT_EQ((*first)(x, 0, 2, t), (1 + x * x) * 2 + std::sin(t));
      EXPECT_EQ((*second)(x + 1, 0, 1, 0), 1 + (x + 1) * (x + 1));
      EXPECT_EQ((*first)(x, 0, 2, t), (1 + x * x) * 2 + std::sin(t));
    }
  }
}

// Sweeps make a copy for every block of 512 particles: it may not cost what it takes to parse the text, a thousand
// times an evaluation. The factor of ten leaves room for a busy machine.
TEST(Expression, ACopyOfWhatWasCopiedBeforeParsesNothing) {
  ExpressionScope scope;
  const auto original = scope.compile("t > 2 && (x - 0.5)^2 + y^2 < 1 ? 1 : 0");
  const auto seconds = [](auto&& work) {
    const double start = omp_get_wtime();
    for (int i = 0; i < 200; ++i) work();
    return omp_get_wtime() - start;
  };
  double sum = 0;
  const double parsed = seconds([&] { sum += (*scope.compile("t > 2 && (x - 0.5)^2 + y^2 < 1 ? 1 : 0"))(0, 0, 0, 3); });
  const double copied = seconds([&] { sum += (*original->clone())(0, 0, 0, 3); });
  EXPECT_EQ(sum, 400);
  EXPECT_LT(copied, parsed / 10);
}

TEST(Expression, VectorTreatsAnAbsentComponentAsZero) {
  VectorExpression vector;
  vector.component[1] = ExpressionScope().compile("x + t");
  EXPECT_EQ(vector({2, 0, 0}, 3), (Vec3{0, 5, 0}));
  EXPECT_EQ(vector.clone()({4, 0, 0}, 3), (Vec3{0, 7, 0}));
  EXPECT_NE(vector.clone().component[1], vector.component[1]);
}

TEST(Expression, GarbageIsRefusedOrEvaluatedButNeverCrashes) {
  std::mt19937 random(1);
  const std::string letters = "xyzt0123456789.eE+-*/^()<>=!&|?:, sincoqrtmaxp\"#\x80_";
  ExpressionScope scope;
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (unsigned n = random() % 24; n > 0; --n) text += letters[random() % letters.size()];
    try {
      (*scope.compile(text))(0.5, 0.5, 0.5, 0.5);
    } catch (const ExpressionError& error) {
      ASSERT_LE(error.position(), text.size()) << text;
      ASSERT_NE(std::string(error.what()), "") << text;
    }
  }
  EXPECT_NE(fault(std::string(100000, '(')), "none");
  EXPECT_NE(fault(std::string(20000, '-')), "none");
  std::string nested(5000, '(');
  nested += '1';
  nested.append(5000, ')');
  EXPECT_EQ(fault(nested), "none");
}

}  // namespace
}  // namespace spume
