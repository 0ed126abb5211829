// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include "spume/core/periodic_grid.hpp"
#include "spume/core/random.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/periodic_cells.hpp"

namespace spume::test {
namespace {

struct Points {
  Array<double> x, y, z;
  explicit Points(std::size_t n) : x(n), y(n), z(n) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto r = random_uniform(3, RandomPurpose::test, i, 0, 0);
      x[i] = -1 + 2 * r[0];
      y[i] = 3 * r[1];
      z[i] = 0.5 * r[2];
    }
  }
};

const PeriodicCells cells{{-1, 0, 0}, {2, 3, 0.5}, {7, 5, 4}};

std::int64_t cell_of(const Points& p, std::size_t i) {
  const auto along = [&](double v, int axis) {
    return static_cast<std::int64_t>(std::floor((v - cells.lower[axis]) / cells.side(axis)));
  };
  return (along(p.x[i], 0) * 5 + along(p.y[i], 1)) * 4 + along(p.z[i], 2);
}

class Order : public testing::TestWithParam<std::size_t> {};

TEST_P(Order, AscendsByCellAndKeepsTheOrderWithinACell) {
  const Points p(GetParam());
  CellOrder order;
  order.build(cells, p.x.data(), p.y.data(), p.z.data(), p.x.size());
  ASSERT_EQ(order.order().size(), p.x.size());
  for (std::size_t k = 1; k < p.x.size(); ++k) {
    const auto a = static_cast<std::size_t>(order.order()[k - 1]), b = static_cast<std::size_t>(order.order()[k]);
    ASSERT_TRUE(cell_of(p, a) < cell_of(p, b) || (cell_of(p, a) == cell_of(p, b) && a < b)) << k;
  }
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::int32_t k = order.first()[c]; k < order.first()[c + 1]; ++k)
      ASSERT_EQ(cell_of(p, static_cast<std::size_t>(order.order()[static_cast<std::size_t>(k)])),
                static_cast<std::int64_t>(c));
  EXPECT_EQ(order.first()[cells.size()], static_cast<std::int32_t>(p.x.size()));
}

INSTANTIATE_TEST_SUITE_P(Sizes, Order, testing::Values(0, 1, 37, 4096, 4097, 20000));

TEST(CellOrderOfPoints, IsTheSameForAnyNumberOfThreads) {
  const Points p(50000);
  CellOrder one, three;
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  one.build(cells, p.x.data(), p.y.data(), p.z.data(), p.x.size());
  omp_set_num_threads(3);
  three.build(cells, p.x.data(), p.y.data(), p.z.data(), p.x.size());
  omp_set_num_threads(before);
  for (std::size_t k = 0; k < p.x.size(); ++k) ASSERT_EQ(one.order()[k], three.order()[k]);
}

TEST(PeriodicCellsOfASide, AreNoMoreThanWantedInBoxesOfAnyShape) {
  const auto counts = [](std::array<double, 3> length, double least_side, double most_cells) {
    return PeriodicCells::with_side({0, 0, 0}, length, least_side, most_cells).count;
  };
  using Counts = std::array<int, 3>;
  EXPECT_EQ(counts({100, 100, 100}, 1, 64), (Counts{4, 4, 4}));
  EXPECT_EQ(counts({100, 100, 1}, 0.1, 64), (Counts{8, 8, 1}));
  EXPECT_EQ(counts({1, 100, 0.01}, 0.001, 64), (Counts{1, 64, 1}));
  EXPECT_EQ(counts({100, 10, 1}, 20, 64), (Counts{5, 1, 1}));
  EXPECT_EQ(counts({100, 100, 1}, 3, 1e18), (Counts{33, 33, 1}));
  EXPECT_EQ(counts({1, 1, 1}, 2, 64), (Counts{1, 1, 1}));
}

TEST(CellOrderOfPoints, TellsWhenNothingMoves) {
  Points p(3000);
  CellOrder order;
  order.build(cells, p.x.data(), p.y.data(), p.z.data(), p.x.size());
  EXPECT_FALSE(order.already_sorted());
  Points sorted(3000);
  for (std::size_t k = 0; k < 3000; ++k) {
    const auto i = static_cast<std::size_t>(order.order()[k]);
    sorted.x[k] = p.x[i];
    sorted.y[k] = p.y[i];
    sorted.z[k] = p.z[i];
  }
  order.build(cells, sorted.x.data(), sorted.y.data(), sorted.z.data(), 3000);
  EXPECT_TRUE(order.already_sorted());
}

TEST(PeriodicBox, WrapsIntoTheHalfOpenInterval) {
  EXPECT_EQ(wrap_periodic(0.25, 0, 1), 0.25);
  EXPECT_EQ(wrap_periodic(1.25, 0, 1), 0.25);
  EXPECT_EQ(wrap_periodic(-0.25, 0, 1), 0.75);
  EXPECT_EQ(wrap_periodic(1, 0, 1), 0);
  EXPECT_LT(wrap_periodic(-1e-300, 0, 1), 1);
  EXPECT_LT(wrap_periodic(std::nextafter(2.0, 0.0) + 5, 2, 1), 3);
  EXPECT_TRUE(std::isnan(wrap_periodic(std::nan(""), 0, 1)));
}

}  // namespace
}  // namespace spume::test
