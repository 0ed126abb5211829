// SPDX-License-Identifier: MIT
// Linear modes of water of depth h before a wavemaker at x = 0 that moves with w: exp(i(wt - kappa x))
// cosh kappa(z + h), with w^2 = g kappa tanh kappa h. One travels, kappa = k; of the others kappa = -i k_j, they decay
// with exp(-k_j x) and end the elevation at the wavemaker. z is 0 at the still surface.
//
// - Dean, R. G. and Dalrymple, R. A. (1984), Water wave mechanics for engineers and scientists, chapter 6.
// - Schaeffer, H. A. (1996), Second-order wavemaker theory for irregular waves, Ocean Engng 23:47.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace spume {

enum class WavemakerKind { piston, flap };  // moves with 1, or with 1 + z / h

struct WaveMode {
  std::complex<double> wavenumber;
  std::complex<double> tanh, sech;  // of wavenumber times depth
  // c of the elevation i X c exp(i(wt - kappa x)) that a motion X exp(iwt) makes, at the still surface of a flap. Of
  // the mode that travels it is wave height over stroke (Biesel and Suquet 1951).
  std::complex<double> transfer;
};

// k_j: the root of k h tan kh = -w^2 h / g with (j - 1/2) pi < kh < j pi, j = 1, 2, ...
double decaying_wavenumber(double angular_frequency, double depth, double gravity, std::size_t j);

// The mode that travels, and `decaying` others.
std::vector<WaveMode> wave_modes(WavemakerKind kind, double angular_frequency, double depth, double gravity,
                                 std::size_t decaying);

}  // namespace spume
