// SPDX-License-Identifier: MIT
// The motion of second order that a piston or a flap needs beside that of first order, so that its waves travel with
// the waves bound to them alone: free waves of the sums and differences of their frequencies are not made. Schaeffer's
// theory (1996), with the modes that decay.
//
// For two motions X_a exp(i w_a t), X_b exp(i w_b t), of a difference the second conjugate, W = w_a + w_b, W^2 = g K
// tanh Kh, and every pair of their modes p exp(i(wt - kappa x)) cosh kappa(z+h) / cosh kappa h of the potential:
//   - the surface drives a bound wave of kappa = kappa_a + kappa_b,
//     phi_tt + g phi_z = -(|grad phi|^2)_t + phi_t (phi_ttz + g phi_zz) / g,
//     whose velocity at the wall, projected on cosh K(z+h), is -i kappa Q / (g (kappa^2 - K^2)), Q the right-hand side;
//   - the moving wall needs phi_x = (f X)_t + (f X)_z phi_z - f X phi_xx, f = 1 of a piston and 1 + z/h of a flap.
// The motion of frequency W is the one with which nothing is left of both on cosh K(z+h), the wave that would travel.
//
// - Schaeffer, H. A. (1996), Second-order wavemaker theory for irregular waves, Ocean Engng 23:47.
#pragma once

#include <vector>

#include "spume/scene/wave_modes.hpp"
#include "spume/scene/wave_theory.hpp"

namespace spume {

// A motion X exp(iwt) at the still surface and what it makes of first order.
struct FirstOrderMotion {
  FirstOrderMotion(const Oscillation& term, WavemakerKind kind, double depth, double gravity, std::size_t decaying);
  double angular_frequency;
  std::complex<double> amplitude;
  std::vector<WaveMode> modes;
};

// X of the motion X exp(i(w_a + w_b) t), or of w_a - w_b > 0, that belongs to two terms; `a` and `b` may be the same
// object. Of an even number of decaying modes what those left out add is extrapolated from half of them.
std::complex<double> second_order_amplitude(WavemakerKind kind, const FirstOrderMotion& a, const FirstOrderMotion& b,
                                            bool difference, double depth, double gravity);

// Of a single term the one with twice its frequency, of several all sums and differences.
std::vector<Oscillation> second_order_motion(const std::vector<Oscillation>& first, WavemakerKind kind, double depth,
                                             double gravity);

// Elevation of second order at the gauge of a piston, which moves with it: of the bound waves, of their decaying parts
// beside the wall and of the motion X of second order, as the amplitude of exp(iWt). Of the far waves it is that of
// Longuet-Higgins and Stewart (1962) and of Stokes.
std::complex<double> second_order_elevation(const FirstOrderMotion& a, const FirstOrderMotion& b, bool difference,
                                            const std::complex<double>& motion, const FaceOfPiston& face);
std::vector<Oscillation> second_order_elevations(const std::vector<Oscillation>& first, const FaceOfPiston& face);

// A sum of many oscillations as cubics between times a fortieth of the shortest period apart, up to `end`: 1e-6 of its
// size off, its rate 3e-5. Later, and beyond two million times, the sum itself.
class TabulatedOscillations {
 public:
  TabulatedOscillations(std::vector<Oscillation> terms, double end);
  double value(double t) const;
  double rate(double t) const;
  double end() const { return end_; }

 private:
  // Of the interval that holds t, its number and the share of it; false: none does.
  bool find(double t, std::size_t& interval, double& share) const;
  std::vector<Oscillation> terms_;
  double end_;
  double step_ = 0;
  std::vector<double> value_, rate_;  // the rates times the step
};

}  // namespace spume
