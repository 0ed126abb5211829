// SPDX-License-Identifier: MIT
// Pairs between two sets of points against all pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "neighbours/neighbourhood.hpp"
#include "spume/core/simd.hpp"
#include "spume/neighbours/cross_search.hpp"

namespace spume::test {
namespace {

constexpr double base_support_radius = 0.12, widest = 1.26;
// Distances that decide differently in float and double are not looked at.
constexpr double rounding = 1e-6;

// Points of the unit box, a tenth of them outside the grid, where border cells hold them.
std::vector<Point> scattered(std::size_t n, std::uint32_t draw) {
  std::vector<Point> points(n);
  for (std::size_t k = 0; k < n; ++k)
    for (int a = 0; a < 3; ++a) points[k][a] = k % 10 == 0 ? 1.3 * uniform(k, draw)[a] - 0.15 : uniform(k, draw)[a];
  return points;
}

std::vector<Point> sorted_by(const CellGrid& grid, const std::vector<Point>& points, CellOrder& table) {
  const auto build = [&](const std::vector<Point>& list) {
    const auto x = Neighbourhood::column(list, 0), y = Neighbourhood::column(list, 1),
               z = Neighbourhood::column(list, 2);
    table.build(grid, x.data(), y.data(), z.data(), list.size());
  };
  build(points);
  std::vector<Point> sorted(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) sorted[k] = points[static_cast<std::size_t>(table.order()[k])];
  build(sorted);
  return sorted;
}

// A set of points and, as the second set, its periodic images; without images two sets of points anywhere.
class CrossSearches : public ::testing::TestWithParam<bool> {
 protected:
  CrossSearches() : grid(3, {0, 0, 0}, {1, 1, 1}, base_support_radius, 3000) {
    first = sorted_by(grid, with_images() ? random_points(3000, 3) : scattered(3000, 41), table[0]);
    if (with_images()) {
      ImageRules rules =
          unit_box_rules(3, widest * base_support_radius, ImageKind::periodic, ImageKind::none, ImageKind::mirror);
      const auto x = Neighbourhood::column(first, 0), y = Neighbourhood::column(first, 1),
                 z = Neighbourhood::column(first, 2);
      images.build(rules, grid, x.data(), y.data(), z.data(), first.size());
      for (std::size_t k = 0; k < images.size(); ++k)
        second.push_back({images.position(0)[k], images.position(1)[k], images.position(2)[k]});
      sets = {{{&table[0], first.size()}, images_as_points(images)}};
    } else {
      second = sorted_by(grid, scattered(170, 42), table[1]);
      sets = {{{&table[0], first.size()}, {&table[1], second.size()}}};
    }
    all = first;
    all.insert(all.end(), second.begin(), second.end());
    for (int a = 0; a < 3; ++a) {
      x[a].resize(all.size() + simd::pair_lanes);
      x[a].fill(0);
      for (std::size_t k = 0; k < all.size(); ++k) x[a][k] = static_cast<float>(all[k][a] - 0.5);
    }
    inverse_support_radius.resize(all.size() + simd::pair_lanes);
    inverse_support_radius.fill(1);
    for (std::size_t k = 0; k < all.size(); ++k)
      inverse_support_radius[k] =
          static_cast<float>(1 / (base_support_radius * (1 + (widest - 1) * uniform(k, 43)[0])));
  }
  static bool with_images() { return GetParam(); }
  CrossSearch search() const { return {grid, {0.5, 0.5, 0.5}, {x[0].data(), x[1].data(), x[2].data()}, sets}; }

  // What was found is all that is certainly within, nothing that is certainly beyond, and nothing twice.
  template <class Share>  // distance over support radius of point j
  void expect_found(const CrossSearch::Found& found, Share&& share) {
    std::vector<int> times(all.size(), 0);
    for (std::size_t k = 0; k < found.size; ++k) ++times[static_cast<std::size_t>(found.index[k])];
    for (std::size_t j = 0; j < all.size(); ++j) {
      const double s = share(j);
      if (s < 1 - rounding)
        ASSERT_EQ(times[j], 1) << j;
      else if (s > 1 + rounding)
        ASSERT_EQ(times[j], 0) << j;
      else
        ASSERT_LE(times[j], 1);
    }
  }

  CellGrid grid;
  std::array<CellOrder, 2> table;
  Images images;
  std::vector<Point> first, second, all;
  std::array<CrossSearch::Points, 2> sets;
  std::array<Array<float>, 3> x;
  Array<float> inverse_support_radius;
};

TEST_P(CrossSearches, FindEveryPointThatReachesAPlace) {
  CrossSearch::Found found;
  std::size_t pairs = 0;
  for (const Point& place : scattered(150, 44)) {
    const std::array<float, 3> centre{static_cast<float>(place[0] - 0.5), static_cast<float>(place[1] - 0.5),
                                      static_cast<float>(place[2] - 0.5)};
    search().near_place(centre, static_cast<float>(widest * base_support_radius), inverse_support_radius.data(), found);
    const auto share = [&](std::size_t j) {
      double r2 = 0;
      for (int a = 0; a < 3; ++a) r2 += std::pow(double{x[a][j]} - centre[a], 2);
      return std::sqrt(r2) * inverse_support_radius[j];
    };
    expect_found(found, share);
    for (std::size_t k = 0; k < found.size; ++k)
      EXPECT_NEAR(found.share2[k], std::pow(share(static_cast<std::size_t>(found.index[k])), 2), 1e-6);
    for (std::size_t k = found.size; k < (found.size + 7) / 8 * 8; ++k) EXPECT_EQ(found.share2[k], 1);
    pairs += found.size;
  }
  EXPECT_GT(pairs, 150U * 10);
}

TEST_P(CrossSearches, FindEveryPointNearABox) {
  CrossSearch::Found found;
  const float support_radius = static_cast<float>(1.1 * base_support_radius);
  for (std::size_t k = 0; k < 100; ++k) {
    const Point corner = scattered(100, 45)[k], size = uniform(k, 46);
    CrossSearch::Box box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.lower[a] = static_cast<float>(corner[a] - 0.5);
      box.upper[a] = box.lower[a] + static_cast<float>(1.5 * base_support_radius * size[a]);
    }
    search().near_box(box, support_radius, found);
    expect_found(found, [&](std::size_t j) {
      double r2 = 0;
      for (std::size_t a = 0; a < 3; ++a)
        r2 += std::pow(std::max({0.0, double{x[a][j]} - box.upper[a], double{box.lower[a]} - x[a][j]}), 2);
      return std::sqrt(r2) / support_radius;
    });
  }
}

TEST_P(CrossSearches, OfNothingFindNothing) {
  const CrossSearch empty(grid, {0.5, 0.5, 0.5}, {x[0].data(), x[1].data(), x[2].data()}, {});
  CrossSearch::Found found;
  empty.near_place({0, 0, 0}, static_cast<float>(base_support_radius), inverse_support_radius.data(), found);
  EXPECT_EQ(found.size, 0U);
  EXPECT_EQ(found.share2[0], 1);
}

INSTANTIATE_TEST_SUITE_P(Sets, CrossSearches, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "PointsAndImages" : "TwoSets"; });

}  // namespace
}  // namespace spume::test
