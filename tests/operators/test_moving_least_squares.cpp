// SPDX-License-Identifier: MIT
// Local polynomial fits: polynomials of their order are reproduced, coefficients are those of a QR solve, and too few
// or one-sided neighbours fall back.
#include <gtest/gtest.h>

#include <cmath>

#include "neighbours/neighbourhood.hpp"
#include "reference/least_squares.hpp"
#include "spume/core/kernel.hpp"
#include "spume/operators/moving_least_squares.hpp"

namespace spume::test {
namespace {

using reference::Neighbour;

constexpr double h = 0.13;

enum class Shape { around, one_sided, corner };

// Random neighbours in the support of the Wendland kernel: all around the point, on one side of a plane 0.3 h away from
// it, or in one corner of space from there.
std::vector<Neighbour> random_neighbours(int dimensions, Shape shape, std::uint32_t draw) {
  std::vector<Neighbour> neighbours;
  const std::size_t wanted = dimensions == 3 ? 80 : 30;
  for (std::uint64_t k = 0; neighbours.size() < wanted; ++k) {
    const Point r = uniform(k, draw);
    Neighbour n;
    double squared = 0;
    for (int a = 0; a < dimensions; ++a) {
      n.offset[a] = 4 * r[a] - 2;
      squared += n.offset[a] * n.offset[a];
    }
    n.weight = WendlandC2::w(std::sqrt(squared));
    const bool outside = squared >= 4 || (shape != Shape::around && n.offset[0] < -0.3) ||
                         (shape == Shape::corner && n.offset[1] < -0.3);
    if (!outside) neighbours.push_back(n);
  }
  return neighbours;
}

template <int Dimensions>
void give(MovingLeastSquares<Dimensions>& fit, const std::vector<Neighbour>& neighbours) {
  fit.resize(neighbours.size());
  for (std::size_t j = 0; j < neighbours.size(); ++j) {
    fit.weight()[j] = neighbours[j].weight;
    for (int a = 0; a < Dimensions; ++a) fit.offset(a)[j] = neighbours[j].offset[a];
  }
}

// The coefficients of every monomial's derivative at the point, and the factor from the monomial to the derivative.
template <int Dimensions, class Use>
void each_derivative(MovingLeastSquares<Dimensions>& fit, int order, Use&& use) {
  for (const auto& e : reference::exponents(Dimensions, order)) {
    std::vector<int> axes;
    for (int a = 0; a < 3; ++a) axes.insert(axes.end(), static_cast<std::size_t>(e[a]), a);
    if (axes.empty())
      use(e, fit.value(), 1.0);
    else if (axes.size() == 1)
      use(e, fit.gradient(axes[0], h), 1 / h);
    else if (axes.size() == 2)
      use(e, fit.second_derivative(axes[0], axes[1], h), (axes[0] == axes[1] ? 2 : 1) / (h * h));
  }
}

// Coefficients by normal equations err by the condition of the moments, at most 1 / (2e-4), times the rounding of 2^-53
// in some hundred sums; the twin's by its root.
constexpr double rounding = 1e2 * 5e3 * 1.2e-16;

template <int Dimensions>
void compare_with_the_twin() {
  MovingLeastSquares<Dimensions> fit;
  for (const Shape shape : {Shape::around, Shape::one_sided, Shape::corner})
    for (int order = 0; order <= 2; ++order)
      for (std::uint32_t draw = 1; draw <= 20; ++draw) {
        const auto neighbours = random_neighbours(Dimensions, shape, draw);
        give(fit, neighbours);
        ASSERT_EQ(fit.fit(order), order);
        const Eigen::MatrixXd slow = reference::fit_coefficients(Dimensions, order, neighbours);
        Eigen::Index m = 0;
        each_derivative(fit, order, [&](const auto&, std::span<const double> c, double factor) {
          const double size = factor * slow.row(m).cwiseAbs().sum();
          double sum = 0;
          for (std::size_t j = 0; j < c.size(); ++j) {
            ASSERT_NEAR(c[j], factor * slow(m, static_cast<Eigen::Index>(j)), rounding * size);
            sum += std::abs(c[j]);
          }
          EXPECT_NEAR(fit.amplification(), sum, 1e-13 * sum);
          ++m;
        });
        EXPECT_EQ(m, slow.rows());
      }
}

TEST(MovingLeastSquares, CoefficientsAreThoseOfTheSlowTwin) {
  compare_with_the_twin<2>();
  compare_with_the_twin<3>();
}

template <int Dimensions>
void reproduce_polynomials() {
  MovingLeastSquares<Dimensions> fit;
  for (const Shape shape : {Shape::around, Shape::one_sided, Shape::corner})
    for (int order = 0; order <= 3; ++order)
      for (std::uint32_t draw = 1; draw <= 20; ++draw) {
        const auto neighbours = random_neighbours(Dimensions, shape, draw);
        give(fit, neighbours);
        ASSERT_TRUE(fit.factor(order));
        const auto list = reference::exponents(Dimensions, order);
        // In coordinates over h: the coefficient of a monomial is the derivative without its factor.
        const auto coefficient = [&](std::size_t m) { return uniform(m, 100 + draw)[0] - 0.5; };
        std::vector<double> values;
        for (const Neighbour& n : neighbours) {
          double value = 0;
          for (std::size_t m = 0; m < list.size(); ++m) {
            double monomial = coefficient(m);
            for (std::size_t a = 0; a < 3; ++a) monomial *= std::pow(n.offset[a], list[m][a]);
            value += monomial;
          }
          values.push_back(value);
        }
        each_derivative(fit, order, [&](const std::array<int, 3>& e, std::span<const double> c, double factor) {
          double sum = 0, size = 0;
          for (std::size_t j = 0; j < c.size(); ++j) {
            sum += c[j] * values[j];
            size += std::abs(c[j] * values[j]);
          }
          const auto m = static_cast<std::size_t>(std::find(list.begin(), list.end(), e) - list.begin());
          // Cubic moments, which no bound on their condition has admitted, have up to 1e7.
          EXPECT_NEAR(sum, coefficient(m) * factor, (order == 3 ? 1e3 : 1) * rounding * size)
              << Dimensions << "-D, order " << order;
        });
      }
}

TEST(MovingLeastSquares, PolynomialsOfTheOrderAreReproduced) {
  reproduce_polynomials<2>();
  reproduce_polynomials<3>();
}

template <int Dimensions>
void fall_back() {
  MovingLeastSquares<Dimensions> fit;
  const auto fitted = [&](std::vector<Neighbour> neighbours, int order) {
    give(fit, neighbours);
    return fit.fit(order);
  };
  const auto around = random_neighbours(Dimensions, Shape::around, 1);
  const auto first = [&](std::size_t count) {
    return std::vector<Neighbour>(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(count));
  };
  const std::size_t linear = 2 * (Dimensions + 1), quadratic = Dimensions == 3 ? 20 : 12;
  EXPECT_EQ(fitted(around, 2), 2);
  EXPECT_EQ(fitted(first(quadratic), 2), 1) << "twice as many as monomials are too few";
  EXPECT_EQ(fitted(first(linear), 2), 0);
  EXPECT_EQ(fitted(first(linear), 1), 0);
  EXPECT_EQ(fitted({}, 2), -1);
  EXPECT_TRUE(fit.value().empty());
  auto weightless = around;
  for (Neighbour& n : weightless) n.weight = 0;
  EXPECT_EQ(fitted(weightless, 2), -1);
  for (const double c : fit.value()) EXPECT_EQ(c, 0);

  // In a plane, and in two planes close to each other: a slope across them is not known.
  for (const double apart : {0.0, 0.02}) {
    auto flat = around;
    for (std::size_t j = 0; j < flat.size(); ++j) flat[j].offset[0] = j % 2 == 0 ? apart : 0;
    EXPECT_EQ(fitted(flat, 2), 0) << apart;
    double total = 0, sum = 0;
    for (const Neighbour& n : flat) total += n.weight;
    const auto c = fit.value();
    for (std::size_t j = 0; j < c.size(); ++j) {
      EXPECT_NEAR(c[j], flat[j].weight / total, 1e-15);
      sum += c[j];
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_EQ(fit.amplification(), 1);
    for (const double slope : fit.gradient(0, h)) EXPECT_EQ(slope, 0);
    EXPECT_EQ(fit.amplification(), 0);
  }
  // Two planes a spacing apart know the slope across, not the curvature.
  auto layers = around;
  for (std::size_t j = 0; j < layers.size(); ++j) layers[j].offset[0] = j % 2 == 0 ? 0.77 : 0;
  EXPECT_EQ(fitted(layers, 2), 1);
  EXPECT_FALSE(fit.factor(2));
}

TEST(MovingLeastSquares, FallsBackWhereNeighboursAreFewOrFlat) {
  fall_back<2>();
  fall_back<3>();
}

// Columns: a random field, and the linear one, which is reproduced.
TEST(LinearFit, IsTheFirstOrderOfTheSlowTwin) {
  for (const int d : {2, 3})
    for (const Shape shape : {Shape::around, Shape::one_sided, Shape::corner})
      for (std::uint32_t draw = 1; draw <= 20; ++draw) {
        const auto neighbours = random_neighbours(d, shape, draw);
        LinearFit fit(d);
        const Eigen::MatrixXd slow = reference::fit_coefficients(d, 1, neighbours);
        std::array<double, 4> expected{}, size{};
        double weight = 0;
        for (std::size_t j = 0; j < neighbours.size(); ++j) {
          const auto& x = neighbours[j].offset;
          const Point random = uniform(j, 200 + draw);
          const std::array<double, 4> values{random[0] - 0.5, random[1], -random[2], 2 + x[0] - 3 * x[1] + 0.5 * x[2]};
          fit.add(neighbours[j].weight, x, values);
          weight += neighbours[j].weight;
          for (std::size_t f = 0; f < 4; ++f) {
            expected[f] += slow(0, static_cast<Eigen::Index>(j)) * values[f];
            size[f] += std::abs(slow(0, static_cast<Eigen::Index>(j)) * values[f]);
          }
        }
        EXPECT_EQ(fit.count(), static_cast<int>(neighbours.size()));
        EXPECT_NEAR(fit.weight(), weight, 1e-14 * weight);
        const auto result = fit.at_centre();
        ASSERT_TRUE(result.fitted);
        for (std::size_t f = 0; f < 4; ++f) EXPECT_NEAR(result.value[f], expected[f], rounding * size[f]);
        EXPECT_NEAR(result.value[3], 2, rounding * size[3]);
      }
}

TEST(LinearFit, AveragesWhereNeighboursAreFewOrFlat) {
  for (const int d : {2, 3})
    for (const bool few : {true, false}) {
      auto neighbours = random_neighbours(d, Shape::around, 1);
      if (few) neighbours.resize(static_cast<std::size_t>(2 * (d + 1)));
      LinearFit fit(d);
      double total = 0, sum = 0;
      for (std::size_t j = 0; j < neighbours.size(); ++j) {
        Neighbour n = neighbours[j];
        if (!few) n.offset[0] *= 0.01;
        const double value = uniform(j, 300)[0];
        fit.add(n.weight, n.offset, {value, 0, 0, 7});
        total += n.weight;
        sum += n.weight * value;
      }
      const auto result = fit.at_centre();
      EXPECT_FALSE(result.fitted);
      EXPECT_NEAR(result.value[0], sum / total, 1e-14);
      EXPECT_NEAR(result.value[3], 7, 1e-14 * 7);
    }
}

}  // namespace
}  // namespace spume::test
