// SPDX-License-Identifier: MIT
// Transforms of the spectral method against full transforms of padded fields, to rounding.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"
#include "spume/fourier/box_transform.hpp"
#include "spume/fourier/cross_product.hpp"
#include "spume/fourier/real_transform.hpp"

namespace spume {
namespace {

using Points = std::array<std::size_t, 3>;
using C = std::complex<double>;

template <class T>
struct Field {
  std::array<Array<std::complex<T>>, 3> mode;
  std::array<const std::complex<T>*, 3> in() const { return {mode[0].data(), mode[1].data(), mode[2].data()}; }
  std::array<std::complex<T>*, 3> out() { return {mode[0].data(), mode[1].data(), mode[2].data()}; }
};

// Index of the conjugate mode along an axis.
std::size_t partner(std::size_t i, std::size_t n) {
  return i == 0 ? 0 : n - i;
}

// A random potential with div b = 0 that decays with k, and a mean velocity; real in space.
template <class T>
Field<T> random_potential(const ModeLayout& layout) {
  Field<T> field;
  for (auto& mode : field.mode) mode.resize(layout.size());
  const auto [nx, ny, nz] = layout.points;
  for (std::size_t ix = 0; ix < nx; ++ix)
    for (std::size_t iy = 0; iy < ny; ++iy)
      for (std::size_t iz = 0; iz < nz / 2; ++iz) {
        if (ix == nx / 2 || iy == ny / 2) continue;
        const std::size_t at = ix * layout.plane + iy * layout.row + iz;
        const std::size_t other = partner(ix, nx) * layout.plane + partner(iy, ny) * layout.row;
        if (iz == 0 && other < at) {
          for (auto& mode : field.mode) mode[at] = std::conj(mode[other]);
          continue;
        }
        std::array<C, 3> b;
        for (std::uint32_t c = 0; c < 3; ++c) {
          const auto r = random_uniform(7, RandomPurpose::test, at, 0, c);
          b[c] = {r[0] - 0.5, iz == 0 && other == at ? 0 : r[1] - 0.5};
        }
        const double k[3] = {layout.wavenumber[0][ix], layout.wavenumber[1][iy], layout.wavenumber[2][iz]};
        const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
        const C along = k2 > 0 ? (k[0] * b[0] + k[1] * b[1] + k[2] * b[2]) / k2 : 0;
        for (std::size_t c = 0; c < 3; ++c)
          field.mode[c][at] = static_cast<std::complex<T>>((b[c] - along * k[c]) / (1 + k2));
      }
  return field;
}

struct Curls {
  std::array<C, 3> u, omega;
};
template <class T>
Curls curls(const ModeLayout& layout, const Field<T>& b, std::size_t ix, std::size_t iy, std::size_t iz) {
  const std::size_t at = ix * layout.plane + iy * layout.row + iz;
  const double k[3] = {layout.wavenumber[0][ix], layout.wavenumber[1][iy], layout.wavenumber[2][iz]};
  Curls result;
  const C i(0, 1);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t p = (c + 1) % 3, q = (c + 2) % 3;
    result.u[c] = i * (k[p] * C(b.mode[q][at]) - k[q] * C(b.mode[p][at]));
    if (at == 0) result.u[c] = C(b.mode[c][at]);
    result.omega[c] = (k[0] * k[0] + k[1] * k[1] + k[2] * k[2]) * C(b.mode[c][at]);
  }
  return result;
}

// The slow twin: full transforms of fields padded to M points per axis.
template <class T>
Field<double> full_product(const ModeLayout& layout, const Field<T>& b, std::size_t phases, double* rate,
                           double* speed) {
  Points m;
  for (std::size_t a = 0; a < 3; ++a) m[a] = layout.points[a] / 2 * phases;
  const RealTransform transform({m[2], m[1], m[0]});
  const auto place = [&](std::size_t ix, std::size_t iy, std::size_t iz) {
    const std::size_t jx = ix < layout.points[0] / 2 ? ix : m[0] - layout.points[0] + ix;
    const std::size_t jy = iy < layout.points[1] / 2 ? iy : m[1] - layout.points[1] + iy;
    return iz + (m[2] / 2 + 1) * (jy + m[1] * jx);
  };
  const auto each = [&](auto&& body) {
    for (std::size_t ix = 0; ix < layout.points[0]; ++ix)
      for (std::size_t iy = 0; iy < layout.points[1]; ++iy)
        for (std::size_t iz = 0; iz < layout.modes_z; ++iz)
          if (ix != layout.points[0] / 2 && iy != layout.points[1] / 2) body(ix, iy, iz);
  };
  std::array<Array<double>, 6> real;
  Array<C> modes(transform.spectral_size());
  for (std::size_t f = 0; f < 6; ++f) {
    modes.fill(0);
    each([&](std::size_t ix, std::size_t iy, std::size_t iz) {
      const Curls curl = curls(layout, b, ix, iy, iz);
      modes[place(ix, iy, iz)] = static_cast<double>(transform.real_size()) * (f < 3 ? curl.u[f] : curl.omega[f - 3]);
    });
    real[f].resize(transform.real_size());
    transform.inverse(modes, real[f]);
  }
  *rate = *speed = 0;
  Array<double> product(transform.real_size());
  Field<double> result;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t p = (c + 1) % 3, q = (c + 2) % 3;
    for (std::size_t i = 0; i < product.size(); ++i) {
      product[i] = real[p][i] * real[3 + q][i] - real[q][i] * real[3 + p][i];
      double sum = 0, square = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        sum += std::abs(real[a][i]) * static_cast<double>(layout.points[a]) / layout.lengths[a];
        square += real[a][i] * real[a][i];
      }
      *rate = std::max(*rate, sum);
      *speed = std::max(*speed, std::sqrt(square));
    }
    transform.forward(product, modes);
    result.mode[c].resize(layout.size());
    each([&](std::size_t ix, std::size_t iy, std::size_t iz) {
      result.mode[c][ix * layout.plane + iy * layout.row + iz] =
          modes[place(ix, iy, iz)] / static_cast<double>(transform.real_size());
    });
  }
  return result;
}

