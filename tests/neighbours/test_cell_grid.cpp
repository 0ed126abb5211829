// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <numeric>

#include "neighbours/neighbourhood.hpp"
#include "spume/core/borrowed_array.hpp"
#include "spume/core/field_set.hpp"

namespace spume::test {
namespace {

struct Sorted {
  CellGrid grid;
  CellOrder table;
  Array<double> x, y, z;
  Sorted(int dimensions, const std::vector<Point>& points)
      : grid(dimensions, {0, 0, 0}, {1, 1, 1}, 0.1, points.size()),
        x(Neighbourhood::column(points, 0)),
        y(Neighbourhood::column(points, 1)),
        z(Neighbourhood::column(points, 2)) {
    table.build(grid, x.data(), y.data(), dimensions == 3 ? z.data() : nullptr, points.size());
  }
  std::int64_t cell(std::size_t i) const { return grid.cell(x[i], y[i], grid.dimensions() == 3 ? z[i] : 0); }
};

class Sort : public testing::TestWithParam<int> {};

TEST_P(Sort, OrdersByCellAndKeepsTheOrderWithinACell) {
  auto points = random_points(5000, GetParam());
  points.resize(6000, points[17]);
  const Sorted sorted(GetParam(), points);
  const auto& order = sorted.table.order();
  ASSERT_EQ(order.size(), points.size());
  for (std::size_t k = 1; k < order.size(); ++k) {
    const auto before = sorted.cell(static_cast<std::size_t>(order[k - 1]));
    const auto here = sorted.cell(static_cast<std::size_t>(order[k]));
    ASSERT_TRUE(before < here || (before == here && order[k - 1] < order[k])) << k;
  }
  std::vector<std::int32_t> all(order.begin(), order.end());
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], static_cast<std::int32_t>(i));
}

TEST_P(Sort, TableBoundsTheParticlesOfEveryCell) {
  const auto points = clustered_points(3000, GetParam(), 0.2);
  const Sorted sorted(GetParam(), points);
  const std::int32_t* first = sorted.table.first();
  EXPECT_EQ(first[0], 0);
  EXPECT_EQ(first[sorted.grid.cell_count()], 3000);
  for (std::int64_t c = 0; c < sorted.grid.cell_count(); ++c)
    for (std::int32_t k = first[c]; k < first[c + 1]; ++k)
      ASSERT_EQ(sorted.cell(static_cast<std::size_t>(sorted.table.order()[static_cast<std::size_t>(k)])), c);
}

TEST_P(Sort, DoesNotDependOnTheThreadCount) {
  const auto points = clustered_points(30000, GetParam(), 0.05);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Sorted one(GetParam(), points);
  for (const int threads : {2, 3, 5}) {
    omp_set_num_threads(threads);
    const Sorted many(GetParam(), points);
    EXPECT_TRUE(std::equal(one.table.order().begin(), one.table.order().end(), many.table.order().begin()));
  }
  omp_set_num_threads(before);
}

// What only a build uses is the pool's again, and the next build finds it there.
TEST_P(Sort, BorrowedMemoryGivesTheSameOrder) {
  const auto points = clustered_points(30000, GetParam(), 0.05);
  const Sorted own(GetParam(), points);
  ScratchPool pool;
  CellOrder table;
  double idle = 0;
  for (int round = 0; round < 2; ++round) {
    const BorrowedArray<std::int32_t> order(pool, points.size());
    table.build(own.grid, own.x.data(), own.y.data(), GetParam() == 3 ? own.z.data() : nullptr, points.size(), pool,
                order.data());
    EXPECT_TRUE(std::equal(own.table.order().begin(), own.table.order().end(), order.data()));
    EXPECT_TRUE(std::equal(own.table.first(), own.table.first() + own.grid.cell_count() + 1, table.first()));
    EXPECT_EQ(table.already_sorted(), own.table.already_sorted());
    EXPECT_EQ(table.build_traffic(), own.table.build_traffic());
    if (round == 1) {
      EXPECT_EQ(pool.idle_bytes(), idle);
    }
    idle = pool.idle_bytes();
  }
  EXPECT_EQ(own.table.bytes() - table.bytes(), 14.0 * static_cast<double>(points.size()));
  EXPECT_GE(idle, 10.0 * static_cast<double>(points.size()));
}

