// SPDX-License-Identifier: MIT
#include "spume/fourier/spectrum.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "spume/core/array.hpp"
#include "spume/core/parallel.hpp"
#include "spume/fourier/real_transform.hpp"

namespace spume {

namespace {

// A fixed number makes the plan, and so its rounding, the same for any number of running threads. Plans for 8 and 16
// threads are 6 times slower on some grids (100^3, 48^3) than those for up to 4, which cost a few ms at 100^3.
constexpr int planned_threads = 4;

// Wavenumbers along one axis in units of the bin width.
std::vector<double> axis_wavenumbers(std::size_t points, std::size_t stored, double unit) {
  std::vector<double> k(stored);
  for (std::size_t i = 0; i < stored; ++i) {
    const double signed_index =
        i <= points / 2 ? static_cast<double>(i) : static_cast<double>(i) - static_cast<double>(points);
    k[i] = signed_index * unit;
  }
  return k;
}

}  // namespace

double EnergySpectrum::total() const {
  return std::accumulate(energy.begin(), energy.end(), 0.0);
}

EnergySpectrum energy_spectrum(const UniformGrid& grid, std::span<const double* const> velocity) {
  require_valid(grid);
  double longest = 0;
  for (int axis = 0; axis < grid.dimensions; ++axis) longest = std::max(longest, grid.length(axis));

  EnergySpectrum result;
  result.bin_width = 2 * std::numbers::pi / longest;
  result.complete_to = std::numbers::pi / grid.spacing(0);
  for (int axis = 1; axis < grid.dimensions; ++axis)
    result.complete_to = std::min(result.complete_to, std::numbers::pi / grid.spacing(axis));

  const std::size_t nx = grid.points[0], ny = grid.points[1], nz = grid.points[2];
  const std::size_t modes = nx / 2 + 1;
  const auto unit = [&](int axis) { return axis < grid.dimensions ? longest / grid.length(axis) : 0.0; };
  const std::vector<double> kx = axis_wavenumbers(nx, modes, unit(0));
  const std::vector<double> ky = axis_wavenumbers(ny, ny, unit(1));
  const std::vector<double> kz = axis_wavenumbers(nz, nz, unit(2));
  const auto shell = [&](std::size_t a, std::size_t b, std::size_t c) {
    return static_cast<std::size_t>(std::lround(std::sqrt(kx[a] * kx[a] + ky[b] * ky[b] + kz[c] * kz[c])));
  };
  const std::size_t shells = shell(nx / 2, ny / 2, nz / 2) + 1;

  const RealTransform transform(grid.points, planned_threads);
  Array<std::complex<double>> spectrum(transform.spectral_size());
  const std::size_t rows = ny * nz;
  const std::size_t block = std::max<std::size_t>(8, block_count(rows, max_reduction_blocks));
  std::vector<double> partial(block_count(rows, block) * shells, 0.0);
  for (const double* component : velocity) {
    transform.forward({component, grid.size()}, spectrum);
    parallel_blocks(rows, block, [&](std::size_t index, std::size_t first, std::size_t last) {
      double* sums = partial.data() + index * shells;
      for (std::size_t row = first; row < last; ++row)
        for (std::size_t a = 0; a < modes; ++a) {
          // A stored mode stands for itself and its conjugate, except where the conjugate is stored as well:
          // in the planes a = 0 and, for even nx, a = nx / 2.
          const double copies = a == 0 || 2 * a == nx ? 1.0 : 2.0;
          sums[shell(a, row % ny, row / ny)] += copies * std::norm(spectrum[row * modes + a]);
        }
    });
  }

  const double size = static_cast<double>(grid.size());
  result.wavenumber.resize(shells);
  result.energy.assign(shells, 0.0);
  for (std::size_t n = 0; n < shells; ++n) {
    for (std::size_t b = n; b < partial.size(); b += shells) result.energy[n] += partial[b];
    result.energy[n] *= 0.5 / (size * size);
    result.wavenumber[n] = static_cast<double>(n) * result.bin_width;
  }
  return result;
}

}  // namespace spume
