// SPDX-License-Identifier: MIT
// The kinetic energy spectrum of a periodic velocity field on a uniform grid.
#pragma once

#include <span>
#include <vector>

#include "spume/core/uniform_grid.hpp"

namespace spume {

// Kinetic energy per unit mass in shells of wavenumbers:
//   energy[n] = sum of |u_hat(k)|^2 / 2 over all modes k with n = |k| / bin_width rounded to the nearest integer,
// where u = sum_k u_hat(k) exp(i k.x). The shells of all modes, corners of the spectral box included, add up to the
// mean <u.u> / 2 (Parseval); shells beyond `complete_to` lack the modes that the grid does not carry. The energy
// density of the literature, whose integral over k is the energy, is energy[n] / bin_width.
struct EnergySpectrum {
  std::vector<double> wavenumber;  // n * bin_width: 2 pi / length
  std::vector<double> energy;      // velocity squared
  double bin_width = 0;            // 2 pi / longest length of the box
  double complete_to = 0;          // the smallest Nyquist wavenumber pi / spacing of the axes

  double total() const;  // sum of energy
};

// `velocity`: one pointer per component (any number of components), each to grid.size() values, aligned as Array is.
// Throws InputError for an invalid grid. Independent of the number of running threads, bit for bit.
EnergySpectrum energy_spectrum(const UniformGrid& grid, std::span<const double* const> velocity);

}  // namespace spume
