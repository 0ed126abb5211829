// SPDX-License-Identifier: MIT
#include "spume/fourier/spectrum.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>
#include <ostream>

#include "spume/core/array.hpp"
#include "spume/core/error.hpp"
#include "spume/core/random.hpp"

namespace spume {

// Otherwise GoogleTest names a test by the bytes of its grid, padding included.
void PrintTo(const UniformGrid& grid, std::ostream* out) {
  *out << grid.points[0] << 'x' << grid.points[1] << 'x' << grid.points[2];
}

namespace {

using std::numbers::pi;

std::array<Array<double>, 3> random_velocity(std::size_t size) {
  std::array<Array<double>, 3> velocity{Array<double>(size), Array<double>(size), Array<double>(size)};
  for (std::size_t i = 0; i < size; ++i) {
    const auto random = random_uniform(5, RandomPurpose::test, i, 0, 0);
    for (int d = 0; d < 3; ++d) velocity[d][i] = 2 * random[d] - 1 + d;
  }
  return velocity;
}

class SpectrumGrids : public ::testing::TestWithParam<UniformGrid> {};
INSTANTIATE_TEST_SUITE_P(Grids, SpectrumGrids,
                         ::testing::Values(UniformGrid{2, {0, 0, 0}, {1, 1, 0}, {32, 32, 1}},
                                           UniformGrid{2, {-1, 0, 0}, {2, 0.7, 0}, {15, 8, 1}},
                                           UniformGrid{3, {0, 0, 0}, {1, 1, 1}, {16, 16, 16}},
                                           UniformGrid{3, {0, 0, 0}, {1, 0.5, 2.3}, {9, 12, 7}}));

TEST_P(SpectrumGrids, ShellsAddUpToTheMeanKineticEnergy) {
  const UniformGrid grid = GetParam();
  const auto velocity = random_velocity(grid.size());
  const double* components[] = {velocity[0].data(), velocity[1].data(), velocity[2].data()};
  double mean = 0;
  for (const auto& component : velocity)
    for (const double u : component) mean += 0.5 * u * u / static_cast<double>(grid.size());
  const EnergySpectrum spectrum = energy_spectrum(grid, components);
  EXPECT_NEAR(spectrum.total(), mean, 1e-13 * mean);
  EXPECT_EQ(spectrum.wavenumber.size(), spectrum.energy.size());
}

TEST(Spectrum, ASingleModeLandsInItsShell) {
  // u_y = A cos(k.x) has the mean energy A^2 / 4. k = 2 pi (3, 0, 4) has the length 2 pi 5.
  const UniformGrid grid{3, {0, 0, 0}, {1, 1, 1}, {16, 12, 18}};
  Array<double> u(grid.size());
  for (std::size_t k = 0; k < grid.points[2]; ++k)
    for (std::size_t j = 0; j < grid.points[1]; ++j)
      for (std::size_t i = 0; i < grid.points[0]; ++i)
        u[grid.index(i, j, k)] = 2.0 * std::cos(2 * pi * (3 * grid.coordinate(0, i) + 4 * grid.coordinate(2, k)));
  const double* components[] = {u.data()};
  const EnergySpectrum spectrum = energy_spectrum(grid, components);
  EXPECT_DOUBLE_EQ(spectrum.bin_width, 2 * pi);
  EXPECT_DOUBLE_EQ(spectrum.complete_to, 12 * pi);
  for (std::size_t n = 0; n < spectrum.energy.size(); ++n) {
    EXPECT_NEAR(spectrum.energy[n], n == 5 ? 1.0 : 0.0, 1e-14) << n;
    EXPECT_DOUBLE_EQ(spectrum.wavenumber[n], 2 * pi * static_cast<double>(n));
  }
}

TEST(Spectrum, UnequalLengthsCountInPhysicalWavenumbers) {
  // Box 2 x 0.5: the bin width is pi; one wave across the short side has 2 pi / 0.5 = 4 bins.
  const UniformGrid grid{2, {0, 0, 0}, {2, 0.5, 0}, {32, 8, 1}};
  Array<double> u(grid.size()), v(grid.size());
  for (std::size_t j = 0; j < 8; ++j)
    for (std::size_t i = 0; i < 32; ++i) {
      u[grid.index(i, j)] = std::sin(4 * pi * grid.coordinate(1, j));
      v[grid.index(i, j)] = 2 * std::sin(3 * pi * grid.coordinate(0, i));
    }
  const double* components[] = {u.data(), v.data()};
  const EnergySpectrum spectrum = energy_spectrum(grid, components);
  EXPECT_NEAR(spectrum.bin_width, pi, 1e-15);
  for (std::size_t n = 0; n < spectrum.energy.size(); ++n)
    EXPECT_NEAR(spectrum.energy[n], n == 4 ? 0.25 : n == 3 ? 1.0 : 0.0, 1e-14) << n;
}

TEST(Spectrum, TheShortestWaveOfAnEvenGridIsCountedOnce) {
  const UniformGrid grid{2, {0, 0, 0}, {1, 1, 0}, {8, 8, 1}};
  Array<double> u(grid.size());
  for (std::size_t n = 0; n < u.size(); ++n) u[n] = n % 2 == 0 ? 1.0 : -1.0;
  const double* components[] = {u.data()};
  EXPECT_NEAR(energy_spectrum(grid, components).energy[4], 0.5, 1e-15);
}

TEST(Spectrum, IsTheSameForAnyNumberOfThreads) {
  const UniformGrid grid{3, {0, 0, 0}, {1, 1, 1}, {48, 40, 36}};
  const auto velocity = random_velocity(grid.size());
  const double* components[] = {velocity[0].data(), velocity[1].data(), velocity[2].data()};
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const EnergySpectrum one = energy_spectrum(grid, components);
  omp_set_num_threads(3);
  const EnergySpectrum three = energy_spectrum(grid, components);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.energy, three.energy);
}

TEST(Spectrum, RefusesAGridWithoutExtent) {
  const Array<double> u(4);
  const double* components[] = {u.data()};
  EXPECT_THROW(energy_spectrum(UniformGrid{2, {0, 0, 0}, {1, 0, 0}, {2, 2, 1}}, components), InputError);
  EXPECT_THROW(energy_spectrum(UniformGrid{1, {0, 0, 0}, {1, 1, 0}, {2, 2, 1}}, components), InputError);
}

}  // namespace
}  // namespace spume
