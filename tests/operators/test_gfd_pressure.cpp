// SPDX-License-Identifier: MIT
// The pressure matrix of generalised finite differences, its diagonal and its residual against slow twins.
#include <gtest/gtest.h>

#include <numbers>

#include "operators/gfd_arrangement.hpp"
#include "spume/operators/gfd_pressure.hpp"

namespace spume::test {
namespace {

struct GfdSystem {
  Arrangement& a;
  Stencils stencils;
  const GfdSums& twin;
  RandomProperty density;
  Array<float> diagonal_shift;
  Array<std::uint8_t> masked;
  bool varies;
  GfdPressureOperator fast;
  Array<float> diagonal;

  explicit GfdSystem(Arrangement& arrangement, bool density_varies = true)
      : a(arrangement),
        stencils(a),
        twin(gfd_twin(a)),
        density(a, 142),
        diagonal_shift(a.size()),
        masked(a.size()),
        varies(density_varies),
        diagonal(a.size()) {
    const auto random = a.random(141);
    for (std::size_t i = 0; i < a.size(); ++i) {
      diagonal_shift[i] = static_cast<float>((1 + random[i]) / (a.setup.spacing * a.setup.spacing));
      masked[i] = i % 7 == 3 ? 1 : 0;
    }
    fast.bind(a.context, a.packed,
              {stencils.read(),
               {density.value.data(), varies ? density.varies.data() : nullptr},
               diagonal_shift.data(),
               masked.data()},
              diagonal);
  }
  GfdSums::AtPoint inverse_density(std::size_t i) const {
    const double own = density.value[i];
    if (!varies || density.varies[i] == 0) return [own](const GfdSums::SphPoint&) { return 1 / own; };
    return [this, own](const GfdSums::SphPoint& p) { return 2 / (own + double(density.value[p.source])); };
  }
  // (A q)_i of the slow twin.
  template <class Scalar>
  Sum product(std::size_t i, const Scalar& q) const {
    if (masked[i] != 0) return {};
    Sum sum = twin.laplacian(
        i, [&](const GfdSums::SphPoint& p) { return double(q[p.source]); }, inverse_density(i), stencils.of(i));
    const double own = double{diagonal_shift[i]} * q[i];
    return {a.context.volume * (own - sum.value), a.context.volume * (std::abs(own) + sum.magnitude)};
  }
};

Array<float> random_unmasked(const GfdSystem& system, std::uint32_t draw) {
  Array<float> values = to_float(system.a.random(draw));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (system.masked[i] != 0) values[i] = 0;
  return values;
}

TEST(GfdPressureOperator, AgreesWithTheSlowTwinOnEveryArrangement) {
  for_every_equal_arrangement([&](Arrangement& a) {
    for (const bool varies : {true, false}) {
      GfdSystem system(a, varies);
      const auto x = random_unmasked(system, 143), w = random_unmasked(system, 144);
      Array<float> y(a.size());
      const Dots dots = system.fast.apply(x, y, w);
      Array<double> q(a.size()), b = a.random(145), r(a.size());
      for (std::size_t i = 0; i < a.size(); ++i) q[i] = x[i] + 1e-9 * b[i];
      system.fast.residual(q, b, r);
      Comparison product("A x"), residual("b - A q"), diagonals("diagonal");
      double wy = 0, yy = 0, size = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        const double rounding = system.twin.tolerance(i);
        product.add(y[i], system.product(i, x), rounding, i);
        Sum row = system.product(i, q);
        row.value = system.masked[i] != 0 ? 0 : b[i] - row.value;
        residual.add(r[i], row, rounding, i);
        Sum own = system.twin.laplacian_diagonal(i, system.inverse_density(i), system.stencils.of(i));
        own.value = a.context.volume * (own.value + system.diagonal_shift[i]);
        own.magnitude = a.context.volume * (own.magnitude + system.diagonal_shift[i]);
        diagonals.add(system.diagonal[i], system.masked[i] != 0 ? Sum{1, 1} : own, rounding, i);
        wy += double{w[i]} * y[i];
        yy += double{y[i]} * y[i];
        size += std::abs(double{w[i]} * y[i]);
      }
      EXPECT_NEAR(dots.wy, wy, 1e-13 * size);  // the order of a double sum of about 1e3 terms
      EXPECT_NEAR(dots.yy, yy, 1e-13 * yy);
    }
  });
}

// Every second masked row is tied to three that are not, with either sign and a given part, whatever the vectors hold
// there.
TEST(GfdPressureOperator, TiedRowsFollowTheOthers) {
  for_every_equal_arrangement([&](Arrangement& a) {
    GfdSystem system(a);
    std::vector<std::int32_t> rows, point(a.size(), -1), free;
    WallStencils stencils;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (system.masked[i] == 0)
        free.push_back(static_cast<std::int32_t>(i));
      else if (i % 2 == 0)
        rows.push_back(static_cast<std::int32_t>(i));
    stencils.source.resize(3 * rows.size());
    stencils.coefficient.resize(3 * rows.size());
    stencils.first.resize(rows.size() + 1);
    stencils.kind.resize(rows.size());
    stencils.pressure_sign.resize(rows.size());
    stencils.given_pressure.resize(rows.size());
    const auto random = a.random(150);
    for (std::size_t g = 0; g < rows.size(); ++g) {
      point[static_cast<std::size_t>(rows[g])] = static_cast<std::int32_t>(g);
      stencils.first[g] = static_cast<std::int64_t>(3 * g);
      stencils.kind[g] = g % 2 == 0 ? PointKind::inflow : PointKind::outflow;
      stencils.pressure_sign[g] = g % 2 == 0 ? 1.0F : -1.0F;
      stencils.given_pressure[g] = random[g];
      for (std::size_t k = 0; k < 3; ++k) {
        stencils.source[3 * g + k] = free[(5 * g + 11 * k) % free.size()];
        stencils.coefficient[3 * g + k] = k == 0 ? 1.5 : -0.25;
      }
    }
    stencils.first[rows.size()] = static_cast<std::int64_t>(3 * rows.size());
    const TiedRows tied{rows, point, &stencils};
    GfdPressureOperator fast;
    fast.bind(
        a.context, a.packed,
        {system.stencils.read(), system.density.read(), system.diagonal_shift.data(), system.masked.data(), &tied});
    const auto x = random_unmasked(system, 151);
    const auto extended = [&](bool given) {
      Array<double> all(a.size());
      for (std::size_t i = 0; i < a.size(); ++i) all[i] = x[i];
      for (std::size_t g = 0; g < rows.size(); ++g) {
        double sum = given ? stencils.given_pressure[g] : 0.0;
        for (std::size_t k = 3 * g; k < 3 * g + 3; ++k)
          sum += double{stencils.pressure_sign[g]} * stencils.coefficient[k] * x[stencils.source[k]];
        all[static_cast<std::size_t>(rows[g])] = sum;
      }
      return all;
    };
    const Array<double> change = extended(false), whole = extended(true);
    Array<double> q(a.size()), zero(a.size(), 0.0), r(a.size()), taken(a.size(), 0.0);
    Array<float> y(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) q[i] = x[i];
    fast.apply(x, y, x);
    fast.residual(q, zero, r, true);
    fast.subtract_product(1, x, taken);
    Comparison product("A x"), residual("-A q"), subtracted("-A x");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double rounding = system.twin.tolerance(i);
      Sum of_change = system.product(i, change), of_whole = system.product(i, whole);
      product.add(y[i], of_change, rounding, i);
      of_change.value = -of_change.value;
      of_whole.value = -of_whole.value;
      subtracted.add(taken[i], of_change, rounding, i);
      residual.add(r[i], of_whole, rounding, i);
    }
  });
}

