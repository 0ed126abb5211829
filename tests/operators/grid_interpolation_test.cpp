// SPDX-License-Identifier: MIT
#include "spume/operators/grid_interpolation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "operators/direct_stencil.hpp"
#include "operators/jittered_particles.hpp"
#include "spume/core/error.hpp"

namespace spume::test {
namespace {

using std::numbers::pi;

UniformGrid unit_grid(int dimensions, std::size_t across) {
  UniformGrid grid{dimensions, {0, 0, 0}, {1, 1, 1}, {across, across, dimensions == 3 ? across : 1}};
  return grid;
}

std::array<double, 3> grid_point(const UniformGrid& grid, std::size_t n) {
  return {grid.coordinate(0, n % grid.points[0]), grid.coordinate(1, n / grid.points[0] % grid.points[1]),
          grid.dimensions == 3 ? grid.coordinate(2, n / grid.points[0] / grid.points[1]) : 0.0};
}

struct Interpolated {
  Array<double> values;
  Array<std::uint8_t> mask;
  GridInterpolationReport report;
};

Interpolated interpolate(const UniformGrid& grid, const JitteredParticles& particles, const Array<double>& field,
                         bool periodic, const GridInterpolationOptions& options = {}) {
  Interpolated result{Array<double>(grid.size()), Array<std::uint8_t>(grid.size()), {}};
  const double* fields[] = {field.data()};
  double* values[] = {result.values.data()};
  result.report =
      interpolate_to_grid(grid, {particles.positions(), fields, particles.spacing, {periodic, periodic, periodic}},
                          values, result.mask, options);
  return result;
}

class GridInterpolation : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, GridInterpolation, testing::Values(2, 3));

// The weights solve the consistency conditions to rounding times the condition number of the scaled moment matrix
// (below 1e4 here) times sum |w| (below 2): 1e-12 of a field of order one.
constexpr double reproduction_tolerance = 1e-12;

TEST_P(GridInterpolation, CubicPolynomialsAreReproducedToRounding) {
  const int dimensions = GetParam();
  const std::size_t across = dimensions == 2 ? 40 : 14;
  const JitteredParticles particles(dimensions, across, 0.25);
  const UniformGrid grid = unit_grid(dimensions, across + 3);
  const auto cubic = [&](const std::array<double, 3>& p) {
    const auto [x, y, z] = p;
    const double plane = 0.3 - x + 0.5 * y + x * y - 0.7 * y * y + x * x * x - 0.4 * x * x * y + 0.2 * y * y * y;
    return dimensions == 2 ? plane : plane + 0.6 * z * z * z - x * y * z + 0.8 * z * z * x - 0.1 * z;
  };
  const Interpolated result = interpolate(grid, particles, particles.sample(cubic), false);
  std::int64_t interior = 0, exact = 0;
  for (std::size_t n = 0; n < grid.size(); ++n) {
    const auto p = grid_point(grid, n);
    const double error = std::abs(result.values[n] - cubic(p));
    bool inside = true;
    for (int d = 0; d < dimensions; ++d) inside &= std::abs(p[d] - 0.5) < 0.5 - particles.spacing;
    if (inside) {
      ++interior;
      EXPECT_LT(error, reproduction_tolerance) << n;
    }
    // Beside the sides, where nothing is wrapped, stencils are one-sided: exact when accepted, condition below 1e6.
    exact += error < 100 * reproduction_tolerance ? 1 : 0;
  }
  EXPECT_GT(interior, static_cast<std::int64_t>(grid.size()) / 2);
  EXPECT_EQ(exact, result.report.cubic);
}

TEST_P(GridInterpolation, CubicPolynomialsOfThePeriodicDistanceAreReproducedAcrossTheWrap) {
  // A cubic of the signed distance to the corner of the box is one polynomial in every stencil near that corner when
  // the wrap is right, and has a jump of order one when it is not.
  const int dimensions = GetParam();
  const std::size_t across = dimensions == 2 ? 40 : 14;
  const JitteredParticles particles(dimensions, across, 0.25);
  const UniformGrid grid = unit_grid(dimensions, across);
  const auto cubic = [&](const std::array<double, 3>& p) {
    const double x = std::remainder(p[0], 1), y = std::remainder(p[1], 1), z = std::remainder(p[2], 1);
    return 1 + x - 2 * y + z + 8 * x * x * x - 8 * x * y * y + (dimensions == 3 ? 8 * x * y * z - 8 * z * z * z : 0.0);
  };
  const Interpolated result = interpolate(grid, particles, particles.sample(cubic), true);
  int checked = 0;
  for (std::size_t n = 0; n < grid.size(); ++n) {
    const auto p = grid_point(grid, n);
    bool near_corner = true;
    for (int d = 0; d < dimensions; ++d) near_corner &= std::abs(std::remainder(p[d], 1)) < 0.5 - 3 * particles.spacing;
    if (!near_corner) continue;
    ++checked;
    EXPECT_NEAR(result.values[n], cubic(p), reproduction_tolerance) << n;
  }
  EXPECT_GT(checked, dimensions == 2 ? 1000 : 500);
}

TEST_P(GridInterpolation, AgreesWithDirectlySolvedStencils) {
  const int dimensions = GetParam();
  const std::size_t across = dimensions == 2 ? 24 : 10;
  const JitteredParticles particles(dimensions, across, 0.3);
  const Array<double> field =
      particles.sample([](const auto& p) { return std::exp(p[0]) * std::sin(9 * p[1] + p[2]); });
  const UniformGrid grid = unit_grid(dimensions, across + 1);
  const Interpolated result = interpolate(grid, particles, field, true);
  for (std::size_t n = 0; n < grid.size(); n += 13) {
    const auto stencil =
        direct_stencil(particles, grid_point(grid, n), GridInterpolationOptions{}.support * particles.spacing);
    double expected = 0;
    for (std::size_t j = 0; j < stencil.weight.size(); ++j) expected += stencil.weight[j] * field[stencil.particle[j]];
    EXPECT_NEAR(result.values[n], expected, 10 * reproduction_tolerance) << n;
  }
}

TEST_P(GridInterpolation, PositionsOutsideThePeriodicBoxAreWrapped) {
  const int dimensions = GetParam();
  const std::size_t across = dimensions == 2 ? 24 : 10;
  JitteredParticles particles(dimensions, across, 0.25);
  const auto smooth = [](const std::array<double, 3>& p) { return std::sin(2 * pi * p[0]) + std::cos(2 * pi * p[1]); };
  const Array<double> field = particles.sample(smooth);
  const UniformGrid grid = unit_grid(dimensions, across);
  const Interpolated inside = interpolate(grid, particles, field, true);
  for (std::size_t i = 0; i < particles.size(); ++i)
    for (int d = 0; d < dimensions; ++d) particles.position[d][i] += static_cast<double>(i % 5) - 2;
  const Interpolated shifted = interpolate(grid, particles, field, true);
  // Shifting by up to 2 rounds positions by 2^-52 * 2, over a spacing of 1/24 or more.
  for (std::size_t n = 0; n < grid.size(); ++n) EXPECT_NEAR(shifted.values[n], inside.values[n], 1e-12);
}

TEST_P(GridInterpolation, ErrorOfASmoothPeriodicFieldFallsWithTheFourthPowerOfTheSpacing) {
  const int dimensions = GetParam();
  const auto smooth = [&](const std::array<double, 3>& p) {
    return std::sin(2 * pi * p[0] + 1) * std::cos(2 * pi * p[1]) * (dimensions == 3 ? std::cos(2 * pi * p[2]) : 1.0);
  };
  const auto error = [&](std::size_t across) {
    const JitteredParticles particles(dimensions, across, 0.25);
    const UniformGrid grid = unit_grid(dimensions, across);
    const Interpolated result = interpolate(grid, particles, particles.sample(smooth), true);
    double sum = 0;
    for (std::size_t n = 0; n < grid.size(); ++n) sum += std::pow(result.values[n] - smooth(grid_point(grid, n)), 2);
    return std::sqrt(sum / static_cast<double>(grid.size()));
  };
  const std::size_t coarse = dimensions == 2 ? 24 : 12;
  const double order = std::log2(error(coarse) / error(2 * coarse));
  RecordProperty("order", std::to_string(order));
  EXPECT_GE(order, 3.5);
  EXPECT_LE(order, 4.5);
}

TEST_P(GridInterpolation, ResultIsTheSameForAnyNumberOfThreads) {
  const int dimensions = GetParam();
  const std::size_t across = dimensions == 2 ? 60 : 16;
  const JitteredParticles particles(dimensions, across, 0.4);
  const Array<double> field =
      particles.sample([](const auto& p) { return std::exp(p[0]) * std::sin(9 * p[1] + p[2]); });
  const UniformGrid grid = unit_grid(dimensions, across);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const Interpolated one = interpolate(grid, particles, field, true);
  omp_set_num_threads(3);
  const Interpolated three = interpolate(grid, particles, field, true);
  omp_set_num_threads(threads);
  EXPECT_EQ(std::memcmp(one.values.data(), three.values.data(), grid.size() * sizeof(double)), 0);
  EXPECT_EQ(std::memcmp(one.mask.data(), three.mask.data(), grid.size()), 0);
}

TEST_P(GridInterpolation, PointsOutsideTheLiquidAreZeroAndMasked) {
  // Particles fill the lower half of the box: their surface is at 1/2 along the last axis.
  const int dimensions = GetParam();
  const std::size_t across = dimensions == 2 ? 40 : 16;
  const JitteredParticles all(dimensions, across, 0.1);
  JitteredParticles liquid = all;
  const int up = dimensions - 1;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.position[up][i] > 0.5) continue;
    for (int d = 0; d < 3; ++d) liquid.position[d][kept] = all.position[d][i];
    ++kept;
  }
  for (auto& component : liquid.position) component.resize(kept);
  const auto linear = [&](const std::array<double, 3>& p) { return 2 + p[0] - 3 * p[up]; };
  const UniformGrid grid = unit_grid(dimensions, 2 * across);
  const Interpolated result = interpolate(grid, liquid, liquid.sample(linear), false);

  std::int64_t outside = 0;
  for (std::size_t n = 0; n < grid.size(); ++n) {
    const auto p = grid_point(grid, n);
    outside += result.mask[n] == 0 ? 1 : 0;
    EXPECT_TRUE(result.mask[n] == 1 || result.values[n] == 0);
    // Particles reach up to a jitter below 1/2; from there sqrt(3)/2 spacings is the farthest covered point.
    EXPECT_FALSE(p[up] > 0.5 + liquid.spacing && result.mask[n] == 1) << p[up];
    EXPECT_FALSE(p[up] < 0.5 && result.mask[n] == 0) << p[up];
  }
  EXPECT_EQ(result.report.outside, outside);
  EXPECT_EQ(result.report.cubic + result.report.linear + result.report.shepard + outside,
            static_cast<std::int64_t>(grid.size()));
  // Every accepted stencil but the weighted mean is exact for this field.
  std::int64_t inexact = 0;
  for (std::size_t n = 0; n < grid.size(); ++n)
    if (result.mask[n] == 1 && std::abs(result.values[n] - linear(grid_point(grid, n))) > 1e-10) ++inexact;
  EXPECT_LE(inexact, result.report.shepard);
}