TEST_P(Sort, SortedPointsStayAndAllFieldsMoveTogether) {
  const auto points = random_points(4000, GetParam());
  Sorted sorted(GetParam(), points);
  EXPECT_FALSE(sorted.table.already_sorted());
  FieldSet fields;
  fields.resize(points.size());
  auto& x = fields.add<double>("x", Lifetime::state);
  auto& y = fields.add<double>("y", Lifetime::state);
  auto& z = fields.add<double>("z", Lifetime::state);
  auto& mass = fields.add<float>("mass", Lifetime::state);
  auto& identifier = fields.add<std::int64_t>("identifier", Lifetime::state);
  auto& kind = fields.add<std::int32_t>("kind", Lifetime::state);
  for (std::size_t i = 0; i < points.size(); ++i) {
    x[i] = points[i][0];
    y[i] = points[i][1];
    z[i] = points[i][2];
    mass[i] = static_cast<float>(i);
    identifier[i] = static_cast<std::int64_t>(i) << 33;
    kind[i] = static_cast<std::int32_t>(i) - 7;
  }
  fields.permute(sorted.table.order());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto i = static_cast<std::size_t>(identifier[k] >> 33);
    ASSERT_EQ(i, static_cast<std::size_t>(sorted.table.order()[k]));
    ASSERT_EQ((Point{x[k], y[k], z[k]}), points[i]);
    ASSERT_EQ(mass[k], static_cast<float>(i));
    ASSERT_EQ(kind[k], static_cast<std::int32_t>(i) - 7);
  }
  sorted.table.build(sorted.grid, x.data(), y.data(), z.data(), points.size());
  EXPECT_TRUE(sorted.table.already_sorted());
}

TEST_P(Sort, AcceptsNothingAndOnePoint) {
  const Sorted nothing(GetParam(), {});
  EXPECT_TRUE(nothing.table.already_sorted());
  EXPECT_EQ(nothing.table.first()[nothing.grid.cell_count()], 0);
  const Sorted one(GetParam(), {{0.5, 0.5, 0.5}});
  EXPECT_EQ(one.table.first()[one.grid.cell_count()], 1);
}

INSTANTIATE_TEST_SUITE_P(Neighbours, Sort, testing::Values(2, 3));

TEST(CellGrid, PutsPointsOutsideAndNotANumberIntoBorderCells) {
  const CellGrid grid(3, {0, 0, 0}, {1, 1, 1}, 0.1, 1000);
  for (int axis = 0; axis < 3; ++axis) {
    const int count = axis == 0 ? grid.columns() : axis == 1 ? grid.rows_y() : grid.rows_z();
    EXPECT_EQ(grid.index(axis, -5), 0);
    EXPECT_EQ(grid.index(axis, std::nan("")), 0);
    EXPECT_EQ(grid.index(axis, 7), count - 1);
    EXPECT_EQ(grid.index(axis, 1e300), count - 1);
    EXPECT_EQ(grid.index(axis, 0.5), static_cast<int>(0.5 / grid.side(axis)));
  }
}

TEST(CellGrid, RowRanksAreAPermutation) {
  const CellGrid grid(3, {0, 0, 0}, {1, 0.7, 1.9}, 0.1, 1000);
  std::vector<int> seen(static_cast<std::size_t>(grid.rows_y()) * static_cast<std::size_t>(grid.rows_z()), 0);
  for (int iz = 0; iz < grid.rows_z(); ++iz)
    for (int iy = 0; iy < grid.rows_y(); ++iy) ++seen.at(static_cast<std::size_t>(grid.row(iy, iz)));
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
}

TEST(CellGrid, LimitsTheCellsOfALargeEmptyDomain) {
  const CellGrid grid(3, {0, 0, 0}, {1000, 1000, 1000}, 0.1, 1000);
  EXPECT_LE(grid.cell_count(), 4 * 1000 + 1048576);
  EXPECT_EQ(grid.support_radius(), 0.1);
}

}  // namespace
}  // namespace spume::test
