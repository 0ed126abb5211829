// SPDX-License-Identifier: MIT
// Sweeps over particles of different volumes and smoothing lengths against direct sums in double.
#include <gtest/gtest.h>

#include <cmath>

#include "neighbours/neighbourhood.hpp"
#include "operators/sph_arrangement.hpp"
#include "reference/surface_layers.hpp"
#include "spume/operators/pressure_operator.hpp"
#include "spume/operators/surface_layers.hpp"

namespace spume::test {
namespace {

constexpr int m = 9;
constexpr double spacing = 1.0 / m, h0 = 1.3 * spacing, volume = spacing * spacing * spacing;

struct Varying3D {
  Neighbourhood hood;
  Array<float> length_ratio, volume_ratio, support_radius;
  std::vector<Point> point;
  std::vector<std::size_t> source;
  SweepContext context;
  PackedNeighbours records;
  VelocityImageRule rule;
  std::vector<std::array<float, 3>> reflection;

  Varying3D()
      : hood(unit_box_rules(3, 2 * h0, ImageKind::periodic, ImageKind::periodic, ImageKind::periodic),
             on_float_grid(lattice_points(m, 3, 0.5))) {
    const std::size_t n = hood.n;
    length_ratio.resize(n);
    volume_ratio.resize(n);
    support_radius.resize(n);
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Point r = uniform(i, 31);
      const bool plain = i % 3 == 0;
      length_ratio[i] = static_cast<float>(plain ? 1 : 1 + 0.26 * r[0]);
      volume_ratio[i] = static_cast<float>(plain ? 1 : 1 + r[1]);
      support_radius[i] = static_cast<float>(2 * h0) * length_ratio[i];
      largest = std::max<double>(largest, support_radius[i]);
    }
    // The grid keeps the least reach, as in a run; images and lists look farther.
    hood.rules.support_radius = largest;
    hood.images.build(hood.rules, hood.grid, hood.x.data(), hood.y.data(), hood.z.data(), n);
    hood.list.build(hood.grid, hood.table, hood.x.data(), hood.y.data(), hood.z.data(), n, hood.images, hood.origin,
                    support_radius.data(), largest);
    point = hood.all();
    for (std::size_t k = 0; k < point.size(); ++k)
      source.push_back(k < n ? k : static_cast<std::size_t>(hood.images.source()[k - n]));
    context.list = &hood.list;
    context.images = &hood.images;
    context.smoothing_length = h0;
    context.volume = volume;
    context.length_ratio = length_ratio.data();
    context.volume_ratio = volume_ratio.data();
    rule.sign.assign(hood.images.paths().size(), {1, 1, 1});
    reflection.assign(hood.images.paths().size(), {1, 1, 1});
  }