template <class T>
void expect_pruned_equals_full(const Points& points, bool padded) {
  const ModeLayout layout = make_mode_layout<T>(points, {1, 2.5, 4});
  const Field<T> potential = random_potential<T>(layout);
  double rate = 0, speed = 0;
  const Field<double> expected = full_product(layout, potential, padded ? 3 : 2, &rate, &speed);
  CrossProduct<T> product(layout, padded);
  Field<T> sum, result;
  for (std::size_t c = 0; c < 3; ++c) {
    sum.mode[c].resize(layout.size());
    result.mode[c].resize(layout.size());
  }
  const VelocityPeak peak = product.evaluate(
      potential.in(), sum.out(),
      [&](std::size_t ix, std::size_t iy, std::size_t first, const std::complex<T>* const value[3]) {
        for (std::size_t c = 0; c < 3; ++c)
          std::copy_n(value[c], lanes<T>, &result.mode[c][ix * layout.plane + iy * layout.row + first]);
      });
  double worst = 0, scale = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < layout.size(); ++i) {
      worst = std::max(worst, std::abs(C(result.mode[c][i]) - expected.mode[c][i]));
      scale = std::max(scale, std::abs(expected.mode[c][i]));
    }
  // Rounding of a few dozen operations per value in the working precision.
  const double rounding = 40 * std::numeric_limits<T>::epsilon();
  EXPECT_GT(scale, 1e-3);
  EXPECT_LT(worst, rounding * scale) << points[0] << ' ' << points[1] << ' ' << points[2];
  EXPECT_NEAR(peak.rate, rate, rounding * rate);
  EXPECT_NEAR(peak.speed, speed, rounding * speed);
}

TEST(CrossProduct, PrunedTransformsGiveWhatFullPaddedTransformsGive) {
  for (const Points& points : {Points{16, 16, 16}, Points{8, 12, 20}, Points{18, 10, 14}, Points{32, 4, 6}}) {
    expect_pruned_equals_full<double>(points, true);
    expect_pruned_equals_full<float>(points, true);
  }
}

TEST(CrossProduct, UnpaddedProductIsTheAliasedOne) {
  expect_pruned_equals_full<double>({16, 12, 10}, false);
  expect_pruned_equals_full<float>({16, 12, 10}, false);
}

TEST(CrossProduct, SameBitsForAnyNumberOfThreads) {
  const ModeLayout layout = make_mode_layout<double>({16, 20, 12}, {1, 1, 1});
  const Field<double> potential = random_potential<double>(layout);
  std::vector<Field<double>> results(2);
  const int before = omp_get_max_threads();
  for (int threads = 1; threads <= 2; ++threads) {
    omp_set_num_threads(threads);
    Field<double>& result = results[static_cast<std::size_t>(threads - 1)];
    Field<double> sum;
    for (std::size_t c = 0; c < 3; ++c) {
      sum.mode[c].resize(layout.size());
      result.mode[c].resize(layout.size());
    }
    CrossProduct<double>(layout, true)
        .evaluate(potential.in(), sum.out(),
                  [&](std::size_t ix, std::size_t iy, std::size_t first, const C* const v[3]) {
                    for (std::size_t c = 0; c < 3; ++c)
                      std::copy_n(v[c], lanes<double>, &result.mode[c][ix * layout.plane + iy * layout.row + first]);
                  });
  }
  omp_set_num_threads(before);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_EQ(std::memcmp(results[0].mode[c].data(), results[1].mode[c].data(), layout.size() * sizeof(C)), 0);
}

