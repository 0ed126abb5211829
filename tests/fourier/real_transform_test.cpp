// SPDX-License-Identifier: MIT
#include "spume/fourier/real_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "spume/core/array.hpp"
#include "spume/core/random.hpp"

namespace spume {
namespace {

using Complex = std::complex<double>;

Array<double> random_field(std::size_t size) {
  Array<double> field(size);
  for (std::size_t i = 0; i < size; ++i) field[i] = 2 * random_uniform(3, RandomPurpose::test, i, 0, 0)[0] - 1;
  return field;
}

// The definition, summed directly.
Complex direct_mode(const Array<double>& field, std::array<std::size_t, 3> n, std::size_t a, std::size_t b,
                    std::size_t c) {
  Complex sum = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i) {
        const double turns = static_cast<double>(a * i) / static_cast<double>(n[0]) +
                             static_cast<double>(b * j) / static_cast<double>(n[1]) +
                             static_cast<double>(c * k) / static_cast<double>(n[2]);
        sum += field[i + n[0] * (j + n[1] * k)] * std::polar(1.0, -2 * std::numbers::pi * turns);
      }
  return sum;
}

class RealTransformShapes : public ::testing::TestWithParam<std::array<std::size_t, 3>> {};
INSTANTIATE_TEST_SUITE_P(Shapes, RealTransformShapes,
                         ::testing::Values(std::array<std::size_t, 3>{8, 6, 1}, std::array<std::size_t, 3>{7, 5, 1},
                                           std::array<std::size_t, 3>{6, 4, 10}, std::array<std::size_t, 3>{5, 9, 3},
                                           std::array<std::size_t, 3>{4, 1, 1}));

TEST_P(RealTransformShapes, ForwardAgreesWithTheDirectSumAndInverseReturnsTheField) {
  const auto n = GetParam();
  const RealTransform transform(n);
  const Array<double> field = random_field(transform.real_size());
  Array<Complex> spectrum(transform.spectral_size());
  transform.forward(field, spectrum);
  const std::size_t row = n[0] / 2 + 1;
  // 240 terms of order one at most: rounding of the direct sum is below 240 * 2^-52 * 240.
  for (std::size_t m = 0; m < spectrum.size(); ++m)
    EXPECT_LT(std::abs(spectrum[m] - direct_mode(field, n, m % row, m / row % n[1], m / row / n[1])), 1e-11);
  Array<double> returned(field.size());
  transform.inverse(spectrum, returned);
  for (std::size_t i = 0; i < field.size(); ++i) EXPECT_NEAR(returned[i], field[i], 1e-14);
}

TEST(RealTransform, RefusesWrongSizesAndUnalignedArrays) {
  const RealTransform transform({8, 4, 1});
  Array<double> field(33);
  Array<Complex> spectrum(transform.spectral_size());
  EXPECT_THROW(transform.forward({field.data(), 31}, spectrum), std::invalid_argument);
  EXPECT_THROW(transform.forward({field.data() + 1, 32}, spectrum), std::invalid_argument);
  EXPECT_NO_THROW(transform.forward({field.data(), 32}, spectrum));
  EXPECT_THROW(RealTransform({8, 0, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace spume
