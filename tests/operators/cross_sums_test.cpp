// SPDX-License-Identifier: MIT
// Sums at particles over another set of points against direct sums in double.
#include "spume/operators/cross_sums.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "neighbours/neighbourhood.hpp"

namespace spume::test {
namespace {

constexpr double h0 = 0.06;

struct Scene {
  CellGrid grid{3, {0, 0, 0}, {1, 1, 1}, 2 * h0, 4000};
  CellOrder particles, points;
  std::array<Array<double>, 3> at;
  std::array<Array<float>, 3> x;
  Array<float> length_ratio, support_radius, records;
  std::size_t n = 2500, m = 300;

  Scene() {
    const auto sort = [&](const std::vector<Point>& list, CellOrder& table) {
      std::array<Array<double>, 3> sorted;
      for (int round = 0; round < 2; ++round) {
        for (int a = 0; a < 3; ++a) {
          sorted[a].resize(list.size());
          for (std::size_t k = 0; k < list.size(); ++k)
            sorted[a][k] = list[round == 0 ? k : static_cast<std::size_t>(order[k])][a];
        }
        table.build(grid, sorted[0].data(), sorted[1].data(), sorted[2].data(), list.size());
        if (round == 0) order.assign(table.order().begin(), table.order().end());
      }
      return sorted;
    };
    at = sort(random_points(n, 3), particles);
    // All in one half: many particles have none in reach.
    std::vector<Point> others(m);
    for (std::size_t k = 0; k < m; ++k) {
      others[k] = uniform(k, 51);
      others[k][2] *= 0.5;
    }
    const auto other = sort(others, points);
    records.resize(8 * m);
    for (int a = 0; a < 3; ++a) x[a].resize(m + simd::pair_lanes);
    for (std::size_t k = 0; k < m; ++k)
      for (int a = 0; a < 3; ++a) {
        x[a][k] = records[8 * k + a] = static_cast<float>(other[a][k] - 0.5);
        records[8 * k + 3 + a] = static_cast<float>(uniform(k, 52)[a] - 0.5);
      }
    length_ratio.resize(n);
    support_radius.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      length_ratio[i] = static_cast<float>(1 + 0.26 * uniform(i, 53)[0]);
      support_radius[i] = static_cast<float>(2 * h0) * length_ratio[i];
    }
  }

  // Three sums per particle, NaN where no point was near.
  std::vector<float> sums() const {
    const CrossSearch::Points set[] = {{&points, m}};
    const CrossSearch search(grid, {0.5, 0.5, 0.5}, {x[0].data(), x[1].data(), x[2].data()}, set);
    const CrossTargets targets{
        n, {at[0].data(), at[1].data(), at[2].data()}, {0.5, 0.5, 0.5}, h0, length_ratio.data(), support_radius.data()};
    std::vector<float> result(3 * n, 1e30F);
    sum_over_points<3, WendlandC2>(targets, search, grid.support_radius(), records.data(),
                                   [&](std::size_t i, const float* values) {
                                     for (std::size_t c = 0; c < 3; ++c)
                                       result[3 * i + c] = values == nullptr ? NAN : values[c];
                                   });
    return result;
  }

 private:
  std::vector<std::int32_t> order;
};

TEST(CrossSums, AreTheDirectSums) {
  const Scene scene;
  const auto sums = scene.sums();
  std::size_t without = 0;
  for (std::size_t i = 0; i < scene.n; ++i) {
    std::array<double, 3> expected{};
    double weights = 0;
    for (std::size_t k = 0; k < scene.m; ++k) {
      double r2 = 0;
      for (int a = 0; a < 3; ++a) r2 += std::pow(scene.at[a][i] - 0.5 - scene.x[a][k], 2);
      const double w = WendlandC2::w(std::sqrt(r2) / (h0 * scene.length_ratio[i]));
      weights += w;
      for (std::size_t c = 0; c < 3; ++c) expected[c] += w * scene.records[8 * k + 3 + c];
    }
    if (std::isnan(sums[3 * i])) {
      ++without;
      EXPECT_EQ(weights, 0) << i;
      continue;
    }
    // Positions of the order of one in float: 6e-8, of a kernel whose slope is at most 2 / h; values below a half.
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(sums[3 * i + c], expected[c], 1e-5 * (weights + 0.1)) << i;
  }
  EXPECT_GT(without, scene.n / 4);
  EXPECT_LT(without, scene.n / 2);
}

// At each point over the particles that reach it, for an even number of them, an odd one and none.
TEST(CrossSums, OfLinesAreTheDirectSums) {
  const Scene scene;
  std::array<Array<float>, 3> place;
  Array<float> inverse_support_radius(scene.n + simd::pair_lanes), lines(line_floats * scene.n);
  for (int a = 0; a < 3; ++a) {
    place[a].resize(scene.n + simd::pair_lanes);
    for (std::size_t i = 0; i < scene.n; ++i) place[a][i] = static_cast<float>(scene.at[a][i] - 0.5);
  }
  for (std::size_t i = 0; i < scene.n; ++i) {
    inverse_support_radius[i] = 1 / scene.support_radius[i];
    for (std::size_t c = 0; c < line_floats; ++c)
      lines[line_floats * i + c] = static_cast<float>(uniform(line_floats * i + c, 54)[0] - 0.5);
  }
  const CrossSearch::Points set[] = {{&scene.particles, scene.n}};
  const CrossSearch search(scene.grid, {0.5, 0.5, 0.5}, {place[0].data(), place[1].data(), place[2].data()}, set);
  CrossSearch::Found found;
  std::array<std::size_t, 2> parity{};
  for (std::size_t b = 0; b < scene.m; ++b) {
    const std::array<float, 3> centre{scene.x[0][b], scene.x[1][b], scene.x[2][b]};
    search.near_place(centre, static_cast<float>(2.6 * h0), inverse_support_radius.data(), found);
    ++parity[found.size % 2];
    const auto halves = sum_of_lines<WendlandC2>(found, lines.data());
    std::array<double, line_floats> expected{};
    double weights = 0;
    for (std::size_t i = 0; i < scene.n; ++i) {
      double r2 = 0;
      for (std::size_t a = 0; a < 3; ++a) r2 += std::pow(double{place[a][i]} - centre[a], 2);
      const double w = WendlandC2::w(std::sqrt(r2) / (h0 * scene.length_ratio[i]));
      weights += w;
      for (std::size_t c = 0; c < line_floats; ++c) expected[c] += w * lines[line_floats * i + c];
    }
    for (std::size_t c = 0; c < line_floats; ++c)
      EXPECT_NEAR(halves[c / simd::lanes][c % simd::lanes], expected[c], 1e-5 * (weights + 0.1)) << b;
  }
  EXPECT_GT(parity[0], 50U);
  EXPECT_GT(parity[1], 50U);
  found.size = 0;
  const auto nothing = sum_of_lines<WendlandC2>(found, lines.data());
  for (std::size_t c = 0; c < line_floats; ++c) EXPECT_EQ(nothing[c / simd::lanes][c % simd::lanes], 0);
}

TEST(CrossSums, HaveTheSameBitsForAnyNumberOfThreads) {
  const Scene scene;
  omp_set_num_threads(1);
  const auto one = scene.sums();
  omp_set_num_threads(3);
  const auto three = scene.sums();
  omp_set_num_threads(2);
  EXPECT_EQ(std::memcmp(one.data(), three.data(), sizeof(float) * one.size()), 0);
}

}  // namespace
}  // namespace spume::test
