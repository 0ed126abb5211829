// SPDX-License-Identifier: MIT
// Our transforms of lines against FFTW's and against the sum itself, for every length that a grid may ask for.
#include "spume/fourier/line_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/random.hpp"
#include "spume/fourier/mode_layout.hpp"

namespace spume {
namespace {

using C = std::complex<double>;

bool smooth(std::size_t n) {
  for (const std::size_t p : {2, 3, 5})
    while (n % p == 0) n /= p;
  return n == 1;
}

std::vector<std::size_t> lengths() {
  std::vector<std::size_t> all;
  for (std::size_t n = 1; n <= 100; ++n) all.push_back(n);
  for (const std::size_t n : {108, 120, 125, 128, 144, 150, 160, 162, 192, 243, 256, 288, 320, 384, 512})
    all.push_back(n);
  return all;
}

template <class T>
Array<std::complex<T>> random_lines(std::size_t n) {
  Array<std::complex<T>> lines(n * lanes<T>);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto r = random_uniform(11, RandomPurpose::test, i, 0, 0);
    lines[i] = {static_cast<T>(r[0] - 0.5), static_cast<T>(r[1] - 0.5)};
  }
  return lines;
}

// The sum itself, in double precision.
template <class T>
std::vector<C> sums(const Array<std::complex<T>>& lines, std::size_t n, double sign) {
  std::vector<C> root(n), result(lines.size());
  for (std::size_t j = 0; j < n; ++j)
    root[j] = std::polar(1.0, sign * 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(n));
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t l = 0; l < lanes<T>; ++l)
        result[k * lanes<T> + l] += root[j * k % n] * C(lines[j * lanes<T> + l]);
  return result;
}

// Root mean square of the differences over that of the values.
template <class T>
double difference(const Array<std::complex<T>>& lines, const std::vector<C>& expected) {
  double off = 0, all = 0;
  for (std::size_t i = 0; i < lines.size(); ++i)
    off += std::norm(C(lines[i]) - expected[i]), all += std::norm(expected[i]);
  return std::sqrt(off / all);
}

template <class T>
void expect_sums(std::size_t n) {
  const LaneTransform<T> own(n), fftw(n, Planning::estimate, LineKernels::fftw);
  EXPECT_EQ(own.uses_fftw(), !smooth(n));
  EXPECT_TRUE(fftw.uses_fftw());
  const Array<std::complex<T>> lines = random_lines<T>(n);
  // Each pass rounds every value a few times, at random: log2(n) passes at most, of epsilon / 2 each. The sum itself
  // is of double precision, with n roundings.
  const double rounding = (1 + std::log2(static_cast<double>(n))) * std::numeric_limits<T>::epsilon() +
                          std::sqrt(static_cast<double>(n)) * std::numeric_limits<double>::epsilon();
  for (const auto* transform : {&own, &fftw}) {
    Array<std::complex<T>> work(transform->work_size()), there = lines, back = lines;
    transform->forward(there.data(), work.data());
    EXPECT_LT(difference(there, sums(lines, n, -1)), rounding) << n;
    transform->inverse(back.data(), work.data());
    EXPECT_LT(difference(back, sums(lines, n, 1)), rounding) << n;
    transform->inverse(there.data(), work.data());
    std::vector<C> scaled(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) scaled[i] = static_cast<double>(n) * C(lines[i]);
    EXPECT_LT(difference(there, scaled), 2 * rounding) << n;
  }
}

TEST(LaneTransform, EqualsTheSumAndFftwAtAllLengths) {
  for (const std::size_t n : lengths()) {
    expect_sums<double>(n);
    expect_sums<float>(n);
  }
}

template <class T>
void expect_same_with_gaps(std::size_t n, LineKernels kernels) {
  const LaneTransform<T> transform(n, Planning::estimate, kernels);
  const Array<std::complex<T>> lines = random_lines<T>(n);
  Array<std::complex<T>> work(transform.work_size()), expected = lines;
  transform.forward(expected.data(), work.data());
  const std::size_t in_stride = lanes<T> * 3, out_stride = lanes<T> * 2;
  Array<std::complex<T>> in(n * in_stride), out(n * out_stride, std::complex<T>(7));
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t l = 0; l < lanes<T>; ++l) in[j * in_stride + l] = lines[j * lanes<T> + l];
  transform.forward(in.data(), in_stride, out.data(), out_stride, work.data());
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t l = 0; l < lanes<T>; ++l) {
      EXPECT_EQ(out[j * out_stride + l], expected[j * lanes<T> + l]);
      EXPECT_EQ(out[j * out_stride + lanes<T> + l], std::complex<T>(7));
    }
  // In place, with gaps.
  transform.forward(in.data(), in_stride, in.data(), in_stride, work.data());
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t l = 0; l < lanes<T>; ++l) EXPECT_EQ(in[j * in_stride + l], expected[j * lanes<T> + l]);
}

TEST(LaneTransform, LinesMayLieApart) {
  for (const std::size_t n : {1, 2, 6, 7, 30, 48, 128})
    for (const LineKernels kernels : {LineKernels::own, LineKernels::fftw}) {
      expect_same_with_gaps<double>(n, kernels);
      expect_same_with_gaps<float>(n, kernels);
    }
}

// What stands in one lane does not depend on the others, bit for bit.
TEST(LaneTransform, LanesAreIndependent) {
  constexpr std::size_t n = 60;
  const LaneTransform<double> transform(n);
  Array<C> work(transform.work_size()), all = random_lines<double>(n), one(n * lanes<double>);
  for (std::size_t j = 0; j < n; ++j) one[j * lanes<double> + 3] = all[j * lanes<double> + 3];
  transform.inverse(all.data(), work.data());
  transform.inverse(one.data(), work.data());
  for (std::size_t j = 0; j < n; ++j) {
    EXPECT_EQ(one[j * lanes<double> + 3], all[j * lanes<double> + 3]);
    EXPECT_EQ(one[j * lanes<double> + 4], C{});
  }
}

}  // namespace
}  // namespace spume
