// SPDX-License-Identifier: MIT
// Water waves on a horizontal bed, as wavemakers need them: dispersion, what a piston or a flap makes of its stroke,
// spectra and solitary waves. Depth h, wavenumber k, angular frequency w, wave height H, gravity g.
//
// - Biesel, F. and Suquet, F. (1951), Les appareils generateurs de houle en laboratoire, La Houille Blanche 6.
// - Madsen, O. S. (1971), On the generation of long waves, J. Geophys. Res. 76:8672.
// - Hasselmann, K. et al. (1973), Measurements of wind-wave growth and swell decay (JONSWAP), Dtsch. Hydrogr. Z.
// A8(12).
// - Tromans, P. S., Anaturk, A. R. and Hagemeijer, P. (1991), A new model for the kinematics of large ocean waves
//   (NewWave), Proc. ISOPE 3:64.
// - Goring, D. G. (1978), Tsunamis: the propagation of long waves onto a shelf, Caltech report KH-R-38.
// - Guizien, K. and Barthelemy, E. (2002), Accuracy of solitary wave generation by a piston wave maker, J. Hydraul.
// Res.
//   40:321.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace spume {

// The wavenumber with w^2 = g k tanh(kh), to rounding. All arguments above zero.
double wavenumber(double angular_frequency, double depth, double gravity);

// Height of the waves far from a piston over its stroke, first order: 2 (cosh 2kh - 1) / (sinh 2kh + 2kh) (Biesel).
double piston_transfer(double kh);

// The same of a flap hinged at the bed, over its stroke at the still surface:
// 4 (sinh kh / kh) (kh sinh kh - cosh kh + 1) / (sinh 2kh + 2kh).
double flap_transfer(double kh);

// Amplitude of the motion e2 sin 2wt that a piston S/2 sin wt needs beside it, so that no free second harmonic leaves
// it (Madsen): H^2 / (32 h) (3 cosh kh / sinh^3 kh - 2 S / H). Holds while madsen_number() is below 1.
double piston_second_amplitude(double height, double kh, double depth);
// H (2 pi / k)^2 / h^3 over 8 pi^2 / 3, where the second harmonic of a Stokes wave makes a second crest.
double madsen_number(double height, double wavenumber, double depth);

// A term X sin(w t + phase) of a motion.
struct Oscillation {
  double amplitude = 0, angular_frequency = 0, phase = 0;
};

// A wave a cos(w t - k x + phase).
struct WaveComponent {
  double amplitude = 0, angular_frequency = 0, phase = 0;
};

// JONSWAP density over frequency, with its peak at 1 and an arbitrary factor; gamma 1: Pierson and Moskowitz.
double jonswap(double frequency_over_peak, double gamma);

// `count` waves of a JONSWAP spectrum: one in each of as many equal bands of 0.5 to 3 peak frequencies, at a random
// frequency within it and with a random phase, so that the sum does not repeat. The sum of a^2 / 2 is (height / 4)^2.
// Of the energy of the spectrum 1 % lies above the bands (gamma = 3.3), in waves too short for a tank to resolve.
std::vector<WaveComponent> jonswap_waves(double significant_height, double peak_period, double gamma, std::size_t count,
                                         std::uint64_t seed, std::uint32_t draw);

// The most likely shape of a high crest in such a spectrum (NewWave): amplitudes in proportion to the density, all
// crests at distance x = place at t = time, where linear theory has the sum `amplitude`.
std::vector<WaveComponent> focused_waves(double amplitude, double peak_period, double gamma, std::size_t count,
                                         double place, double time, double depth, double gravity);

// The first-order motion of a piston at x = 0, or at the still surface of a flap by flap_transfer, that makes the
// waves.
std::vector<Oscillation> piston_motion(const std::vector<WaveComponent>& waves, double depth, double gravity,
                                       double (*transfer)(double) = piston_transfer);

// How a piston moves into the liquid from its place at t = 0.
class PistonMotion {
 public:
  virtual ~PistonMotion() = default;
  virtual double displacement(double t) const = 0;
  virtual double velocity(double t) const = 0;
};

// A sum of oscillations, times 10 s^3 - 15 s^4 + 6 s^5 with s = t / ramp up to t = ramp: velocity and acceleration
// start from zero.
class OscillatingPiston final : public PistonMotion {
 public:
  OscillatingPiston(std::vector<Oscillation> oscillations, double ramp)
      : terms_(std::move(oscillations)), ramp_(ramp) {}
  double displacement(double t) const override;
  double velocity(double t) const override;

 private:
  double sum(double t) const;
  double rate(double t) const;
  std::vector<Oscillation> terms_;
  double ramp_;
};

// Rayleigh's solitary wave H sech^2 kappa(ct - x), kappa^2 = 3 H / (4 h^2 (h + H)), c^2 = g (h + H).
struct SolitaryWave {
  SolitaryWave(double wave_height, double water_depth, double gravity);
  double height, depth;
  double speed;
  double decay;  // kappa
};

// The piston that makes it moves at any time with the mean velocity c eta / (h + eta) of the liquid beside it (Goring;
// with Rayleigh's wave, which leaves the least behind it, Guizien and Barthelemy): its place is
// (H / kappa h) tanh kappa(ct - x). It starts where kappa(ct - x) = -5, with sech^2 5 = 2e-4 of its largest speed.
class SolitaryPiston final : public PistonMotion {
 public:
  explicit SolitaryPiston(const SolitaryWave& wave);
  double displacement(double t) const override;
  double velocity(double t) const override;
  double crest_time() const { return start_; }  // when the crest leaves the piston

 private:
  double phase(double t) const;  // kappa (ct - x), by Newton's iteration
  SolitaryWave wave_;
  double start_;
};

}  // namespace spume