TEST(GridInterpolationFallback, ThreeParticlesGiveALinearStencilAndOneTheWeightedMean) {
  const UniformGrid grid{2, {0, 0, 0}, {1, 1, 0}, {10, 10, 1}};
  const double field[] = {1, 2, 4};
  const double* fields[] = {field};
  Array<double> values(grid.size());
  double* results[] = {values.data()};
  const double x[] = {0.52, 0.60, 0.52}, y[] = {0.51, 0.51, 0.61};
  const auto run = [&](std::size_t count) {
    return interpolate_to_grid(grid, {{std::span(x, count), std::span(y, count), {}}, fields, 0.1, {}}, results);
  };
  const GridInterpolationReport triangle = run(3);
  EXPECT_EQ(triangle.cubic, 0);
  EXPECT_GT(triangle.linear, 0);
  // The plane through the three values at (0.55, 0.55): 1 + 0.03 / 0.08 + 3 * 0.04 / 0.1.
  EXPECT_NEAR(values[grid.index(5, 5)], 2.575, 1e-13);

  const GridInterpolationReport single = run(1);
  EXPECT_EQ(single.cubic + single.linear, 0);
  EXPECT_GT(single.shepard, 0);
  EXPECT_NEAR(values[grid.index(5, 5)], 1, 1e-15);
  EXPECT_EQ(values[grid.index(9, 9)], 0);

  const GridInterpolationReport empty = run(0);
  EXPECT_EQ(empty.outside, 100);
}

