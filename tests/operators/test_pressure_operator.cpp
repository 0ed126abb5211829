// SPDX-License-Identifier: MIT
// The pressure matrix and its residual against slow twins; symmetry; what double residuals are for.
#include <gtest/gtest.h>

#include <numbers>

#include "operators/sph_arrangement.hpp"
#include "spume/operators/pressure_operator.hpp"

namespace spume::test {
namespace {

struct System {
  Arrangement& a;
  Array<float> diagonal_shift, weight, row;
  Array<std::uint8_t> masked;
  PressureOperator fast;

  explicit System(Arrangement& arrangement, bool masks = true)
      : a(arrangement), diagonal_shift(a.size()), weight(a.size()), row(a.size()), masked(a.size()) {
    const auto random = a.random(81);
    for (std::size_t i = 0; i < a.size(); ++i) {
      diagonal_shift[i] = static_cast<float>((1 + random[i]) / (a.setup.spacing * a.setup.spacing));
      masked[i] = masks && i % 7 == 3 ? 1 : 0;
    }
    PressureMatrix matrix{diagonal_shift.data(), masks ? masked.data() : nullptr};
    if (a.setup.sizes) {  // as a coefficient that is a geometric mean needs
      const auto coefficient = a.random(80);
      for (std::size_t i = 0; i < a.size(); ++i) {
        row[i] = static_cast<float>(0.85 + 0.15 * coefficient[i]);
        weight[i] = a.sizes.volume_ratio[i] / row[i];
      }
      matrix.weight = weight.data();
      matrix.row = row.data();
    }
    fast.bind(a.context, a.packed, matrix);
  }
  // Of the slow twin.
  template <class Scalar>
  Sum product(std::size_t i, const Scalar& q) const {
    return a.setup.sizes ? a.twin.weighted_pressure_row(i, q, diagonal_shift, masked, weight, row)
                         : a.twin.pressure_row(i, q, diagonal_shift, masked);
  }
};

Array<float> random_floats(const Arrangement& a, std::uint32_t draw, const Array<std::uint8_t>& masked) {
  const auto values = a.random(draw);
  Array<float> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = masked[i] != 0 ? 0.0F : static_cast<float>(values[i]);
  return result;
}

TEST(PressureOperator, AgreesWithTheSlowTwinOnEveryArrangement) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    System system(a);
    const auto x = random_floats(a, 82, system.masked), w = random_floats(a, 83, system.masked);
    Array<float> y(a.size());
    const Dots dots = system.fast.apply(x, y, w);
    Array<double> q(a.size()), b = a.random(84), r(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) q[i] = x[i] + 1e-9 * b[i];
    system.fast.residual(q, b, r);
    Comparison product("A x"), residual("b - A q");
    double wy = 0, yy = 0, size = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double rounding = a.twin.tolerance(i);
      product.add(y[i], system.product(i, x), rounding, i);
      Sum row = system.product(i, q);
      row.value = system.masked[i] != 0 ? 0 : b[i] - row.value;
      residual.add(r[i], row, rounding, i);
      wy += double{w[i]} * y[i];
      yy += double{y[i]} * y[i];
      size += std::abs(double{w[i]} * y[i]);
    }
    EXPECT_NEAR(dots.wy, wy, 1e-13 * size);  // the order of a double sum of about 1e3 terms
    EXPECT_NEAR(dots.yy, yy, 1e-13 * yy);
  }
}

// All but the coefficients is double in both: they differ by the rounding of some 80 terms in double.
TEST(PressureOperator, TakesTheProductOfACorrectionFromAResidual) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    System system(a);
    const auto x = random_floats(a, 87, system.masked), start = random_floats(a, 89, system.masked);
    const double scale = 0.75;
    Array<double> q(a.size()), corrected(a.size()), b = a.random(88), r(a.size()), expected(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      q[i] = start[i];
      corrected[i] = q[i] + scale * x[i];
    }
    system.fast.residual(q, b, r);
    system.fast.subtract_product(scale, x, r);
    system.fast.residual(corrected, b, expected);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Sum row = system.product(i, corrected);
      const Sum part = system.product(i, q);
      EXPECT_NEAR(r[i], expected[i], 1e-13 * (std::abs(b[i]) + row.magnitude + 2 * part.magnitude)) << "particle " << i;
    }
  }
}

// x . A y = y . A x up to the rounding of the products.
void expect_symmetric(Arrangement& a) {
  SCOPED_TRACE(a.setup.name);
  System system(a);
  const auto x = random_floats(a, 85, system.masked), y = random_floats(a, 86, system.masked);
  Array<float> ax(a.size()), ay(a.size());
  const double yax = system.fast.apply(x, ax, y).wy, xay = system.fast.apply(y, ay, x).wy;
  double bound = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double eps = a.twin.tolerance(i);
    bound += eps * (std::abs(y[i]) * system.product(i, x).magnitude + std::abs(x[i]) * system.product(i, y).magnitude);
  }
  EXPECT_NEAR(yax, xay, bound);
  EXPECT_GT(std::abs(yax), bound) << "the products are large enough to tell";
}

// Around the edges of solids too: i sees j by reflection when j sees i.
TEST(PressureOperator, IsSymmetricWithPeriodicSidesWallsAndSolids) {
  for (Arrangement& a : all_arrangements())
    if (!a.setup.sizes) expect_symmetric(a);
}

