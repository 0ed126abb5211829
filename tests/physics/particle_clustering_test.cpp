// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "spume/core/random.hpp"
#include "spume/physics/point_particles/clustering.hpp"
#include "spume/physics/point_particles/lyapunov.hpp"

namespace spume::test {
namespace {

struct Points {
  std::array<double, 3> lower{0, 0, 0}, length{1, 2, 1};
  std::array<Array<double>, 3> x;
  std::array<const double*, 3> data() const { return {x[0].data(), x[1].data(), x[2].data()}; }
  std::size_t size() const { return x[0].size(); }
  // Random in the box, in a plane, or on a line.
  Points(std::size_t n, int dimensions) {
    for (int c = 0; c < 3; ++c) {
      x[c].resize(n);
      for (std::size_t i = 0; i < n; ++i)
        x[c][i] = c < dimensions ? length[c] * random_uniform(4, RandomPurpose::test, i, 0, 0)[c] : 0.3;
    }
  }
};

TEST(PairStatisticsOfParticles, AreThoseOfTheDirectCount) {
  const Points points(400, 3);
  const auto pairs = pair_statistics(points.lower, points.length, points.data(), 400, 0.02, 0.4, 6, 400);
  for (std::size_t b = 0; b < pairs.radius.size(); ++b) {
    double within = 0;
    for (std::size_t i = 0; i < 400; ++i)
      for (std::size_t j = 0; j < 400; ++j) {
        double d2 = 0;
        for (int c = 0; c < 3; ++c) d2 += std::pow(nearest_image(points.x[c][i] - points.x[c][j], points.length[c]), 2);
        within += i != j && std::sqrt(d2) < pairs.radius[b] ? 1 : 0;
      }
    EXPECT_NEAR(pairs.correlation[b], within / 400, 1e-12);
  }
}

// Of 39 particles those with even numbers stand apart, the others in pairs: every second is looked at when 20 may be.
TEST(PairStatisticsOfParticles, LookAtNoMoreCentresThanAllowed) {
  Points points(39, 0);
  for (std::size_t i = 0; i < 39; ++i) {
    points.x[0][i] = i % 2 == 0 ? 0.025 * static_cast<double>(i) : 0.1 * static_cast<double>(i / 4) + 0.005 * (i % 4);
    points.x[1][i] = i % 2 == 0 ? 1 : 0.3;
  }
  const auto neighbours = [&](std::size_t centres) {
    return pair_statistics(points.lower, points.length, points.data(), 39, 0.001, 0.02, 4, centres).correlation.back();
  };
  EXPECT_EQ(neighbours(20), 0);
  EXPECT_NEAR(neighbours(39), 18.0 / 39, 1e-15);
}

// Of n points a bin finds about n^2 shell / box pairs, and scatters by the root of half of that.
TEST(PairStatisticsOfParticles, KnowTheDimensionOfTheSet) {
  for (const int dimensions : {1, 2, 3}) {
    const Points points(20000, dimensions);
    const auto pairs = pair_statistics(points.lower, points.length, points.data(), 20000, 0.01, 0.2, 12, 5000);
    EXPECT_NEAR(correlation_dimension(pairs, 0.02, 0.2), dimensions, 0.03) << dimensions;
    if (dimensions == 3) {
      for (std::size_t b = 4; b < 12; ++b) EXPECT_NEAR(pairs.radial_distribution[b], 1, 0.05);
    }
  }
}

TEST(BoxCounts, ScatterAsThoseOfRandomPointsOrOfALattice) {
  const Points random(40000, 3);
  const PeriodicCells boxes{random.lower, random.length, {10, 20, 10}};
  // The ratio of variance to mean of 2000 boxes has a standard error of sqrt(2 / 2000).
  EXPECT_NEAR(box_count_variance(boxes, random.data(), random.size()), 1, 4 * std::sqrt(2.0 / 2000));
  Points lattice(2000, 3);
  for (std::size_t i = 0; i < 2000; ++i) {
    lattice.x[0][i] = (static_cast<double>(i % 10) + 0.5) / 10;
    lattice.x[1][i] = (static_cast<double>(i / 10 % 20) + 0.5) / 10;
    lattice.x[2][i] = (static_cast<double>(i / 200) + 0.5) / 10;
  }
  EXPECT_EQ(box_count_variance(boxes, lattice.data(), 2000), 0);
}

// Boxes of every size: random points scatter as Poisson's, a lattice not at all, and a cluster of everything in one box
// of M has the variance N^2 (1/M) (1 - 1/M), N times that of random points.
TEST(BoxCounts, TellRandomPointsFromALatticeAndAClusterAtEverySize) {
  const std::array<double, 3> lower{0, 0, 0}, length{1, 2, 1};
  Points random(65536, 3), lattice(65536, 3), cluster(1000, 3);
  for (std::size_t i = 0; i < 65536; ++i) {
    lattice.x[0][i] = (static_cast<double>(i % 32) + 0.5) / 32;
    lattice.x[1][i] = (static_cast<double>(i / 32 % 64) + 0.5) / 32;
    lattice.x[2][i] = (static_cast<double>(i / 2048) + 0.5) / 32;
  }
  for (int c = 0; c < 3; ++c) cluster.x[c].fill(0.3);
  const auto of = [&](const Points& p) { return box_counts(lower, length, p.data(), p.size(), 1.0 / 32); };
  const auto a = of(random), b = of(lattice), c = of(cluster);
  ASSERT_EQ(a.size(), 5U);  // sides of 1/32 to 1/2
  for (std::size_t s = 0; s < a.size(); ++s) {
    const double boxes = 2 * std::pow(32 >> s, 3);
    EXPECT_NEAR(a[s].side, std::ldexp(1.0 / 32, static_cast<int>(s)), 1e-12);
    EXPECT_NEAR(a[s].mean, 65536 / boxes, 1e-9);
    // The variance of the estimate is 2 / boxes, and 1 / (boxes mean) more where boxes hold few points.
    EXPECT_NEAR(a[s].variance, 1, 4 * std::sqrt((2 + 1 / a[s].mean) / boxes)) << s;
    EXPECT_EQ(b[s].variance, 0) << s;
    EXPECT_NEAR(c[s].variance, 1000, 1e-6) << s;
  }
}

TEST(KaplanYorkeDimension, InterpolatesTheSumOfExponents) {
  EXPECT_NEAR(kaplan_yorke_dimension({1, 0, -2, -5, -6, -7}), 2.5, 1e-15);
  EXPECT_NEAR(kaplan_yorke_dimension({-1, -2, -3, -5, -6, -7}), 0, 1e-15);
  EXPECT_NEAR(kaplan_yorke_dimension({2, 1, -3, -5, -6, -7}), 3, 1e-15);
}

// Fluid at rest in a unit cube, and particles that follow it within tau = 0.5.
struct StillFluid {
  SplineField<double> field{PeriodicGrid{.length = {1, 1, 1}, .points = {8, 8, 8}, .z_stride = 8}, 4};
  MotionModel model;