TEST(GridInterpolationFallback, ParticlesOnALineDoNotProduceWildValues) {
  // No stencil can be linear across the line; the weighted mean keeps values between the particles'.
  const UniformGrid grid{2, {0, 0, 0}, {1, 1, 0}, {20, 20, 1}};
  Array<double> x(20), y(20, 0.52), field(20), values(grid.size());
  for (std::size_t i = 0; i < 20; ++i) {
    x[i] = (static_cast<double>(i) + 0.5) / 20;
    field[i] = i % 2 == 0 ? 1.0 : -1.0;
  }
  const double* fields[] = {field.data()};
  double* results[] = {values.data()};
  const GridInterpolationReport report = interpolate_to_grid(grid, {{x, y, {}}, fields, 0.05, {}}, results);
  EXPECT_GT(report.shepard, 0);
  EXPECT_EQ(report.cubic + report.linear, 0);
  for (const double value : values) EXPECT_LE(std::abs(value), 1.0);
}

TEST(GridInterpolationInputErrors, AreNamed) {
  const JitteredParticles particles(2, 4, 0.1);
  const Array<double> field(particles.size(), 1.0);
  const double* fields[] = {field.data()};
  UniformGrid grid = unit_grid(2, 4);
  Array<double> values(grid.size());
  double* results[] = {values.data()};
  const auto message = [&](const GridInterpolationInput& input) -> std::string {
    try {
      interpolate_to_grid(grid, input, results);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(message({particles.positions(), fields, 0, {}}), testing::HasSubstr("spacing"));
  EXPECT_THAT(message({particles.positions(), fields, 0.5, {true, true, true}}), testing::HasSubstr("periodic x"));
  EXPECT_THAT(message({{particles.position[0], {}, {}}, fields, 0.25, {}}), testing::HasSubstr("y coordinates"));
  grid.points[1] = 0;
  EXPECT_THAT(message({particles.positions(), fields, 0.25, {}}), testing::HasSubstr("no points along y"));
}

TEST(GridInterpolationInputErrors, ParticlesWithoutAPlaceAreLeftOut) {
  JitteredParticles particles(2, 20, 0.2);
  Array<double> field = particles.sample([](const auto& p) { return p[0]; });
  particles.position[0][37] = std::numeric_limits<double>::quiet_NaN();
  const UniformGrid grid = unit_grid(2, 20);
  const Interpolated result = interpolate(grid, particles, field, false);
  for (const double value : result.values) EXPECT_TRUE(std::isfinite(value));
}

}  // namespace
}  // namespace spume::test
