// SPDX-License-Identifier: MIT
// Statistics of a flow: scales, spectrum, moments and distributions of the velocity gradient.
#pragma once

#include <vector>

#include "spume/methods/spectral/flow.hpp"

namespace spume::spectral {

// E(k) with sum over shells of E dk = mean of u^2/2 without the mean velocity; shells n - 1/2 <= k/dk < n + 1/2 with
// dk = 2 pi / longest length.
struct ShellSpectrum {
  std::vector<double> wavenumber, energy;
  double width = 0;
};
template <class T>
ShellSpectrum shell_spectrum(const Flow<T>& flow);

// Scales of homogeneous turbulence from u' = sqrt(2 E / 3) (mean velocity left out) and the dissipation. Those that
// need a dissipation above 0 are not a number without it.
struct Scales {
  double rms_velocity = 0;      // u'
  double enstrophy = 0;         // mean of omega^2 / 2
  double taylor_scale = 0;      // lambda = u' sqrt(15 nu / epsilon)
  double reynolds_lambda = 0;   // u' lambda / nu
  double kolmogorov_scale = 0;  // eta = (nu^3 / epsilon)^(1/4)
  double kmax_eta = 0;          // with the least of the largest wavenumbers kept along the axes
  double integral_scale = 0;    // pi / (2 u'^2) sum over the modes of |u_k|^2 / (2 |k|)
};
template <class T>
Scales flow_scales(const Flow<T>& flow, const ShellSpectrum& spectrum);

// Of the present velocity on the points of the grid. Takes a field of one number a point while it runs.
template <class T>
double largest_speed(Flow<T>& flow);

// Of du/dx, dv/dy and dw/dz together: third moment over variance^(3/2), fourth over its square.
struct GradientMoments {
  double skewness = 0, flatness = 0;
};
template <class T>
GradientMoments gradient_moments(Flow<T>& flow);

// Probability densities of gradients over their standard deviation, in bins: longitudinal du/dx, dv/dy, dw/dz, and
// transverse du/dy, dv/dz, dw/dx.
struct GradientDistribution {
  std::vector<double> value, longitudinal, transverse;
};
template <class T>
GradientDistribution gradient_distribution(Flow<T>& flow);

// Velocity and pressure at any point by their Fourier sums. `total_pressure` as of Flow::total_pressure.
template <class T>
PointSample sample_flow(const Flow<T>& flow, const Array<std::complex<T>>& total_pressure, const Vec3& from_lower);

// Their averages over the plane where the coordinate along `axis` is `from_lower`, exact at any place: those of a field
// are its modes along the axis alone, and that of u^2, which the pressure needs, is by Parseval the sum of
// |sum_k u_k exp(i k x)|^2 over the wavenumbers within the plane, k running along the axis.
template <class T>
PlaneSample sample_plane(const Flow<T>& flow, const Array<std::complex<T>>& total_pressure, std::size_t axis,
                         double from_lower);

}  // namespace spume::spectral
