// SPDX-License-Identifier: MIT
// Absorption of waves by a piston that makes waves at the same time: what it measures at its face beyond the waves that
// it is to make, e, moves it back. Its velocity into the liquid is corrected by v with
//   smoothing du/dt = -gain e - u,   dX/dt = v = u - X / drift,
// X being the way that the correction has moved the wall, which so returns. Of long waves u = -e sqrt(g/h) takes up
// all (Schaeffer and Klopman 2000); waves of finite depth need a smaller gain, and a delay, as part of e is the liquid
// that the piston pushes up before itself.
//
// - Schaeffer, H. A. and Klopman, G. (2000), Review of multidirectional active wave absorption methods, J. Waterway,
//   Port, Coastal, Ocean Engng 126:88.
// - Altomare, C. et al. (2017), Long-crested wave generation and absorption for SPH-based DualSPHysics model, Coastal
//   Engng 127:37.
#pragma once

#include <complex>
#include <memory>
#include <vector>

#include "spume/scene/scene.hpp"
#include "spume/scene/wave_theory.hpp"

namespace spume {

// The elevation is the mean of columns half a spacing, one and a half, ... from the wall.
constexpr int gauge_columns = 3;

// gain = sqrt(g/h). Smoothing 0.1 sqrt(h/g); drift ten periods of waves of kh = 1.
AbsorptionLaw long_wave_law(const FaceOfPiston& face);
// Nothing comes back of waves of this frequency; drift three periods.
AbsorptionLaw tuned_law(const FaceOfPiston& face, double angular_frequency);

// Elevation at the gauge over i times the motion of the piston, by linear theory: c_0 exp(-ikx) + the modes that decay.
std::complex<double> face_transfer(const FaceOfPiston& face, double angular_frequency);

// The wave that the piston sends back over the one that comes, complex amplitudes at the wall. With Z the face
// transfer, c its part that travels, x the gauge, and beta the velocity -v over w e:
//   R = 1 - 2 beta c cos kx / (1 + beta Z).
std::complex<double> reflection(const AbsorptionLaw& law, const FaceOfPiston& face, double angular_frequency);

}  // namespace spume
