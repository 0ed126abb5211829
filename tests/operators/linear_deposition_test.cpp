// SPDX-License-Identifier: MIT
#include "spume/operators/linear_deposition.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <vector>

#include "reference/spline_sum.hpp"
#include "spume/core/random.hpp"

namespace spume::test {
namespace {

struct Cloud {
  PeriodicGrid grid;
  std::vector<std::array<double, 3>> place;
  std::array<Array<double>, 3> position;
  Array<double> amounts;
  std::array<std::vector<double>, 3> force;
  std::vector<double> fraction;
  DepositionReport report;

  double volume;
  Array<double> diameter;  // of every particle, or empty

  Cloud(std::array<int, 3> points, std::size_t n, double common_volume) : volume(common_volume) {
    grid.lower = {1, -2, 0};
    grid.length = {2, 3, 1};
    grid.points = points;
    grid.z_stride = static_cast<std::size_t>(points[2]) + 3;
    amounts.resize(3 * n + 1);
    for (auto& x : position) x.resize(n);
    for (std::size_t p = 0; p < n; ++p) {
      const auto r = random_uniform(1, RandomPurpose::test, p, 0, 0),
                 a = random_uniform(1, RandomPurpose::test, p, 0, 1);
      place.push_back({});
      for (int c = 0; c < 3; ++c) {
        place[p][c] = position[c][p] = grid.lower[c] + grid.length[c] * r[c];
        amounts[3 * p + c] = a[c] - 0.3;
      }
    }
    for (auto& f : force) f.resize(grid.storage(), -7);
    fraction.resize(grid.storage(), -7);
  }
  void deposit(double most) {
    LinearDeposition deposition(grid);
    CellOrder order;
    order.build(deposition.cells(), position[0].data(), position[1].data(), position[2].data(), place.size());
    const DepositedParticles given{{position[0].data(), position[1].data(), position[2].data()},
                                   amounts.data(),
                                   diameter.empty() ? nullptr : diameter.data(),
                                   std::cbrt(6 / M_PI * volume)};
    report = deposition.deposit<double>(order, given, most, {force[0].data(), force[1].data(), force[2].data()},
                                        fraction.data());
  }
  template <class Use>
  void for_points(Use&& use) const {
    for (int i = 0; i < grid.points[0]; ++i)
      for (int j = 0; j < grid.points[1]; ++j)
        for (int k = 0; k < grid.points[2]; ++k) use(grid.row(i, j) + static_cast<std::size_t>(k));
  }
};

class Deposition : public testing::TestWithParam<std::array<int, 3>> {};

TEST_P(Deposition, AgreesWithTheDirectSum) {
  Cloud cloud(GetParam(), 700, 1e-4);
  cloud.deposit(1e9);
  for (int c = 0; c < 3; ++c) {
    std::vector<double> amount;
    for (std::size_t p = 0; p < 700; ++p) amount.push_back(cloud.amounts[3 * p + c]);
    const auto direct = linear_spread(cloud.grid, cloud.place, amount);
    const double scale = 700 / (6.0);  // all amounts, of up to 1, over the volume of the box
    cloud.for_points([&](std::size_t at) { ASSERT_NEAR(cloud.force[c][at], direct[at], 1e-13 * 50 * scale); });
  }
}

TEST_P(Deposition, GivesTheGridWhatTheParticlesGive) {
  Cloud cloud(GetParam(), 3000, 1e-4);
  for (std::size_t p = 0; p < 3000; ++p) {
    cloud.diameter.resize(p + 1);
    cloud.diameter[p] = 0.02 + 0.01 * std::sin(static_cast<double>(p));
  }
  cloud.deposit(1e9);
  for (int c = 0; c < 4; ++c) {
    double given = 0, received = 0, size = 0;
    for (std::size_t p = 0; p < 3000; ++p) {
      const double amount = c < 3 ? cloud.amounts[3 * p + c] : M_PI / 6 * std::pow(cloud.diameter[p], 3);
      given += amount;
      size += std::abs(amount);
    }
    const auto& field = c < 3 ? cloud.force[c] : cloud.fraction;
    cloud.for_points([&](std::size_t at) { received += field[at] * cloud.grid.cell_volume(); });
    EXPECT_NEAR(given, received, 1e-13 * size) << c;
  }
  EXPECT_EQ(cloud.report.clipped_force, 0);
}

INSTANTIATE_TEST_SUITE_P(Grids, Deposition,
                         testing::Values(std::array{8, 8, 8}, std::array{17, 5, 6}, std::array{3, 2, 1},
                                         std::array{1, 4, 2}, std::array{33, 70, 4}, std::array{2, 1, 5},
                                         std::array{4, 32, 3}, std::array{4, 33, 3}));

TEST(DepositionOfParticles, IsTheSameForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  Cloud one({40, 6, 6}, 20000, 1e-3), three({40, 6, 6}, 20000, 1e-3);
  omp_set_num_threads(1);
  one.deposit(0.7);
  omp_set_num_threads(3);
  three.deposit(0.7);
  omp_set_num_threads(before);
  one.for_points([&](std::size_t at) {
    for (int c = 0; c < 3; ++c) ASSERT_EQ(one.force[c][at], three.force[c][at]);
  });
  EXPECT_EQ(one.report.clipped_force, three.report.clipped_force);
  EXPECT_GT(one.report.clipped_force, 0);
}

TEST(DepositionOfParticles, ClipsWhereTheVolumeFractionIsTooHigh) {
  // All volume of one particle in one grid cell corner: alpha there is volume / cell volume.
  Cloud cloud({4, 4, 4}, 1, 2 * (2.0 * 3 * 1) / 64);
  for (int c = 0; c < 3; ++c) cloud.position[c][0] = cloud.grid.lower[c] + cloud.grid.spacing(c);
  const double cell = cloud.grid.cell_volume();
  const double amounts[3] = {3, 0, 4};
  std::copy(amounts, amounts + 3, cloud.amounts.data());
  cloud.deposit(0.5);
  const std::size_t at = cloud.grid.row(1, 1) + 1;
  EXPECT_NEAR(cloud.fraction[at], 2, 1e-14);
  EXPECT_NEAR(cloud.force[0][at], 3 / cell / 4, 1e-12 / cell);
  EXPECT_NEAR(cloud.force[2][at], 4 / cell / 4, 1e-12 / cell);
  EXPECT_NEAR(cloud.report.force, 7, 1e-13);
  EXPECT_NEAR(cloud.report.clipped_force, 0.75 * 7, 1e-13);
  EXPECT_NEAR(cloud.report.clipped_volume, cell, 1e-14);
  EXPECT_NEAR(cloud.report.most_volume_fraction, 2, 1e-14);
}

// More tiles than partial results, all of odd depth: one thread's planes change places from tile to tile.
TEST(DepositionOfParticles, KeepsToItsPlanesOverManyThinTiles) {
  Cloud cloud({1, 257 * 32, 40}, 2000, 1e-3);
  cloud.deposit(1e9);
  double total = 0, given = 0;
  cloud.for_points([&](std::size_t at) { total += cloud.force[1][at]; });
  for (std::size_t p = 0; p < 2000; ++p) given += cloud.amounts[3 * p + 1];
  EXPECT_NEAR(total * cloud.grid.cell_volume(), given, 1e-12 * 2000);
}

TEST(DepositionOfParticles, WithoutParticlesIsZero) {
  Cloud cloud({5, 4, 3}, 0, 0);
  cloud.deposit(0.7);
  cloud.for_points([&](std::size_t at) { ASSERT_EQ(cloud.force[1][at], 0); });
}

}  // namespace
}  // namespace spume::test
