// SPDX-License-Identifier: MIT
// Lists between two sets of points against all pairs.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "neighbours/neighbourhood.hpp"
#include "spume/neighbours/cross_list.hpp"

namespace spume::test {
namespace {

constexpr double base_reach = 0.12;

struct Sorted {
  CellTable table;
  std::array<Array<float>, 3> x;
  std::size_t size = 0;

  Sorted(const CellGrid& grid, const std::vector<Point>& points) : size(points.size()) {
    const auto px = Neighbourhood::column(points, 0), py = Neighbourhood::column(points, 1),
               pz = Neighbourhood::column(points, 2);
    CellTable first;
    first.build(grid, px.data(), py.data(), pz.data(), size);
    std::vector<Point> sorted(size);
    for (std::size_t k = 0; k < size; ++k) sorted[k] = points[static_cast<std::size_t>(first.order()[k])];
    const auto sx = Neighbourhood::column(sorted, 0), sy = Neighbourhood::column(sorted, 1),
               sz = Neighbourhood::column(sorted, 2);
    table.build(grid, sx.data(), sy.data(), sz.data(), size);
    for (int a = 0; a < 3; ++a) {
      x[a].resize(size + 8);
      for (std::size_t k = 0; k < size; ++k) x[a][k] = static_cast<float>(sorted[k][a] - 0.5);
    }
  }
  std::array<const float*, 3> pointers() const { return {x[0].data(), x[1].data(), x[2].data()}; }
};

std::vector<Point> points_from(std::size_t n, std::uint32_t draw) {
  std::vector<Point> points(n);
  // A tenth lies outside the grid, where border cells hold it.
  for (std::size_t k = 0; k < n; ++k)
    for (int a = 0; a < 3; ++a) points[k][a] = k % 10 == 0 ? 1.3 * uniform(k, draw)[a] - 0.15 : uniform(k, draw)[a];
  return points;
}

class CrossLists : public ::testing::TestWithParam<int> {};

TEST_P(CrossLists, HoldAllPairsWithinTheReachAndAreTransposesOfEachOther) {
  omp_set_num_threads(GetParam());
  const CellGrid grid(3, {0, 0, 0}, {1, 1, 1}, base_reach, 3000);
  const Sorted particles(grid, points_from(3000, 41)), bubbles(grid, points_from(170, 42));
  Array<float> reach(particles.size + 8);
  for (std::size_t i = 0; i < particles.size; ++i)
    reach[i] = static_cast<float>(base_reach * (1 + 0.26 * uniform(i, 43)[0]));
  CrossList::Geometry geometry;
  geometry.grid = &grid;
  geometry.origin = {0.5, 0.5, 0.5};
  geometry.largest_reach = static_cast<float>(1.26 * base_reach);
  geometry.centre = bubbles.pointers();
  geometry.point = particles.pointers();
  geometry.point_reach = reach.data();
  CrossList of_bubbles, of_particles;
  const CrossList::Points particle_set[] = {{&particles.table, particles.size}};
  of_bubbles.build(geometry, bubbles.size, particle_set);
  std::swap(geometry.centre, geometry.point);
  geometry.point_reach = nullptr;
  geometry.centre_reach = reach.data();
  const CrossList::Points bubble_set[] = {{&bubbles.table, bubbles.size}};
  of_particles.build(geometry, particles.size, bubble_set);

  std::int64_t pairs = 0;
  for (std::size_t b = 0; b < bubbles.size; ++b) {
    std::vector<std::int32_t> found(of_bubbles.of(b).begin(), of_bubbles.of(b).end()), expected;
    for (std::size_t i = 0; i < particles.size; ++i) {
      float r2 = 0;
      for (int a = 0; a < 3; ++a) r2 += (particles.x[a][i] - bubbles.x[a][b]) * (particles.x[a][i] - bubbles.x[a][b]);
      if (std::abs(r2 - reach[i] * reach[i]) < 1e-6F * r2) {
        // Rounding decides; whatever it decides is not looked at.
        std::erase(found, static_cast<std::int32_t>(i));
        continue;
      }
      if (r2 < reach[i] * reach[i]) expected.push_back(static_cast<std::int32_t>(i));
    }
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, expected) << b;
    for (const std::int32_t i : of_bubbles.of(b)) {
      const auto back = of_particles.of(static_cast<std::size_t>(i));
      EXPECT_EQ(std::count(back.begin(), back.end(), static_cast<std::int32_t>(b)), 1);
    }
    for (const std::int32_t* k = of_bubbles.begin(b) + of_bubbles.count(b); k != of_bubbles.padded_end(b); ++k)
      EXPECT_EQ(*k, of_bubbles.nobody());
    pairs += of_bubbles.count(b);
  }
  EXPECT_EQ(of_bubbles.pair_count(), pairs);
  EXPECT_EQ(of_particles.pair_count(), pairs);
  omp_set_num_threads(2);
}

INSTANTIATE_TEST_SUITE_P(Threads, CrossLists, ::testing::Values(1, 3));

}  // namespace
}  // namespace spume::test
