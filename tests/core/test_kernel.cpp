// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "spume/core/kernel.hpp"

namespace spume {
namespace {

// Bounds of a kernel's terms for derived tolerances: |w'''|, |w|, and the sums of magnitudes of the terms that
// cancel in the float forms of w and F.
struct WendlandCase {
  using Kernel = WendlandC2;
  static constexpr double third = 15, largest = 1, w_terms = 1, f_terms = 5;
};
struct QuinticCase {
  using Kernel = QuinticSpline;
  static constexpr double third = 240, largest = 66, w_terms = 243 + 6 * 32 + 15, f_terms = 5 * (81 + 6 * 16);
};

template <class Case>
class Kernels : public testing::Test {};
using Cases = testing::Types<WendlandCase, QuinticCase>;
TYPED_TEST_SUITE(Kernels, Cases);

TYPED_TEST(Kernels, IntegratesToOneAndHasTheStatedVariance) {
  using Kernel = typename TypeParam::Kernel;
  // Gauss rule of 5 points on each unit interval: exact for the pieces, polynomials of degree at most 9.
  const double node[] = {0, std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 3, std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 3};
  const double weight[] = {128.0 / 225, (322 + 13 * std::sqrt(70.0)) / 900, (322 - 13 * std::sqrt(70.0)) / 900};
  for (const int dimensions : {2, 3}) {
    double integral = 0, second_moment = 0;
    for (int piece = 0; piece < Kernel::support; ++piece)
      for (int k = -2; k <= 2; ++k) {
        const double q = piece + 0.5 + 0.5 * (k < 0 ? -node[-k] : node[k]);
        const double sphere = dimensions == 2 ? 2 * std::numbers::pi * q : 4 * std::numbers::pi * q * q;
        integral += 0.5 * weight[std::abs(k)] * sphere * Kernel::w(q);
        second_moment += 0.5 * weight[std::abs(k)] * sphere * Kernel::w(q) * q * q;
      }
    EXPECT_NEAR(integral * Kernel::normalisation(dimensions), 1, 1e-13);
    EXPECT_NEAR(second_moment / (dimensions * integral), Kernel::variance(dimensions), 1e-13);
  }
}

TYPED_TEST(Kernels, KurtosisIsThatOfOneDirection) {
  using Kernel = typename TypeParam::Kernel;
  const int steps = 6000;  // a multiple of the pieces, midpoints: an error of the step squared
  const double width = Kernel::support / steps;
  for (const int dimensions : {2, 3}) {
    double moment[3]{};
    for (int k = 0; k < steps; ++k) {
      const double q = (k + 0.5) * width;
      for (int n = 0; n < 3; ++n) moment[n] += Kernel::w(q) * std::pow(q, 2 * n + dimensions - 1);
    }
    // The mean of the fourth power of a direction's cosine is 3 / (d (d + 2)), of its square 1 / d.
    const double fourth = 3.0 / (dimensions * (dimensions + 2)) * moment[2] / moment[0];
    const double second = moment[1] / (dimensions * moment[0]);
    EXPECT_NEAR(fourth / (second * second), Kernel::kurtosis(dimensions), 1e-5);
  }
}

TYPED_TEST(Kernels, SlopeFunctionIsTheDerivativeOverQ) {
  using Kernel = typename TypeParam::Kernel;
  const double h = 1e-4;
  for (double q = 0.01; q < Kernel::support + 0.2; q += 0.013) {
    const double slope = (Kernel::w(q + h) - Kernel::w(q - h)) / (2 * h);
    const double rounding = 4 * TypeParam::w_terms * std::numeric_limits<double>::epsilon() / h;
    EXPECT_NEAR(Kernel::f(q), slope / q, (h * h * TypeParam::third / 6 + rounding) / q) << q;
  }
  // Finite at the centre, and continuous there.
  EXPECT_NEAR(Kernel::f(0), Kernel::f(1e-9), 1e-6);
}

template <class Parameters, class V>
void expect_scalar_form() {
  using Kernel = typename Parameters::Kernel;
  constexpr int lanes = sizeof(V) / sizeof(float), count = 512;
  const double epsilon = std::numeric_limits<float>::epsilon();
  for (int i = 0; i < count; i += lanes) {
    V q{};
    for (int l = 0; l < lanes; ++l) q[l] = static_cast<float>((i + l) * (Kernel::support + 0.5) / count);
    const V w = Kernel::w(q), f = Kernel::f(q);
    for (int l = 0; l < lanes; ++l) {
      // At most eight float roundings in each term.
      EXPECT_NEAR(w[l], Kernel::w(q[l]), 8 * epsilon * Parameters::w_terms) << q[l];
      EXPECT_NEAR(f[l], Kernel::f(q[l]), 8 * epsilon * Parameters::f_terms) << q[l];
    }
  }
}

TYPED_TEST(Kernels, VectorFormsEqualScalarForm) {
  expect_scalar_form<TypeParam, simd::f32x8>();
  expect_scalar_form<TypeParam, simd::f32n>();
}

TYPED_TEST(Kernels, VanishesAtAndBeyondTheSupport) {
  using Kernel = typename TypeParam::Kernel;
  for (const double q : {Kernel::support, Kernel::support + 1e-9, 5.0, 1e7}) {
    EXPECT_EQ(Kernel::w(q), 0) << q;
    EXPECT_EQ(Kernel::f(q), 0) << q;
    EXPECT_EQ(Kernel::w(simd::splat(static_cast<float>(q)))[3], 0) << q;
    EXPECT_EQ(Kernel::f(simd::splat(static_cast<float>(q)))[3], 0) << q;
  }
  EXPECT_GT(Kernel::w(Kernel::support - 0.01), 0);
  EXPECT_LT(Kernel::f(Kernel::support - 0.01), 0);
}

TYPED_TEST(Kernels, DecreasesFromTheCentre) {
  using Kernel = typename TypeParam::Kernel;
  for (double q = 0.01; q < Kernel::support; q += 0.01) EXPECT_LT(Kernel::w(q), Kernel::w(q - 0.01));
}

template <class V>
void expect_transposed_records() {
  constexpr int lanes = sizeof(V) / sizeof(float);
  float records[8 * 20];
  for (int i = 0; i < 8 * 20; ++i) records[i] = static_cast<float>(i);
  const std::int32_t number[16] = {3, 0, 19, 7, 7, 1, 12, 5, 2, 18, 4, 4, 11, 0, 16, 9};
  std::int32_t entry[16];
  for (int l = 0; l < 16; ++l) entry[l] = 4 * number[l];
  V out[4];
  simd::load_records<8>(records, entry, 1, out);
  float total = 0;
  for (int l = 0; l < lanes; ++l) {
    for (int c = 0; c < 4; ++c) EXPECT_EQ(out[c][l], static_cast<float>(8 * number[l] + 4 + c));
    total += out[0][l];
  }
  EXPECT_EQ(simd::sum(out[0]), total);
  EXPECT_EQ(simd::sum(simd::to_f64_low(out[0])) + simd::sum(simd::to_f64_high(out[0])), total);
}

TEST(Simd, TransposesRecordsAndSumsLanes) {
  expect_transposed_records<simd::f32x8>();
  expect_transposed_records<simd::f32n>();
}

}  // namespace
}  // namespace spume