  StillFluid() {
    const std::vector<double> zero(512, 0.0);
    field.fill(std::array<const double*, 3>{zero.data(), zero.data(), zero.data()});
    model.response_time = 0.5;
  }
};

// dV/dt = -V / tau: exponents 0 three times and -1 / tau three times.
TEST(LyapunovExponents, OfStillFluidAreZeroAndTheDrag) {
  StillFluid still;
  auto& [field, model] = still;
  LyapunovTracker tracker(field, 10, model.response_time, 0.01, 1);
  for (int step = 0; step < 400; ++step) tracker.advance(model, field, 0.05);
  const auto growth = tracker.stretching();
  const double t = 20;
  // The directions turn into place within a few tau, which leaves a constant of about 1 in the growth. Offsets of
  // 1e-6 in places of 1 carry 1e-10.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(growth[k] / t, 0, 1.0 / t);
  for (int k = 3; k < 6; ++k) EXPECT_NEAR(growth[k] / t, -2, 1.0 / t);
  double sum = 0;
  for (const double g : growth) sum += g;
  EXPECT_NEAR(sum / t, -6, 1e-6);
}

// Particles at the slip v lose it as dv/dt = -(1 + 0.15 Re^0.687) v / tau, Re = v D / nu: a difference of slips shrinks
// at the rate (1 + 1.687 * 0.15 Re^0.687) / tau along the slip and (1 + 0.15 Re^0.687) / tau across it.
TEST(LyapunovExponents, TakeTheReynoldsNumberOfTheirDiameter) {
  StillFluid still;
  auto& [field, model] = still;
  model.viscosity = 0.01;
  model.drag = DragLaw::schiller_naumann;
  const double slip = 0.5, diameter = 0.01, dt = 1e-3;
  LyapunovTracker tracker(field, 5, model.response_time, diameter, 1);
  for (double& v : *tracker.particles().velocity[0]) v += slip;
  tracker.advance(model, field, dt);
  double sum = 0;
  for (const double g : tracker.stretching()) sum += g;
  const double excess = 0.15 * std::pow(slip * diameter / model.viscosity, 0.687);
  // The sum over all directions is minus the divergence of the motion in phase space; the slip falls by 2e-3 in a step.
  EXPECT_NEAR(sum / dt, -((1 + 1.687 * excess) + 2 * (1 + excess)) / model.response_time, 2e-3 / model.response_time);
}

// A tracer-like particle at the stagnation points of the flow (sin x cos y, -cos x sin y, 0): it stays at the origin,
// where dx/dt = x, dy/dt = -y; exponents +1, 0, -1 for vanishing response time.
TEST(LyapunovExponents, AtAStagnationPointAreItsStrainRates) {
  PeriodicGrid grid;
  grid.length = {2 * M_PI, 2 * M_PI, 2 * M_PI};
  grid.points = {32, 32, 4};
  grid.z_stride = 4;
  SplineField<double> field(grid, 6);
  std::vector<double> u(grid.storage()), v(grid.storage()), w(grid.storage());
  const double factor = std::pow(b_spline_prefilter(6, 1, 32), 2);
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 32; ++j)
      for (std::size_t k = 0; k < 4; ++k) {
        const double x = i * grid.spacing(0), y = j * grid.spacing(1);
        u[grid.row(i, j) + k] = factor * std::sin(x) * std::cos(y);
        v[grid.row(i, j) + k] = -factor * std::cos(x) * std::sin(y);
      }
  field.fill(std::array<const double*, 3>{u.data(), v.data(), w.data()});
  MotionModel model;
  model.response_time = 0.01;
  LyapunovTracker tracker(field, 1, model.response_time, 0.01, 1);
  // Held at the origin, shadows and all.
  for (std::size_t p = 0; p < 7; ++p)
    for (int c = 0; c < 3; ++c) {
      const double offset = (*tracker.particles().position[c])[p] - (*tracker.particles().position[c])[0];
      if (p > 0) (*tracker.particles().position[c])[p] = wrap_periodic(offset, 0, 2 * M_PI);
      (*tracker.particles().velocity[c])[p] -= (*tracker.particles().velocity[c])[0] * (p > 0 ? 1 : 0);
    }
  for (int c = 0; c < 3; ++c) {
    (*tracker.particles().position[c])[0] = 0;
    (*tracker.particles().velocity[c])[0] = 0;
  }
  const double dt = 0.01;
  for (int step = 0; step < 1000; ++step) tracker.advance(model, field, dt);
  const auto growth = tracker.stretching();
  // beta = 1: the slip vanishes along the path, so the exponents of the tracer hold for any response time; the start
  // leaves 1 in the growth, the step dt^2, the spline (2 pi / 32)^5 of its slope.
  const double expected[3] = {1, 0, -1};
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(growth[k] / 10, expected[k], 0.1 + 1e-3) << k;
  const auto dimension = kaplan_yorke_dimension(growth);
  EXPECT_NEAR(dimension, 3, 0.01);
}

}  // namespace
}  // namespace spume::test
