// SPDX-License-Identifier: MIT
#include "spume/scene/wave_theory.hpp"

#include <cmath>
#include <numbers>

#include "spume/core/random.hpp"
#include "spume/scene/second_order_waves.hpp"

namespace spume {
namespace {

using std::numbers::pi;

constexpr double lowest_frequency = 0.5, highest_frequency = 3;  // of the peak
constexpr double start_phase = 5;                                // of the piston of a solitary wave

double frequency_in_band(std::size_t band, std::size_t count, double within) {
  return lowest_frequency +
         (highest_frequency - lowest_frequency) * (static_cast<double>(band) + within) / static_cast<double>(count);
}

}  // namespace

double wavenumber(double angular_frequency, double depth, double gravity) {
  // q tanh q = y. The start is 10 % off at most, between sqrt(y), exact for long waves, and y, for short ones; every
  // step of Newton's doubles the digits.
  const double y = angular_frequency * angular_frequency * depth / gravity;
  double q = y / std::sqrt(std::tanh(y));
  for (int step = 0; step < 8; ++step) {
    const double t = std::tanh(q), next = q - (q * t - y) / (t + q * (1 - t * t));
    if (next == q) break;
    q = next;
  }
  return q / depth;
}

double piston_transfer(double kh) {
  // Both sides times exp(-2kh): no overflow for short waves, no cancellation for long ones.
  const double e = std::exp(-2 * kh), less = -std::expm1(-2 * kh);
  return 2 * less * less / (-std::expm1(-4 * kh) + 4 * kh * e);
}

double flap_transfer(double kh) {
  // Both sides times 2 exp(-2kh).
  const double e = std::exp(-2 * kh), less = -std::expm1(-2 * kh);
  return 2 * less / kh * (kh * less - 1 - e + 2 * std::exp(-kh)) / (-std::expm1(-4 * kh) + 4 * kh * e);
}

double madsen_number(double height, double wavenumber, double depth) {
  const double length = 2 * pi / wavenumber;
  return height * length * length / (depth * depth * depth) / (8 * pi * pi / 3);
}

double jonswap(double frequency_over_peak, double gamma) {
  const double f = frequency_over_peak, width = f <= 1 ? 0.07 : 0.09;
  const double peak = std::exp(-(f - 1) * (f - 1) / (2 * width * width));
  return std::pow(f, -5) * std::exp(-1.25 * std::pow(f, -4)) * std::pow(gamma, peak);
}

std::vector<WaveComponent> jonswap_waves(double significant_height, double peak_period, double gamma, std::size_t count,
                                         std::uint64_t seed, std::uint32_t draw) {
  std::vector<WaveComponent> waves(count);
  double energy = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto random = random_uniform(seed, RandomPurpose::wave_component, i, draw, 0);
    const double f = frequency_in_band(i, count, random[0]), density = jonswap(f, gamma);
    waves[i] = {std::sqrt(density), 2 * pi * f / peak_period, 2 * pi * random[1]};
    energy += density / 2;
  }
  const double factor = significant_height / 4 / std::sqrt(energy);
  for (WaveComponent& wave : waves) wave.amplitude *= factor;
  return waves;
}

std::vector<WaveComponent> focused_waves(double amplitude, double peak_period, double gamma, std::size_t count,
                                         double place, double time, double depth, double gravity) {
  std::vector<WaveComponent> waves(count);
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double f = frequency_in_band(i, count, 0.5), w = 2 * pi * f / peak_period;
    waves[i] = {jonswap(f, gamma), w, wavenumber(w, depth, gravity) * place - w * time};
    sum += waves[i].amplitude;
  }
  for (WaveComponent& wave : waves) wave.amplitude *= amplitude / sum;
  return waves;
}

std::vector<Oscillation> piston_motion(const std::vector<WaveComponent>& waves, double depth, double gravity,
                                       double (*transfer)(double)) {
  std::vector<Oscillation> motion;
  motion.reserve(waves.size());
  for (const auto& [amplitude, w, phase] : waves)
    motion.push_back({amplitude / transfer(wavenumber(w, depth, gravity) * depth), w, phase});
  return motion;
}

double OscillatingPiston::sum(double t) const {
  double x = 0;
  for (const Oscillation& term : terms_) x += term.amplitude * std::sin(term.angular_frequency * t + term.phase);
  return x;
}

double OscillatingPiston::rate(double t) const {
  double v = 0;
  for (const Oscillation& term : terms_)
    v += term.amplitude * term.angular_frequency * std::cos(term.angular_frequency * t + term.phase);
  return v;
}

double start_share(double t, double ramp) {
  if (!(t < ramp)) return 1;
  const double s = t / ramp;
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

double OscillatingPiston::displacement(double t) const {
  const double share = start_share(t, ramp_), first = ramp_ == 0 ? sum(t) - sum(0) : share * sum(t);
  return second_ == nullptr ? first : first + share * share * (second_->value(t) - second_->value(0));
}

double OscillatingPiston::velocity(double t) const {
  const double s = ramp_ == 0 ? 1 : t / ramp_;
  if (s >= 1) return rate(t) + (second_ == nullptr ? 0 : second_->rate(t));
  const double share = start_share(t, ramp_), growth = 30 * s * s * (1 - s) * (1 - s) / ramp_;
  const double first = share * rate(t) + growth * sum(t);
  if (second_ == nullptr) return first;
  return first + share * (share * second_->rate(t) + 2 * growth * (second_->value(t) - second_->value(0)));
}

SolitaryWave::SolitaryWave(double wave_height, double water_depth, double gravity)
    : height(wave_height),
      depth(water_depth),
      speed(std::sqrt(gravity * (water_depth + wave_height))),
      decay(std::sqrt(3 * wave_height / (4 * water_depth * water_depth * (water_depth + wave_height)))) {}

SolitaryPiston::SolitaryPiston(const SolitaryWave& wave)
    : wave_(wave),
      start_((start_phase + wave.height / wave.depth * std::tanh(start_phase)) / (wave.decay * wave.speed)) {}

double SolitaryPiston::phase(double t) const {
  // q + (H / h) tanh q = kappa c (t - t_crest): rising, with a slope between 1 and 1 + H / h.
  const double wanted = wave_.decay * wave_.speed * (t - start_), ratio = wave_.height / wave_.depth;
  double q = wanted / (1 + (std::abs(wanted) < 1 ? ratio : 0));
  for (int step = 0; step < 50; ++step) {
    const double th = std::tanh(q), change = (q + ratio * th - wanted) / (1 + ratio * (1 - th * th));
    q -= change;
    if (std::abs(change) < 1e-15 * (1 + std::abs(q))) break;
  }
  return q;
}

double SolitaryPiston::displacement(double t) const {
  return wave_.height / (wave_.decay * wave_.depth) * (std::tanh(phase(t)) + std::tanh(start_phase));
}

double SolitaryPiston::elevation_beside(double t) const {
  const double th = std::tanh(phase(t));
  return wave_.height * (1 - th * th);
}

double SolitaryPiston::velocity(double t) const {
  const double above = elevation_beside(t);
  return wave_.speed * above / (wave_.depth + above);
}

}  // namespace spume