// All but the coefficients is double in both: they differ by the rounding of some 80 terms in double.
TEST(GfdPressureOperator, TakesTheProductOfACorrectionFromAResidual) {
  for_every_equal_arrangement([&](Arrangement& a) {
    GfdSystem system(a);
    const auto x = random_unmasked(system, 146), start = random_unmasked(system, 147);
    const double scale = 0.75;
    Array<double> q(a.size()), corrected(a.size()), b = a.random(148), r(a.size()), expected(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      q[i] = start[i];
      corrected[i] = q[i] + scale * x[i];
    }
    system.fast.residual(q, b, r);
    system.fast.subtract_product(scale, x, r);
    system.fast.residual(corrected, b, expected);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double size = system.product(i, corrected).magnitude + 2 * system.product(i, q).magnitude;
      ASSERT_NEAR(r[i], expected[i], 1e-13 * (std::abs(b[i]) + size)) << "particle " << i;
    }
  });
}

// Neighbours of a wave of 100 spacings differ by 0.06 of its amplitude: with one float a value a row loses
// 4 2^-25 / 0.06 = 2e-6 at worst, with two floats 2^-24 of that. Weights are the same floats in both.
TEST(GfdPressureOperator, ResidualOfASmoothFieldIsThatOfTheFieldWithoutItsMean) {
  ArrangementSetup setup;
  setup.spacing = 1.0 / 100;
  for (const Point& p : lattice_points(100, 2, 0.3))
    if (p[1] < 0.1) setup.points.push_back(p);
  setup.set_sides(0, BoundaryKind::periodic);
  Arrangement a(setup);
  const Stencils stencils(a);
  const Array<float> density(a.size(), 2.0F);
  GfdPressureOperator fast;
  fast.bind(a.context, a.packed, {stencils.read(), {density.data(), nullptr}, nullptr, nullptr});
  const Array<double> zero(a.size(), 0.0);
  Array<double> around_zero(a.size()), around_three(a.size());
  Array<float> single(a.size()), y(a.size());
  const auto wave = [](double mean) {
    return [mean](const Point& p) { return mean + std::sin(2 * std::numbers::pi * p[0]); };
  };
  const auto q = a.sample(wave(3));
  fast.residual(a.sample(wave(0)), zero, around_zero);
  fast.residual(q, zero, around_three);
  for (std::size_t i = 0; i < a.size(); ++i) single[i] = static_cast<float>(q[i]);
  fast.apply(single, y, single);
  double change = 0, float_error = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    change += std::pow(around_three[i] - around_zero[i], 2);
    float_error += std::pow(y[i] + around_zero[i], 2);
    size += std::pow(around_zero[i], 2);
  }
  EXPECT_LT(std::sqrt(change / size), 1e-10);
  EXPECT_GT(std::sqrt(float_error / size), 1e-7) << "what doubles are for";
}

TEST(GfdPressureOperator, OfAConstantIsZeroWithoutADiagonal) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils stencils(a);
    const RandomProperty density(a, 149);
    Array<float> x(a.size(), 3.25F), y(a.size());
    Array<double> q(a.size(), 1.0 / 3), zero(a.size(), 0.0), r(a.size());
    GfdPressureOperator fast;
    fast.bind(a.context, a.packed, {stencils.read(), density.read(), nullptr, nullptr});
    EXPECT_EQ(fast.apply(x, y, x).yy, 0);
    fast.residual(q, zero, r);
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(r[i], 0);
  });
}

}  // namespace
}  // namespace spume::test
