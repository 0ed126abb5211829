// SPDX-License-Identifier: MIT
// Theory of waves and wavemakers against tabulated values, quadrature and finite differences.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "spume/scene/second_order_waves.hpp"
#include "spume/scene/wave_theory.hpp"

namespace spume {
namespace {

using std::numbers::pi;

// Rows of a reference of the case.
std::vector<std::vector<double>> reference(const std::string& name) {
  std::ifstream file(SPUME_SOURCE_DIR "/cases/wave_flume/reference/" + name);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || std::isdigit(static_cast<unsigned char>(line[0])) == 0) continue;
    std::istringstream entries(line);
    rows.emplace_back();
    for (std::string entry; std::getline(entries, entry, ',');) rows.back().push_back(std::stod(entry));
  }
  EXPECT_GT(rows.size(), 5U) << name;
  return rows;
}

TEST(WaveTheory, DispersionHoldsFromLongToShortWaves) {
  const double depth = 0.7, gravity = 9.81;
  for (double kh = 1e-4; kh < 1e3; kh *= 1.7) {
    const double k = kh / depth, w = std::sqrt(gravity * k * std::tanh(kh));
    EXPECT_NEAR(wavenumber(w, depth, gravity) / k, 1, 1e-14) << kh;
  }
}

TEST(WaveTheory, TransferOfThePistonIsThatOfTheReference) {
  for (const auto& row : reference("piston.csv")) EXPECT_NEAR(piston_transfer(row[0]), row[1], 1e-8) << row[0];
  EXPECT_NEAR(piston_transfer(1e-9) / 1e-9, 1, 1e-8);
  EXPECT_DOUBLE_EQ(piston_transfer(2000), 2);
}

TEST(WaveTheory, TransferOfTheFlapIsThatOfTheReference) {
  for (const auto& row : reference("flap.csv")) EXPECT_NEAR(flap_transfer(row[0]), row[1], 1e-8) << row[0];
  EXPECT_NEAR(flap_transfer(1e-3) / 1e-3, 0.5, 1e-6);
  EXPECT_NEAR(flap_transfer(2000), 2 - 2.0 / 2000, 1e-12);
}

// A motion of the wall, uniform or in proportion to the height above the hinge, projected on the mode cosh k(z + h) of
// the travelling wave.
TEST(WaveTheory, TransferIsTheProjectionOnTheTravellingMode) {
  for (const double k : {0.2, 1.0, 3.0}) {
    double uniform = 0, turning = 0, mode = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double c = std::cosh(k * (i + 0.5) / n);
      uniform += c / n;
      turning += (i + 0.5) / n * c / n;
      mode += c * c / n;
    }
    // w X cos wt = k A mode amplitude at the wall, and g a = w A cosh kh at the surface.
    EXPECT_NEAR(piston_transfer(k), std::tanh(k) * uniform / mode * std::cosh(k), 1e-7);
    EXPECT_NEAR(flap_transfer(k), std::tanh(k) * turning / mode * std::cosh(k), 1e-7);
  }
}

// Madsen's, which lets the second harmonic of a long wave move the liquid as a whole.
TEST(WaveTheory, SecondOrderMotionOfLongWavesIsThatOfTheReference) {
  for (const auto& row : reference("piston.csv")) {
    if (row[0] > 0.45) continue;
    const double height = 0.3, depth = 2, w = std::sqrt(row[0] / depth * std::tanh(row[0]));
    const auto second = second_order_motion({{height / 2 / row[1], w, 0}}, WavemakerKind::piston, depth, 1);
    ASSERT_EQ(second.size(), 1U);
    EXPECT_DOUBLE_EQ(second[0].angular_frequency, 2 * w);
    EXPECT_NEAR(std::remainder(second[0].phase, 2 * pi), 0, 0.01);
    EXPECT_NEAR(second[0].amplitude * depth / (height * height) / row[2], 1, std::pow(row[0], 4)) << row[0];
  }
}

TEST(WaveTheory, MadsensNumberIsOneWhereTheSecondHarmonicMakesASecondCrest) {
  EXPECT_DOUBLE_EQ(madsen_number(8 * pi * pi / 3 * 2 * 2 * 2 / (5 * 5), 2 * pi / 5, 2), 1);
}

TEST(WaveTheory, SolitaryWavesAreThoseOfTheReference) {
  for (const auto& row : reference("solitary.csv")) {
    const SolitaryWave wave(row[0], 1, 1);
    EXPECT_NEAR(wave.speed, row[2], 1e-6);
    EXPECT_NEAR(std::acosh(std::sqrt(2.0)) / wave.decay, row[5], 1e-4);
  }
}

// Velocities are the rates of the displacements: central differences of step e err by e^2 / 6 of the third derivative.
void expect_consistent(const PistonMotion& motion, double end, double frequency, double largest) {
  const double step = 1e-4 / frequency;
  for (int i = 1; i <= 400; ++i) {
    const double t = end * i / 400;
    const double rate = (motion.displacement(t + step) - motion.displacement(t - step)) / (2 * step);
    EXPECT_NEAR(motion.velocity(t), rate, 1e-6 * largest) << t;
  }
  EXPECT_NEAR(motion.displacement(0), 0, 1e-12);
}

