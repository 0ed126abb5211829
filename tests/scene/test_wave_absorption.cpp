// SPDX-License-Identifier: MIT
// Modes before a wavemaker, and how much an absorbing piston sends back.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "helpers.hpp"
#include "spume/scene/wave_absorption.hpp"
#include "spume/scene/wave_modes.hpp"

namespace spume {
namespace {

using Complex = std::complex<double>;
constexpr Complex imaginary{0, 1};
const FaceOfPiston face{.depth = 0.8, .gravity = 9.81, .gauge = 0.03};

double frequency_at(double kh) {
  return std::sqrt(face.gravity / face.depth * kh * std::tanh(kh));
}

TEST(WaveModes, SatisfyTheDispersionRelation) {
  for (const double w : {0.3, 2.0, 9.0})
    for (const WaveMode& mode : wave_modes(WavemakerKind::piston, w, 0.8, 9.81, 12)) {
      const Complex q = mode.wavenumber * 0.8;
      EXPECT_LT(std::abs(9.81 * mode.wavenumber * std::tanh(q) - w * w), 1e-10 * w * w + 1e-12);
      EXPECT_LT(std::abs(mode.tanh - std::tanh(q)), 1e-10 * std::abs(mode.tanh));
      EXPECT_LT(std::abs(mode.sech - 1.0 / std::cosh(q)), 1e-10);
    }
}

// Together the modes have the velocity of the wall: what many of them leave at mid-depth falls as one over their
// number.
TEST(WaveModes, SumToTheMotionOfTheWall) {
  for (const auto kind : {WavemakerKind::piston, WavemakerKind::flap})
    for (const double kh : {0.3, 1.0, 3.0}) {
      const double w = frequency_at(kh), h = face.depth;
      for (const double share : {0.3, 0.5, 0.8}) {
        Complex velocity = 0;
        for (const WaveMode& mode : wave_modes(kind, w, h, face.gravity, 400)) {
          const Complex q = mode.wavenumber * h;
          // Elevation i c has the potential -g c / w at the surface.
          velocity +=
              -imaginary * mode.wavenumber * (-face.gravity / w * mode.transfer) * std::cosh(share * q) * mode.sech;
        }
        EXPECT_LT(std::abs(velocity / (imaginary * w) - (kind == WavemakerKind::piston ? 1 : share)), 3e-3)
            << kh << " " << share;
      }
    }
}

TEST(WaveModes, TheOneThatTravelsHasTheHeightOfBiesel) {
  for (const double kh : {0.1, 1.0, 5.0, 800.0}) {
    EXPECT_NEAR(wave_modes(WavemakerKind::piston, frequency_at(kh), face.depth, face.gravity, 0)[0].transfer.real(),
                piston_transfer(kh), 1e-12);
    EXPECT_NEAR(wave_modes(WavemakerKind::flap, frequency_at(kh), face.depth, face.gravity, 0)[0].transfer.real(),
                flap_transfer(kh), 1e-12);
  }
}

TEST(WaveAbsorption, ATunedPistonSendsNothingBackOfItsWaves) {
  for (const double kh : {0.2, 0.5, 1.0, 1.5, 2.0}) {
    const AbsorptionLaw law = tuned_law(face, frequency_at(kh));
    EXPECT_LT(std::abs(reflection(law, face, frequency_at(kh))), 1e-12) << kh;
    EXPECT_GT(law.smoothing, 0);
    // Half the frequency: the return of the wall and the delay are those of other waves.
    EXPECT_LT(std::abs(reflection(law, face, frequency_at(kh) / 2)), 0.3) << kh;
  }
}

// Without the modes that decay, delay and return, R = (1 - q) / (1 + q), q = c sqrt(g/h) / w.
TEST(WaveAbsorption, TheLongWaveLawIsThatOfShallowWater) {
  for (const double kh : {0.02, 0.05}) {
    const double w = frequency_at(kh);
    AbsorptionLaw law = long_wave_law({1e-6 + face.depth, face.gravity, 0});
    EXPECT_NEAR(law.gain, std::sqrt(face.gravity / face.depth), 1e-4);
    law.smoothing = 0;
    law.drift = 1e9;
    const double q = piston_transfer(kh) * law.gain / w;
    EXPECT_NEAR(std::abs(reflection(law, {face.depth, face.gravity, 0}, w)), std::abs((1 - q) / (1 + q)), kh * kh / 5);
  }
  // Still a wall: all of the wave.
  EXPECT_NEAR(std::abs(reflection({0, 1, 1}, face, frequency_at(1))), 1, 1e-15);
}

// The elevation that a piston measures, the velocity that it answers with and the waves that leave it, step by step in
// time: the reflection is that of the formula. The liquid before it is linear: what the piston radiates is found from
// its velocity at the frequency of the waves, as a phasor of the last period.
TEST(WaveAbsorption, ReflectionIsThatOfTheLoopInTime) {
  const double w = frequency_at(1.0), k = wavenumber(w, face.depth, face.gravity), c = piston_transfer(k * face.depth);
  const AbsorptionLaw law = long_wave_law(face);
  const Complex transfer = face_transfer(face, w);
  Complex velocity = 0;
  constexpr int steps = 2000;
  const double dt = 2 * std::numbers::pi / w / steps;
  for (int round = 0; round < 40; ++round) {
    const Complex elevation = 2 * std::cos(k * face.gauge) + velocity / w * transfer;
    double u = 0, x = 0;
    Complex phasor = 0;
    constexpr int periods = 60;
    for (int n = 0; n < periods * steps; ++n) {
      const double e = std::real(elevation * std::exp(imaginary * (w * n * dt)));
      u += dt / law.smoothing * (-law.gain * e - u);
      const double v = u - x / law.drift;
      x += dt * v;
      if (n >= (periods - 1) * steps) phasor += 2.0 / steps * v * std::exp(-imaginary * (w * n * dt));
    }
    velocity += 0.5 * (phasor - velocity);
  }
  const Complex expected = reflection(law, face, w);
  EXPECT_LT(std::abs(1.0 + c * velocity / w - expected), 0.005);
  EXPECT_GT(std::abs(expected), 0.05);
}

TEST(WaveAbsorption, TheFaceSeesTheWaveThatItMakesAndWhatItPushesUp) {
  const double w = frequency_at(1.2), k = wavenumber(w, face.depth, face.gravity);
  const OscillatingPiston piston({{0.1, w, 0.3}}, 0);
  FaceOfPiston far = face;
  far.gauge = 20 * face.depth;
  const auto near = piston.elevation(face), away = piston.elevation(far);
  double most = 0;
  for (int n = 0; n < 1000; ++n) {
    const double t = 0.005 * n;
    EXPECT_NEAR((*away)(0, 0, 0, t), 0.1 * piston_transfer(k * face.depth) * std::cos(w * t + 0.3 - k * far.gauge),
                1e-9);
    most = std::max(most, (*near)(0, 0, 0, t));
  }
  EXPECT_NEAR(most, 0.1 * std::abs(face_transfer(face, w)), 1e-4 * most);
  EXPECT_GT(most, 1.005 * 0.1 * piston_transfer(k * face.depth));
}

}  // namespace
}  // namespace spume
