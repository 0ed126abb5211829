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
#include <memory>
#include <utility>
#include <vector>

namespace spume {

class Expression;
class TabulatedOscillations;

// Still water before a piston, and how far from it the elevation is measured.
struct FaceOfPiston {
  double depth = 0, gravity = 0, gauge = 0;
};

// The wavenumber with w^2 = g k tanh(kh), to rounding. All arguments above zero.
double wavenumber(double angular_frequency, double depth, double gravity);

// Height of the waves far from a piston over its stroke, first order: 2 (cosh 2kh - 1) / (sinh 2kh + 2kh) (Biesel).
double piston_transfer(double kh);

// The same of a flap hinged at the bed, over its stroke at the still surface:
// 4 (sinh kh / kh) (kh sinh kh - cosh kh + 1) / (sinh 2kh + 2kh).
double flap_transfer(double kh);

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

// 10 s^3 - 15 s^4 + 6 s^5 with s = t / ramp, 1 from t = ramp on.
double start_share(double t, double ramp);

// How a piston moves into the liquid from its place at t = 0.
class PistonMotion {
 public:
  virtual ~PistonMotion() = default;
  virtual double displacement(double t) const = 0;
  virtual double velocity(double t) const = 0;
  // Of the waves that it makes, above the still surface where the elevation beside the piston is measured; null: none.
  virtual std::shared_ptr<const Expression> elevation(const FaceOfPiston& face) const = 0;
};

// A sum of oscillations times start_share(): velocity and acceleration start from zero. `second`, the way of a motion
// of second order from where it stands at t = 0, grows with the square of that; null: none.
class OscillatingPiston final : public PistonMotion {
 public:
  OscillatingPiston(std::vector<Oscillation> oscillations, double ramp,
                    std::shared_ptr<const TabulatedOscillations> second = nullptr)
      : terms_(std::move(oscillations)), ramp_(ramp), second_(std::move(second)) {}
  double displacement(double t) const override;
  double velocity(double t) const override;
  // By linear theory, the liquid that the piston pushes up before itself included.
  std::shared_ptr<const Expression> elevation(const FaceOfPiston& face) const override;

 private:
  double sum(double t) const;
  double rate(double t) const;
  std::vector<Oscillation> terms_;
  double ramp_;
  std::shared_ptr<const TabulatedOscillations> second_;
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
  std::shared_ptr<const Expression> elevation(const FaceOfPiston&) const override;
  double crest_time() const { return start_; }  // when the crest leaves the piston
  double elevation_beside(double t) const;      // the piston

 private:
  double phase(double t) const;  // kappa (ct - x), by Newton's iteration
  SolitaryWave wave_;
  double start_;
};

}  // namespace spume