TEST(WaveTheory, VelocitiesAreRatesOfDisplacements) {
  const double w = 2.5;
  const std::vector<Oscillation> regular{{0.1, w, 0}, {0.01, 2 * w, 0}};
  for (const double ramp : {0.0, 5.0}) expect_consistent(OscillatingPiston(regular, ramp), 12, w, 0.25);
  expect_consistent(OscillatingPiston(piston_motion(jonswap_waves(0.1, 2 * pi / w, 3.3, 40, 7, 0), 0.8, 9.81), 5), 30,
                    w, 0.2);
  expect_consistent(
      OscillatingPiston(piston_motion(focused_waves(0.1, 2 * pi / w, 3.3, 40, 6, 15, 0.8, 9.81), 0.8, 9.81), 5), 30, w,
      0.2);
  const std::vector<Oscillation> low{{0.02, 0.3 * w, 1}, {0.01, 2 * w, 2}};
  for (const double ramp : {0.0, 5.0})
    expect_consistent(OscillatingPiston(regular, ramp, std::make_shared<TabulatedOscillations>(low, 9)), 12, w, 0.25);
  const SolitaryWave wave(0.3, 1, 1);
  expect_consistent(SolitaryPiston(wave), 40, wave.decay * wave.speed, 0.26);
}

TEST(WaveTheory, TheMotionStartsSmoothly) {
  const OscillatingPiston piston({{0.1, 2.5, 0.7}}, 5);
  EXPECT_EQ(piston.velocity(0), 0);
  EXPECT_NEAR(piston.velocity(1e-3), 0, 30 * 2e-4 * 2e-4 / 5 * 0.1 * 1.01);  // 30 s^2 / ramp of the displacement
  EXPECT_NEAR(piston.displacement(5), 0.1 * std::sin(2.5 * 5 + 0.7), 1e-15);
  EXPECT_NEAR(piston.velocity(5), 0.25 * std::cos(2.5 * 5 + 0.7), 1e-15);
}

TEST(WaveTheory, ThePistonOfASolitaryWaveFollowsTheLiquidBesideIt) {
  const SolitaryWave wave(0.3, 0.5, 9.81);
  const SolitaryPiston piston(wave);
  for (double t = 0; t < 3; t += 0.1) {
    const double sech =
        1 / std::cosh(wave.decay * (wave.speed * (t - piston.crest_time()) -
                                    (piston.displacement(t) - piston.displacement(piston.crest_time()))));
    const double eta = 0.3 * sech * sech;
    EXPECT_NEAR(piston.velocity(t), wave.speed * eta / (0.5 + eta), 1e-12) << t;
  }
  // What it pushes aside is the wave: 2 H / kappa. The start leaves out 1 - tanh 5 = 9e-5 of the half of it.
  EXPECT_NEAR(piston.displacement(20) * 0.5 / (2 * 0.3 / wave.decay), 1, 5e-5);
  EXPECT_LT(piston.velocity(0), 3e-4 * wave.speed * 0.3 / 0.8);
}

TEST(WaveTheory, SpectraHaveTheirHeightAndTheirPeak) {
  // Pierson and Moskowitz: the integral of f^-5 exp(-1.25 f^-4) is 1/5.
  EXPECT_DOUBLE_EQ(jonswap(1, 1), std::exp(-1.25));
  EXPECT_GT(jonswap(1, 3.3), std::max(jonswap(0.98, 3.3), jonswap(1.02, 3.3)));
  EXPECT_NEAR(jonswap(1, 3.3) / jonswap(1, 1), 3.3, 1e-12);
  double integral = 0;
  for (int i = 0; i < 100000; ++i) integral += jonswap(0.2 + 1e-3 * (i + 0.5), 1) * 1e-3;
  EXPECT_NEAR(integral, 0.2, 1e-5);

  const auto waves = jonswap_waves(0.2, 2, 3.3, 100, 1, 0), others = jonswap_waves(0.2, 2, 3.3, 100, 1, 1);
  double energy = 0, mean = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    energy += waves[i].amplitude * waves[i].amplitude / 2;
    mean += waves[i].phase / 100;
    const double f = waves[i].angular_frequency / (2 * pi) * 2;
    EXPECT_GE(f, 0.5 + 0.025 * static_cast<double>(i));
    EXPECT_LT(f, 0.5 + 0.025 * static_cast<double>(i + 1));
    EXPECT_NE(waves[i].phase, others[i].phase);
  }
  EXPECT_NEAR(energy, 0.05 * 0.05, 1e-16);
  EXPECT_NEAR(mean, pi, 4 * 2 * pi / std::sqrt(12.0 * 100));  // four standard deviations
}

TEST(WaveTheory, CrestsMeetAtTheFocus) {
  const double place = 7, time = 20, depth = 0.8, gravity = 9.81;
  const auto waves = focused_waves(0.1, 2, 3.3, 60, place, time, depth, gravity);
  const auto elevation = [&](double x, double t) {
    double sum = 0;
    for (const auto& [a, w, phase] : waves) sum += a * std::cos(w * t - wavenumber(w, depth, gravity) * x + phase);
    return sum;
  };
  EXPECT_NEAR(elevation(place, time), 0.1, 1e-12);
  for (const double other : {-8.0, -3.0, 0.5, 6.0}) {
    EXPECT_LT(elevation(place, time + other), 0.09);
    EXPECT_LT(elevation(place + other, time), 0.09);
  }
}

}  // namespace
}  // namespace spume
