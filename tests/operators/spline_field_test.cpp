// SPDX-License-Identifier: MIT
#include "spume/operators/spline_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "reference/spline_sum.hpp"
#include "spume/core/random.hpp"

namespace spume::test {
namespace {

PeriodicGrid grid_of(int nx, int ny, int nz) {
  PeriodicGrid grid;
  grid.lower = {-0.5, 1, 0};
  grid.length = {2, 1, 3};
  grid.points = {nx, ny, nz};
  grid.z_stride = static_cast<std::size_t>(nz) + 2;
  return grid;
}

// One Fourier mode per component, with waves (kx, ky, kz) per box.
struct Mode {
  std::array<int, 3> wave;
  double phase;
  double value(const PeriodicGrid& g, const std::array<double, 3>& x) const { return std::sin(angle(g, x)); }
  double slope(const PeriodicGrid& g, const std::array<double, 3>& x, int axis) const {
    return 2 * M_PI * wave[axis] / g.length[axis] * std::cos(angle(g, x));
  }
  double angle(const PeriodicGrid& g, const std::array<double, 3>& x) const {
    double a = phase;
    for (int c = 0; c < 3; ++c) a += 2 * M_PI * wave[c] * (x[c] - g.lower[c]) / g.length[c];
    return a;
  }
  // A mode is an eigenvector of the interpolation: its coefficients are the mode times the prefilter.
  std::vector<double> coefficients(const PeriodicGrid& g, int order) const {
    std::vector<double> c(g.storage());
    double factor = 1;
    for (int a = 0; a < 3; ++a) factor *= b_spline_prefilter(order, wave[a], g.points[a]);
    for (int i = 0; i < g.points[0]; ++i)
      for (int j = 0; j < g.points[1]; ++j)
        for (int k = 0; k < g.points[2]; ++k)
          c[g.row(i, j) + static_cast<std::size_t>(k)] =
              factor *
              value(g, {g.lower[0] + i * g.spacing(0), g.lower[1] + j * g.spacing(1), g.lower[2] + k * g.spacing(2)});
    return c;
  }
};

const std::array<Mode, 3> modes{Mode{{1, 0, -2}, 0.3}, Mode{{0, 2, 1}, 1.1}, Mode{{-1, 1, 1}, 2.0}};

std::vector<std::array<double, 3>> places(const PeriodicGrid& g, std::size_t n) {
  std::vector<std::array<double, 3>> x(n);
  for (std::size_t p = 0; p < n; ++p) {
    const auto r = random_uniform(5, RandomPurpose::test, p, 0, 0);
    for (int c = 0; c < 3; ++c) x[p][c] = g.lower[c] + r[c] * g.length[c];
  }
  return x;
}

// Values (first three) and gradients (3 + 3 c + axis) at the points.
template <class Real>
std::array<std::vector<double>, 12> gathered(const SplineField<Real>& field,
                                             const std::vector<std::array<double, 3>>& x) {
  std::array<std::vector<double>, 12> out;
  std::array<std::vector<double>, 3> position;
  for (int c = 0; c < 3; ++c)
    for (const auto& p : x) position[c].push_back(p[c]);
  for (auto& v : out) v.resize(x.size());
  std::array<double*, 9> gradient;
  for (int i = 0; i < 9; ++i) gradient[i] = out[3 + i].data();
  gather(field, x.size(), {position[0].data(), position[1].data(), position[2].data()},
         {out[0].data(), out[1].data(), out[2].data()}, &gradient);
  return out;
}

template <class Real>
SplineField<Real> field_of_modes(const PeriodicGrid& g, int order) {
  SplineField<Real> field(g, order);
  std::array<std::vector<double>, 3> c;
  for (int i = 0; i < 3; ++i) c[i] = modes[i].coefficients(g, order);
  field.fill(std::array<const double*, 3>{c[0].data(), c[1].data(), c[2].data()});
  return field;
}

class Splines : public testing::TestWithParam<int> {};

TEST_P(Splines, WeightsAreTheTruncatedPowersAndTheirDerivatives) {
  const int order = GetParam();
  with_spline_order(order, [](auto m) {
    for (const double t : {0.0, 0.2, 0.5, 0.77, 1.0}) {
      double w[m()], dw[m()];
      BSpline<m()>::weights(t, w, dw);
      double sum = 0, slopes = 0;
      for (int i = 0; i < m(); ++i) {
        // The hat function has no slope at its nodes.
        EXPECT_NEAR(w[i], b_spline(m(), t - (i - BSpline<m()>::below)), 1e-14);
        if (m() > 2 || (t > 0 && t < 1)) {
          EXPECT_NEAR(dw[i], b_spline_slope(m(), t - (i - BSpline<m()>::below)), 1e-13);
        }
        sum += w[i];
        slopes += dw[i];
      }
      EXPECT_NEAR(sum, 1, 1e-15);
      EXPECT_NEAR(slopes, 0, 1e-15);
    }
  });
}

TEST_P(Splines, AgreeWithTheDirectSum) {
  const int order = GetParam();
  const PeriodicGrid g = grid_of(8, 7, 9);
  std::array<std::vector<double>, 3> c;
  for (int i = 0; i < 3; ++i) {
    c[i].resize(g.storage());
    for (std::size_t k = 0; k < c[i].size(); ++k) c[i][k] = random_uniform(7, RandomPurpose::test, k, 0, 0)[i] - 0.5;
  }
  SplineField<double> field(g, order);
  field.fill(std::array<const double*, 3>{c[0].data(), c[1].data(), c[2].data()});
  auto x = places(g, 50);
  x.push_back({g.lower[0], g.lower[1], g.lower[2]});
  x.push_back({g.lower[0] + std::nextafter(2.0, 0.0), g.lower[1] + std::nextafter(1.0, 0.0), std::nextafter(3.0, 0.0)});
  const auto out = gathered(field, x);
  for (std::size_t p = 0; p < x.size(); ++p)
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(out[i][p], spline_sum(g, c[i], order, x[p], -1), 1e-13);
      // At the grid points the slope of the linear spline jumps.
      for (int axis = 0; axis < 3 && (order > 2 || p < 50); ++axis)
        EXPECT_NEAR(out[3 + 3 * i + axis][p], spline_sum(g, c[i], order, x[p], axis), 1e-12);
    }
}

TEST_P(Splines, ReproduceTheFieldAtTheGridPoints) {
  const int order = GetParam();
  const PeriodicGrid g = grid_of(8, 12, 10);
  const auto field = field_of_modes<double>(g, order);
  std::vector<std::array<double, 3>> x;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 12; ++j)
      for (int k = 0; k < 10; ++k)
        x.push_back({g.lower[0] + i * g.spacing(0), g.lower[1] + j * g.spacing(1), g.lower[2] + k * g.spacing(2)});
  const auto out = gathered(field, x);
  for (std::size_t p = 0; p < x.size(); ++p)
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(out[c][p], modes[c].value(g, x[p]), 1e-13);
}