// Groups of rows reach beyond the last row of a grid whose size is no multiple of theirs. What rounding leaves in the
// rows that only fill a group must not come back: with large values it would outgrow the velocity.
TEST(CrossProduct, EvaluationsDoNotRememberEarlierOnes) {
  const ModeLayout layout = make_mode_layout<float>({12, 20, 14}, {1, 1, 1});
  Field<float> potential = random_potential<float>(layout), sum;
  for (std::size_t c = 0; c < 3; ++c) {
    sum.mode[c].resize(layout.size());
    for (std::size_t i = 0; i < layout.size(); ++i) potential.mode[c][i] *= 1e9F;
  }
  CrossProduct<float> product(layout, true);
  const auto nothing = [](std::size_t, std::size_t, std::size_t, const std::complex<float>* const[3]) {};
  const VelocityPeak first = product.evaluate(potential.in(), sum.out(), nothing);
  for (int again = 0; again < 3; ++again) {
    const VelocityPeak peak = product.evaluate(potential.in(), sum.out(), nothing);
    EXPECT_EQ(peak.speed, first.speed);
    EXPECT_EQ(peak.rate, first.rate);
  }
  double rate = 0, speed = 0;
  full_product(layout, potential, 3, &rate, &speed);
  EXPECT_NEAR(first.speed, speed, 1e-5 * speed);
  EXPECT_NEAR(first.rate, rate, 1e-5 * rate);
}

template <class T>
void expect_round_trip(const Points& points) {
  const ModeLayout layout = make_mode_layout<T>(points, {2, 3, 5});
  const Field<T> field = random_potential<T>(layout);
  BoxTransform<T> transform(layout);
  const std::size_t stride = points[2] + 3;
  Array<T> values(points[0] * points[1] * stride);
  transform.inverse(
      [&](std::size_t ix, std::size_t iy, std::size_t first, std::complex<T>* block) {
        std::copy_n(&field.mode[0][ix * layout.plane + iy * layout.row + first], lanes<T>, block);
      },
      values.data(), stride);
  // A few points by the sum itself.
  for (const Points& p : {Points{0, 0, 0}, Points{1, 2, 3}, Points{points[0] - 1, 1, points[2] - 2}}) {
    double expected = 0;
    for (std::size_t ix = 0; ix < points[0]; ++ix)
      for (std::size_t iy = 0; iy < points[1]; ++iy)
        for (std::size_t iz = 0; iz < layout.modes_z; ++iz) {
          double phase = 0;
          const std::size_t index[3] = {ix, iy, iz};
          for (std::size_t a = 0; a < 3; ++a)
            phase += layout.wavenumber[a][index[a]] * layout.lengths[a] * static_cast<double>(p[a]) /
                     static_cast<double>(points[a]);
          expected += ModeLayout::weight(iz) *
                      (C(field.mode[0][ix * layout.plane + iy * layout.row + iz]) * std::polar(1.0, phase)).real();
        }
    EXPECT_NEAR(values[(p[0] * points[1] + p[1]) * stride + p[2]], expected, 200 * std::numeric_limits<T>::epsilon());
  }
  double worst = 0;
  transform.forward(
      values.data(), stride, [&](std::size_t ix, std::size_t iy, std::size_t first, const std::complex<T>* block) {
        for (std::size_t l = 0; l < lanes<T>; ++l) {
          const double off = std::abs(C(block[l]) - C(field.mode[0][ix * layout.plane + iy * layout.row + first + l]));
#pragma omp critical
          worst = std::max(worst, off);
        }
      });
  EXPECT_LT(worst, 10 * std::numeric_limits<T>::epsilon());
}

TEST(BoxTransform, InverseIsTheFourierSumAndForwardUndoesIt) {
  expect_round_trip<double>({8, 12, 10});
  expect_round_trip<float>({8, 12, 10});
  expect_round_trip<double>({14, 6, 36});
  expect_round_trip<float>({6, 40, 22});
  expect_round_trip<double>({4, 18, 28});
}

}  // namespace
}  // namespace spume
