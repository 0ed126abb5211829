// SPDX-License-Identifier: MIT
#include "spume/operators/energy_spectrum.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "operators/direct_stencil.hpp"
#include "operators/jittered_particles.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"

namespace spume::test {
namespace {

using std::numbers::pi;

// u(x) = amplitude cos(2 pi mode.x + phase), amplitude normal to mode.
struct Wave {
  std::array<int, 3> mode;
  std::array<double, 3> amplitude;
  double phase;
  std::size_t shell;
};

double product(const std::array<double, 3>& a, const std::array<int, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Up to six solenoidal waves of random direction in each shell n = 1 .. last, sharing the energy n^(-5/3) evenly.
std::vector<Wave> synthetic_turbulence(int dimensions, int last) {
  std::vector<Wave> waves;
  std::uint64_t draw = 0;
  for (int n = 1; n <= last; ++n) {
    const std::size_t first = waves.size();
    while (waves.size() < first + (n == 1 ? 2 : 6)) {
      const auto random = random_uniform(21, RandomPurpose::test, draw++, 0, 0);
      const auto direction = random_uniform(21, RandomPurpose::test, draw++, 0, 0);
      Wave wave{{}, {}, 2 * pi * random[3], static_cast<std::size_t>(n)};
      double squared = 0;
      for (int d = 0; d < dimensions; ++d) {
        wave.mode[d] = static_cast<int>(std::lround((2 * random[d] - 1) * n));
        squared += wave.mode[d] * wave.mode[d];
      }
      if (std::lround(std::sqrt(squared)) != n) continue;
      bool taken = false;  // the energies of equal or opposite modes would not add
      for (std::size_t w = first; w < waves.size(); ++w) {
        const auto& m = waves[w].mode;
        taken |= m == wave.mode || m == std::array{-wave.mode[0], -wave.mode[1], -wave.mode[2]};
      }
      if (taken) continue;
      std::array<double, 3> amplitude{};
      for (int d = 0; d < dimensions; ++d) amplitude[d] = 2 * direction[d] - 1;
      const double along = product(amplitude, wave.mode) / squared;
      for (int d = 0; d < dimensions; ++d) wave.amplitude[d] = amplitude[d] - along * wave.mode[d];
      waves.push_back(wave);
    }
    // A wave holds the energy |amplitude|^2 / 4.
    const double share = std::pow(n, -5.0 / 3) / static_cast<double>(waves.size() - first);
    for (std::size_t w = first; w < waves.size(); ++w) {
      auto& a = waves[w].amplitude;
      const double scale = 2 * std::sqrt(share / (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]));
      for (double& component : a) component *= scale;
    }
  }
  return waves;
}

ParticleSpectrumInput input_of(const JitteredParticles& particles, const std::array<Array<double>, 3>& velocity) {
  ParticleSpectrumInput input;
  input.dimensions = particles.dimensions;
  input.upper = {1, 1, 1};
  input.position = particles.positions();
  input.velocity = {velocity[0], velocity[1], velocity[2]};
  input.spacing = particles.spacing;
  return input;
}

std::array<Array<double>, 3> velocity_at(const JitteredParticles& particles, const std::vector<Wave>& waves) {
  std::array<Array<double>, 3> velocity;
  for (auto& component : velocity) component.resize(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    const auto x = particles.at(i);
    for (const Wave& wave : waves) {
      const double value = std::cos(2 * pi * product(x, wave.mode) + wave.phase);
      for (int d = 0; d < 3; ++d) velocity[d][i] += value * wave.amplitude[d];
    }
  });
  return velocity;
}

class ParticleEnergySpectrum : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, ParticleEnergySpectrum, testing::Values(2, 3));