// Errors fall as spacing^order (values) and spacing^(order - 1) (gradients).
TEST_P(Splines, ConvergeAtTheirOrder) {
  const int order = GetParam();
  double value_error[2] = {}, slope_error[2] = {};
  for (int level = 0; level < 2; ++level) {
    const int n = 32 << level;
    const PeriodicGrid g = grid_of(n, n, n);
    const auto field = field_of_modes<double>(g, order);
    const auto x = places(g, 2000);
    const auto out = gathered(field, x);
    for (std::size_t p = 0; p < x.size(); ++p)
      for (int c = 0; c < 3; ++c) {
        value_error[level] += std::pow(out[c][p] - modes[c].value(g, x[p]), 2);
        for (int axis = 0; axis < 3; ++axis)
          slope_error[level] += std::pow(out[3 + 3 * c + axis][p] - modes[c].slope(g, x[p], axis), 2);
      }
  }
  EXPECT_NEAR(0.5 * std::log2(value_error[0] / value_error[1]), order, 0.15);
  EXPECT_NEAR(0.5 * std::log2(slope_error[0] / slope_error[1]), order - 1, 0.15);
}

TEST_P(Splines, SinglePrecisionRoundsAndNoMore) {
  const int order = GetParam();
  const PeriodicGrid g = grid_of(16, 18, 20);
  const auto exact = field_of_modes<double>(g, order);
  const auto rounded = field_of_modes<float>(g, order);
  const auto x = places(g, 500);
  const auto a = gathered(exact, x), b = gathered(rounded, x);
  // Sums of order^3 terms of about 1: a few roundings of 6e-8; slopes are larger by 2 / spacing.
  for (std::size_t p = 0; p < x.size(); ++p)
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(a[i][p], b[i][p], (i < 3 ? 1 : 40) * 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Orders, Splines, testing::Values(2, 4, 6));

TEST(SnapshotsOfAField, PresentBecomesPrevious) {
  const PeriodicGrid g = grid_of(4, 5, 6);
  SplineField<double> field(g, 4);
  const auto constant = [&](double value) { return std::vector<double>(g.storage(), value); };
  for (int step = 0; step < 3; ++step) {
    const auto a = constant(step), b = constant(10 + step), c = constant(20 + step);
    field.fill(std::array<const double*, 3>{a.data(), b.data(), c.data()});
    auto u = constant(-1), v = constant(-1), w = constant(-1);
    field.unpack(1, {u.data(), v.data(), w.data()});
    EXPECT_EQ(w[g.row(3, 4) + 5], 20 + step);
    field.unpack(0, {u.data(), v.data(), w.data()});
    EXPECT_EQ(v[g.row(2, 1) + 3], 10 + std::max(step - 1, 0));
    EXPECT_NEAR(gathered(field, {{0.1, 1.2, 0.3}})[0][0], step, 1e-14);
  }
}

TEST(SnapshotsOfAField, RefuseOtherOrders) {
  EXPECT_THROW(SplineField<double>(grid_of(4, 4, 4), 3), std::invalid_argument);
}

}  // namespace
}  // namespace spume::test