  // visit(j, d = r_j - r_i, V_j W_ij, g_ij = -V_j F sigma / h_i^5) for all neighbours of i but itself.
  template <class Visit>
  void each(std::size_t i, Visit&& visit) const {
    const double h = h0 * length_ratio[i];
    for (std::size_t k = 0; k < point.size(); ++k) {
      if (k == i) continue;
      Point d;
      for (int a = 0; a < 3; ++a) d[a] = point[k][a] - point[i][a];
      const double q = std::hypot(d[0], d[1], d[2]) / h;
      if (q >= 2) continue;
      const double v = volume * volume_ratio[source[k]], sigma = WendlandC2::normalisation(3);
      visit(source[k], d, v * sigma / (h * h * h) * WendlandC2::w(q), -v * sigma / std::pow(h, 5) * WendlandC2::f(q));
    }
  }
};

Varying3D& varying() {
  static Varying3D arrangement;
  return arrangement;
}

// About 150 terms of one float rounding each, and those of the kernel.
constexpr double tolerance = 2e-5;

TEST(VaryingSizes, ListsHoldWhatIsWithinTheReachOfEach) {
  const Varying3D& v = varying();
  for (std::size_t i = 0; i < v.hood.n; ++i) {
    int count = 0;
    v.each(i, [&](std::size_t, const Point&, double, double) { ++count; });
    ASSERT_EQ(v.hood.list.count(i), count) << i;
  }
}

TEST(VaryingSizes, GeometryIsTheDirectSum) {
  Varying3D& v = varying();
  const std::size_t n = v.hood.n;
  std::array<Array<float>, 6> correction;
  std::array<Array<float>, 3> normal;
  Array<float> kernel_sum(n), divergence(n), laplacian_diagonal(n);
  Array<std::uint8_t> uncorrected(n);
  KernelMoments out;
  for (std::size_t k = 0; k < 6; ++k) {
    correction[k].resize(n);
    out.correction[k] = correction[k].data();
  }
  for (std::size_t a = 0; a < 3; ++a) {
    normal[a].resize(n);
    out.normal[a] = normal[a].data();
  }
  out.kernel_sum = kernel_sum.data();
  out.divergence_of_position = divergence.data();
  out.laplacian_diagonal = laplacian_diagonal.data();
  out.uncorrected = uncorrected.data();
  kernel_moment_sweep(v.context, v.records, {false, true, spacing}, out);
  for (std::size_t i = 0; i < n; ++i) {
    const double h = h0 * v.length_ratio[i];
    double w_sum = volume * v.volume_ratio[i] * WendlandC2::normalisation(3) / (h * h * h), g_sum = 0, trace = 0, x = 0,
           x_size = 0;
    v.each(i, [&](std::size_t, const Point& d, double w, double g) {
      w_sum += w;
      g_sum += 2 * g;
      trace += g * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      x -= h * g * d[0];
      x_size += std::abs(h * g * d[0]);
    });
    ASSERT_NEAR(kernel_sum[i], w_sum, tolerance * w_sum);
    ASSERT_NEAR(laplacian_diagonal[i], g_sum, tolerance * g_sum);
    ASSERT_NEAR(divergence[i], trace, tolerance * trace);
    ASSERT_NEAR(normal[0][i], x, tolerance * x_size);
  }
}

TEST(VaryingSizes, GradientDivergenceViscosityAndFiltersAreTheDirectSums) {
  Varying3D& v = varying();
  const std::size_t n = v.hood.n;
  std::array<Array<float>, 6> identity;
  std::array<const float*, 6> correction{};
  for (std::size_t k = 0; k < 6; ++k) {
    identity[k] = Array<float>(n, k == 0 || k == 3 || k == 5 ? 1.0F : 0.0F);
    correction[k] = identity[k].data();
  }
  VectorArrays<double> u(n, 3);
  VectorArrays<float> gradient(n, 3), viscous(n, 3), filtered(n, 3), values(n, 3);
  Array<double> p(n), divergence(n);
  Array<float> kappa(n), laplacian(n), scalar(n), smooth(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Point r = uniform(i, 32), s = uniform(i, 33);
    for (int a = 0; a < 3; ++a) {
      u[a][i] = static_cast<float>(r[a]);
      values[a][i] = static_cast<float>(r[a]);
    }
    p[i] = static_cast<float>(s[0]);
    kappa[i] = static_cast<float>(0.5 + s[1]);
    scalar[i] = static_cast<float>(s[2]);
  }
  gradient_sweep(v.context, v.records, p.data(), 0, correction, gradient.write());
  divergence_sweep(v.context, v.records, u.read(), v.rule, correction, p.data(), divergence.data(), laplacian.data());
  viscous_sweep(v.context, v.records, u.read(), v.rule, kappa.data(), viscous.write(), false);
  filter_vector(v.context, v.records, values.read(), v.reflection, filtered.write());
  const std::array<const float*, 1> in{scalar.data()};
  const std::array<float*, 1> out{smooth.data()};
  filter_scalars(v.context, v.records, in, out);
  for (std::size_t i = 0; i < n; ++i) {
    const double h = h0 * v.length_ratio[i];
    double weights = volume * v.volume_ratio[i] * WendlandC2::normalisation(3) / (h * h * h);
    double mean = weights * values[0][i], mean_scalar = weights * scalar[i];
    double slope = 0, div = 0, lap = 0, friction = 0, size = 0;
    v.each(i, [&](std::size_t j, const Point& d, double w, double g) {
      weights += w;
      mean += w * values[0][j];
      mean_scalar += w * scalar[j];
      slope += g * (p[j] - p[i]) * d[0];
      for (int a = 0; a < 3; ++a) div += g * (u[a][j] - u[a][i]) * d[a];
      lap += 2 * g * (p[i] - p[j]);
      const double k = 2.0 * kappa[i] * kappa[j] / (double{kappa[i]} + kappa[j]);
      friction += 2 * g * k * (u[1][j] - u[1][i]);
      size += 4 * g;
    });
    ASSERT_NEAR(filtered[0][i], mean / weights, tolerance);
    ASSERT_NEAR(smooth[i], mean_scalar / weights, tolerance);
    ASSERT_NEAR(gradient[0][i], slope, tolerance * size * h);
    ASSERT_NEAR(divergence[i], div, tolerance * size * h);
    ASSERT_NEAR(laplacian[i], lap, tolerance * size);
    ASSERT_NEAR(viscous[1][i], friction, tolerance * size);
  }
}

TEST(VaryingSizes, PressureMatrixAndResidualAreTheDirectSum) {
  Varying3D& v = varying();
  const std::size_t n = v.hood.n;
  Array<float> diagonal_shift(n), weight(n), row(n), x(n), y(n);
  Array<std::uint8_t> masked(n);
  Array<double> q(n), b(n), r(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Point s = uniform(i, 34);
    diagonal_shift[i] = static_cast<float>(s[0]);
    row[i] = static_cast<float>(0.7 + 0.3 * s[1]);
    weight[i] = v.volume_ratio[i] / row[i];
    masked[i] = i % 11 == 0 ? 1 : 0;
    x[i] = masked[i] != 0 ? 0.0F : static_cast<float>(s[2]);
    q[i] = x[i];
    b[i] = s[0] - 0.5;
  }
  PressureMatrix matrix{diagonal_shift.data(), masked.data()};
  matrix.weight = weight.data();
  matrix.row = row.data();
  PressureOperator fast;
  fast.bind(v.context, v.records, matrix);
  fast.apply(x, y, x);
  fast.residual(q, b, r);
  for (std::size_t i = 0; i < n; ++i) {
    double sum = diagonal_shift[i] * q[i], size = 0;
    v.each(i, [&](std::size_t j, const Point&, double, double g) {
      const double factor = 2 * g * row[i] * weight[j] / v.volume_ratio[j];
      sum += factor * (q[i] - q[j]);
      size += factor;
    });
    if (masked[i] != 0) {
      ASSERT_EQ(y[i], 0);
      ASSERT_EQ(r[i], 0);
      continue;
    }
    ASSERT_NEAR(y[i], volume * sum, tolerance * volume * size);
    ASSERT_NEAR(r[i], b[i] - volume * sum, tolerance * volume * size);
  }
}

// The operator of King (3.17): alpha div((1/alpha) grad q) with V_j = V / alpha_j of a smooth alpha, on a lattice that
// has been stretched so that the volumes fill space. Its error falls with the square of the smoothing length.
TEST(VaryingSizes, WeightsOfTheGeometricMeanGiveTheVaryingCoefficient) {
  double error[2];
  for (const int level : {0, 1}) {
    const int cells = 12 << level;
    const double dx = 1.0 / cells, h = 1.3 * dx, amplitude = 0.2;
    // x = s + amplitude sin(2 pi s) / (2 pi): spacing dx (1 + amplitude cos) holds a volume of that ratio.
    const auto place = [&](double s) { return s + amplitude * std::sin(2 * M_PI * s) / (2 * M_PI); };
    const auto ratio = [&](double s) { return (1 + amplitude * std::cos(2 * M_PI * s)) / (1 - amplitude); };
    const double base_volume = dx * dx * dx * (1 - amplitude);
    double worst = 0;
    for (int i = 0; i < cells; ++i) {
      const double s = (i + 0.5) / cells, alpha = 1 / ratio(s), hi = h * std::cbrt(ratio(s)) * 1.2;
      double sum = 0, stretch = 0;
      for (int j = i - 8; j <= i + 8; ++j)
        for (int b = -8; b <= 8; ++b)
          for (int c = -8; c <= 8; ++c) {
            const double sj = (j + 0.5) / cells, d = place(sj) - place(s);
            const double r2 = d * d + (b * b + c * c) * dx * dx, distance = std::sqrt(r2) / hi;
            if (r2 == 0 || distance >= 2) continue;
            const double g =
                -base_volume * ratio(sj) * WendlandC2::normalisation(3) / std::pow(hi, 5) * WendlandC2::f(distance);
            const double alpha_j = 1 / ratio(sj);
            const double q = std::sin(2 * M_PI * place(sj)), qi = std::sin(2 * M_PI * place(s));
            sum += 2 * g * std::sqrt(alpha / alpha_j) * (q - qi);
            stretch += g * r2;
          }
      const double x = place(s), slope = 2 * M_PI * std::cos(2 * M_PI * x);
      // d ln alpha / dx = -(d ratio / ds) / ratio / (dx/ds), and dx/ds is (1 - amplitude) ratio.
      const double dlog =
          amplitude * 2 * M_PI * std::sin(2 * M_PI * s) / (1 - amplitude) / ratio(s) / ((1 - amplitude) * ratio(s));
      const double exact = -4 * M_PI * M_PI * std::sin(2 * M_PI * x) - dlog * slope;
      worst = std::max(worst, std::abs(sum * 3 / stretch - exact));
    }
    error[level] = worst / (4 * M_PI * M_PI);
  }
  EXPECT_LT(error[1], 0.05);
  EXPECT_GT(error[0] / error[1], 2.5);
}

// Volumes of about half, so that the columns hold neither what counts as deepest nor too little.
TEST(VaryingSizes, DepthsBelowASurfaceAreTheDirectSums) {
  Varying3D& v = varying();
  const std::size_t n = v.hood.n;
  Array<float> ratio(n), scratch(n);
  VectorArrays<float> normal(n, 3);
  std::vector<std::int32_t> edge;
  for (std::size_t i = 0; i < n; ++i) {
    const Point draw = uniform(i, 32), direction = uniform(i, 33);
    ratio[i] = static_cast<float>(0.3 + 0.4 * draw[0]);
    const double size = std::hypot(direction[0] - 0.5, direction[1] - 0.5, direction[2] - 0.5);
    for (int a = 0; a < 3; ++a) normal[a][i] = static_cast<float>((direction[a] - 0.5) / size);
    if (draw[1] < 0.3) edge.push_back(static_cast<std::int32_t>(i));
  }
  SweepContext context = v.context;
  context.volume_ratio = ratio.data();
  Array<float> depth(edge.size());
  edge_depths(context, v.records, {spacing, edge, normal.read()}, scratch, depth);

  std::vector<double> own(n, 0.0);
  std::size_t between = 0;
  const auto below = [&](std::size_t i, const Point& d) {
    return -(d[0] * normal[0][i] + d[1] * normal[1][i] + d[2] * normal[2][i]) / spacing;
  };
  for (const std::int32_t k : edge) {
    const auto i = static_cast<std::size_t>(k);
    double pressure_fixed = ratio[i] * reference::column_weight(3, 0, 0);
    v.each(i, [&](std::size_t j, const Point& d, double, double) {
      const double z = below(i, d), r2 = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / (spacing * spacing);
      pressure_fixed += ratio[j] * reference::column_weight(3, std::sqrt(std::max(0.0, r2 - z * z)), z);
    });
    own[i] = reference::depth_of_column(3, pressure_fixed);
    between += own[i] > 0.26 && own[i] < 1.99 ? 1 : 0;
  }
  EXPECT_GT(between, edge.size() / 2);
  for (std::size_t k = 0; k < edge.size(); ++k) {
    const auto i = static_cast<std::size_t>(edge[k]);
    double weights = WendlandC2::w(0.0), sum = weights * own[i];
    v.each(i, [&](std::size_t j, const Point& d, double, double) {
      if (own[j] == 0) return;
      const double q = std::hypot(d[0], d[1], d[2]) / (h0 * v.length_ratio[i]);
      const double weight = WendlandC2::w(q) * std::max(0.0, 1 - 2 * std::abs(below(i, d)));
      weights += weight;
      sum += weight * own[j];
    });
    // A column holds some 30 terms of squared distances of up to ten.
    ASSERT_NEAR(depth[k] / spacing, sum / weights, 10 * tolerance) << i;
  }
}

// Edge particles few enough that some of their neighbours belong to the layers in part.
TEST(VaryingSizes, WhatLayersShareIsTheDirectSum) {
  Varying3D& v = varying();
  const std::size_t n = v.hood.n;
  VectorArrays<float> normal(n, 3), vector(n, 3);
  for (std::size_t i = 0; i < n; ++i) {
    const Point draw = uniform(i, 34), direction = uniform(i, 35), value = uniform(i, 36);
    const double size = std::hypot(direction[0], direction[1], direction[2]);
    for (int a = 0; a < 3; ++a) {  // all into one eighth of space: sums of normals do not cancel
      normal[a][i] = draw[0] < 0.04 ? static_cast<float>(direction[a] / size) : 0;
      vector[a][i] = static_cast<float>(value[a] - 0.5);
    }
  }
  std::vector<std::int32_t> upper;
  std::vector<std::array<double, 3>> expected;
  std::size_t partly = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const bool at_edge = normal[0][i] > 0;
    std::array<double, 3> sum{};
    double of_edge = 0;
    for (int a = 0; a < 3; ++a) sum[a] = normal[a][i];
    v.each(i, [&](std::size_t j, const Point& d, double, double) {
      if (!(normal[0][j] > 0)) return;
      const double x = std::max(0.0, 1 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / std::pow(1.8 * spacing, 2));
      for (int a = 0; a < 3; ++a) sum[a] += x * x * normal[a][j];
      of_edge += x * x;
    });
    const double size = std::hypot(sum[0], sum[1], sum[2]);
    if (size == 0) continue;
    for (double& component : sum) component /= size;
    double weights = WendlandC2::w(0.0), along = 0;
    for (int a = 0; a < 3; ++a) along += weights * vector[a][i] * sum[a];
    v.each(i, [&](std::size_t j, const Point& d, double, double) {
      const double q = std::hypot(d[0], d[1], d[2]) / (h0 * v.length_ratio[i]);
      const double z = std::abs(d[0] * sum[0] + d[1] * sum[1] + d[2] * sum[2]) / spacing;
      const double weight = WendlandC2::w(q) * std::max(0.0, 1 - z);
      weights += weight;
      for (int a = 0; a < 3; ++a) along += weight * vector[a][j] * sum[a];
    });
    const double c = at_edge ? 1 : std::min(1.0, of_edge / 0.4);
    partly += c < 1 ? 1 : 0;
    for (double& component : sum) component *= c * along / weights;
    upper.push_back(static_cast<std::int32_t>(i));
    expected.push_back(sum);
  }
  ASSERT_GT(partly, n / 20);
  Array<std::array<float, 3>> shared(upper.size());
  shared_along_normal(v.context, v.records, spacing, normal.read(), vector.read(), v.reflection, upper, shared);
  for (std::size_t k = 0; k < upper.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) ASSERT_NEAR(shared[k][a], expected[k][a], 10 * tolerance) << upper[k];
}

}  // namespace
}  // namespace spume::test