TEST_P(ParticleEnergySpectrum, OfAKnownFieldIsRecoveredUpToHalfTheNyquistWavenumber) {
  const int dimensions = GetParam();
  const int across = dimensions == 2 ? 64 : 32;
  const JitteredParticles particles(dimensions, static_cast<std::size_t>(across), 0.25);
  const int last = across / 4;
  const std::vector<Wave> waves = synthetic_turbulence(dimensions, last);
  const ParticleSpectrum result = energy_spectrum(input_of(particles, velocity_at(particles, waves)));
  ASSERT_EQ(result.interpolation.cubic, static_cast<std::int64_t>(particles.size()));

  // The transfer function of a stencil at x is T = sum_j w_j exp(i k.(x_j - x)). Its mean over points multiplies the
  // amplitude of a wave; its fluctuation scatters energy over all shells. Mean and fluctuation from the slow twin.
  constexpr std::size_t samples = 120;
  std::vector<std::complex<double>> mean(waves.size(), 0.0);
  std::vector<double> square(waves.size(), 0.0);
  const double support_radius = GridInterpolationOptions{}.support * particles.spacing;
  for (std::size_t s = 0; s < samples; ++s) {
    std::array<double, 3> x{};
    const auto random = random_uniform(22, RandomPurpose::test, s, 0, 0);
    for (int d = 0; d < dimensions; ++d) x[d] = (std::floor(random[d] * across) + 0.5) * particles.spacing;
    const auto stencil = direct_stencil(particles, x, support_radius);
    for (std::size_t w = 0; w < waves.size(); ++w) {
      std::complex<double> transfer = 0;
      for (std::size_t j = 0; j < stencil.weight.size(); ++j)
        transfer += std::polar(stencil.weight[j], 2 * pi * product(stencil.offset[j], waves[w].mode));
      mean[w] += transfer / static_cast<double>(samples);
      square[w] += std::norm(transfer) / samples;
    }
  }
  std::vector<double> expected(result.spectrum.energy.size(), 0.0), uncertainty(expected.size(), 0.0);
  double scattered = 0;
  for (std::size_t w = 0; w < waves.size(); ++w) {
    const auto& a = waves[w].amplitude;
    const double energy = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) / 4;
    const double variance = square[w] - std::norm(mean[w]);
    expected[waves[w].shell] += std::norm(mean[w]) * energy;
    // Four standard errors of the sampled mean; those of one shell share their stencils, so they add.
    uncertainty[waves[w].shell] += 4 * 2 * std::abs(mean[w]) * std::sqrt(variance / samples) * energy;
    scattered += variance * energy;
  }
  for (std::size_t n = 1; n <= static_cast<std::size_t>(last); ++n) {
    // Scattered energy is spread over modes at random: twice a shell's share of the circle or sphere of modes. It also
    // interferes with the wave itself, by the root of both, over a handful of waves.
    const double modes = dimensions == 2 ? 2 * pi * static_cast<double>(n) : 4 * pi * static_cast<double>(n * n);
    const double share = scattered * modes / static_cast<double>(particles.size());
    const double interference = 4 * std::sqrt(expected[n] * scattered / static_cast<double>(particles.size()));
    EXPECT_NEAR(result.spectrum.energy[n], expected[n], uncertainty[n] + 2 * share + interference) << n;
    // What a user sees: within 1.5 % below a quarter of the Nyquist wavenumber, at worst 17 % low at half of it.
    const double ratio = result.spectrum.energy[n] / std::pow(static_cast<double>(n), -5.0 / 3);
    EXPECT_LT(ratio, 1.005) << n;
    EXPECT_GT(ratio, 4 * n <= static_cast<std::size_t>(across) / 2 ? 0.985 : 0.83) << n;
  }
  EXPECT_EQ(result.spectrum.wavenumber[1], 2 * pi);
  EXPECT_LT(result.spectrum.energy[0], 1e-5);
}

TEST_P(ParticleEnergySpectrum, AFinerGridDoesNotChangeTheResolvedShells) {
  // The stencil belongs to the particles: its transfer function at a given wavenumber does not depend on the grid.
  const int dimensions = GetParam();
  const int across = dimensions == 2 ? 48 : 20;
  const JitteredParticles particles(dimensions, static_cast<std::size_t>(across), 0.2);
  const auto velocity = velocity_at(particles, synthetic_turbulence(dimensions, 4));
  ParticleSpectrumInput input = input_of(particles, velocity);
  const ParticleSpectrum natural = energy_spectrum(input);
  for (int d = 0; d < dimensions; ++d) input.points[d] = static_cast<std::size_t>(across * 3 / 2);
  const ParticleSpectrum fine = energy_spectrum(input);
  EXPECT_GT(fine.spectrum.complete_to, 1.4 * natural.spectrum.complete_to);
  for (std::size_t n = 1; n <= 4; ++n)
    EXPECT_NEAR(fine.spectrum.energy[n], natural.spectrum.energy[n], 0.02 * natural.spectrum.energy[n]) << n;
}

TEST_P(ParticleEnergySpectrum, ASingleModeLandsInItsShell) {
  const int dimensions = GetParam();
  const JitteredParticles particles(dimensions, dimensions == 2 ? 40 : 20, 0.2);
  const std::vector<Wave> wave{{{2, 1, dimensions == 3 ? 2 : 0}, {1, -2, 0}, 0.3, 3}};
  const ParticleSpectrum result = energy_spectrum(input_of(particles, velocity_at(particles, wave)));
  const std::size_t shell = dimensions == 2 ? 2 : 3;  // |(2, 1)| = 2.24, |(2, 1, 2)| = 3
  EXPECT_NEAR(result.spectrum.energy[shell], 5.0 / 4, 0.05 * 5 / 4);
  EXPECT_NEAR(result.spectrum.energy[shell], result.spectrum.total(), 1e-3 * result.spectrum.total());
}

TEST_P(ParticleEnergySpectrum, IsTheSameForAnyNumberOfThreads) {
  const int dimensions = GetParam();
  const JitteredParticles particles(dimensions, dimensions == 2 ? 40 : 16, 0.3);
  const auto velocity = velocity_at(particles, synthetic_turbulence(dimensions, 4));
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const ParticleSpectrum one = energy_spectrum(input_of(particles, velocity));
  omp_set_num_threads(3);
  const ParticleSpectrum three = energy_spectrum(input_of(particles, velocity));
  omp_set_num_threads(threads);
  EXPECT_EQ(one.spectrum.energy, three.spectrum.energy);
}

TEST(ParticleEnergySpectrumErrors, AreNamed) {
  const JitteredParticles particles(2, 8, 0.1);
  std::array<Array<double>, 3> velocity;
  EXPECT_THROW(energy_spectrum(input_of(particles, velocity)), InputError);
  for (auto& component : velocity) component.resize(particles.size());
  ParticleSpectrumInput input = input_of(particles, velocity);
  EXPECT_NO_THROW(energy_spectrum(input));
  input.spacing = 0;
  EXPECT_THROW(energy_spectrum(input), InputError);
  input.spacing = 0.125;
  input.dimensions = 4;
  EXPECT_THROW(energy_spectrum(input), InputError);
}

}  // namespace
}  // namespace spume::test