TEST(PressureOperator, IsSymmetricAboveASolidWithoutEdges) {
  ArrangementSetup setup;
  setup.name = "step across the domain";
  for (const Point& p : lattice_points(16, 2, 0.5))
    if (p[1] > 0.3) setup.points.push_back(p);
  setup.set_sides(0, BoundaryKind::periodic);
  setup.boundaries.boxes = {{{0, 0, 0}, {1, 0.3, 0}, BoundaryKind::no_slip}};
  Arrangement a(setup);
  EXPECT_TRUE(a.hood.images.inside_domain());
  expect_symmetric(a);
}

// The residual with the float coefficients of the lists, all else in double: what residual() promises to compute.
template <int dimensions, class Kernel>
Array<double> double_rows(const Arrangement& a, const Array<double>& q) {
  PackedNeighbours packed;
  const float* records = packed.prepare(a.context, 0);
  const KernelScale<dimensions, Kernel> scale(a.context);
  const float factor = -2 * scale.gradient * static_cast<float>(a.context.volume);
  const std::size_t n = a.size();
  Array<double> rows(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t* entry = a.hood.list.begin(i);
    for_each_batch<dimensions, 0>(a.hood.list, records, i, scale.inverse_h, [&](const auto& batch) {
      const simd::f32n f = Kernel::f(batch.q);
      for (int lane = 0; lane < simd::pair_lanes && entry != a.hood.list.padded_end(i); ++lane, ++entry) {
        const auto j = static_cast<std::size_t>(*entry / entry_scale);
        if (j >= a.hood.list.points()) continue;
        const std::size_t source = j < n ? j : static_cast<std::size_t>(a.hood.images.source()[j - n]);
        rows[i] += double{factor} * f[lane] * (q[i] - q[source]);
      }
    });
  }
  return rows;
}

template <class T, class U>
double relative_difference(const Array<T>& values, const Array<U>& reference) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    difference += std::pow(double(values[i]) - reference[i], 2);
    size += std::pow(reference[i], 2);
  }
  return std::sqrt(difference / size);
}

// A wave of 100 spacings along a strip with free edges.
ArrangementSetup long_wave_setup() {
  ArrangementSetup setup;
  setup.spacing = 1.0 / 100;
  for (const Point& p : lattice_points(100, 2, 0.3))
    if (p[1] < 0.1) setup.points.push_back(p);
  setup.set_sides(0, BoundaryKind::periodic);
  return setup;
}

struct LongWave {
  Arrangement a{long_wave_setup()};
  Array<float> diagonal_shift{a.size(), 0.0F};
  Array<double> q, product, exact;

  explicit LongWave(double mean) : product(a.size()) {
    q = a.sample([&](const Point& p) { return mean + std::sin(2 * std::numbers::pi * p[0]); });
    PressureOperator fast;
    fast.bind(a.context, a.packed, {diagonal_shift.data(), nullptr});
    const Array<double> zero(a.size(), 0.0);
    fast.residual(q, zero, product);
    for (double& value : product) value = -value;
    exact = double_rows<2, WendlandC2>(a, q);
  }
};

// A constant does not change a row. Neighbours differ by 2 pi / 100 = 0.06 of the amplitude, and two floats a value
// lose 2^-49 of it: with a mean of 3, 4 2^-49 / 0.06 = 1e-13 of a row at worst. One float a value, or differences taken
// in float where the field passes through zero, lose 4 2^-25 / 0.06 = 2e-6 at worst.
TEST(PressureOperator, ResidualOfASmoothFieldKeepsItsDigitsAndTheFloatProductDoesNot) {
  LongWave through_zero(0), wave(3);
  EXPECT_LT(relative_difference(wave.product, through_zero.product), 1e-12);
  // The twin's weights are floats too, rounded where its compiler chose to fuse: 4 2^-24 of a row.
  EXPECT_LT(relative_difference(wave.product, wave.exact), 4 * std::ldexp(1.0, -24) * 10);
  Array<float> single(wave.a.size()), y(wave.a.size());
  for (std::size_t i = 0; i < wave.a.size(); ++i) single[i] = static_cast<float>(wave.q[i]);
  PressureOperator fast;
  fast.bind(wave.a.context, wave.a.packed, {wave.diagonal_shift.data(), nullptr});
  fast.apply(single, y, single);
  EXPECT_GT(relative_difference(y, wave.product), 1e-7);
}

// A matrix without weights, or with half of them, does not fit a context with sizes.
TEST(PressureOperator, DemandsWeightsWhereParticlesDifferInSize) {
  for (Arrangement& a : all_arrangements()) {
    const Array<float> ones(a.size(), 1.0F);
    PressureOperator fast;
    EXPECT_EQ(a.setup.sizes, a.context.length_ratio != nullptr);
    PressureMatrix matrix{ones.data(), nullptr, a.setup.sizes ? nullptr : ones.data(), ones.data()};
    EXPECT_THROW(fast.bind(a.context, a.packed, matrix), std::logic_error);
  }
}

TEST(PressureOperator, OfAConstantIsZeroWithoutADiagonal) {
  for (Arrangement& a : all_arrangements()) {
    if (a.setup.sizes) continue;  // sums of weights and of weighted values round apart
    Array<float> diagonal_shift(a.size(), 0.0F), x(a.size(), 3.25F), y(a.size());
    Array<double> q(a.size(), 1.0 / 3), zero(a.size(), 0.0), r(a.size());
    PressureOperator fast;
    fast.bind(a.context, a.packed, {diagonal_shift.data(), nullptr});
    const Dots dots = fast.apply(x, y, x);
    fast.residual(q, zero, r);
    EXPECT_EQ(dots.yy, 0) << a.setup.name;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(r[i], 0) << a.setup.name;
  }
}

}  // namespace
}  // namespace spume::test
