// SPDX-License-Identifier: MIT
#include "spume/scene/wave_absorption.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "spume/scene/option.hpp"
#include "spume/scene/second_order_waves.hpp"
#include "spume/scene/wave_modes.hpp"
#include "wavemakers.hpp"

namespace spume {
namespace {

// They fall as the third power of their number.
constexpr std::size_t decaying_modes = 30;

// Of the tuned law, as a phase: 1 / (w drift). Waves of other frequencies see less of it than a tenth.
constexpr double drift_phase = 0.05;

// -v over e.
std::complex<double> response(const AbsorptionLaw& law, double w) {
  const std::complex<double> s(0, w);
  return law.gain / (1.0 + s * law.smoothing) * (s * law.drift / (1.0 + s * law.drift));
}

// Elevation at the gauge of the waves that a sum of oscillations makes, with the same ramp.
class OscillatingElevation final : public Expression {
 public:
  // X sin(wt + phase) is the real part of X exp(i(wt + phase)) / i, and the elevation i times the transfer of that.
  OscillatingElevation(const std::vector<Oscillation>& motion, double ramp, const FaceOfPiston& face,
                       std::shared_ptr<const TabulatedOscillations> second)
      : ramp_(ramp), second_(std::move(second)) {
    terms_.reserve(motion.size());
    for (const auto& [amplitude, w, phase] : motion) {
      const std::complex<double> transfer = face_transfer(face, w);
      terms_.push_back({amplitude * std::abs(transfer), w, phase + std::arg(transfer)});
    }
  }
  double operator()(double, double, double, double t) const override {
    double sum = 0;
    for (const WaveComponent& term : terms_) sum += term.amplitude * std::cos(term.angular_frequency * t + term.phase);
    const double share = start_share(t, ramp_);
    return share * (second_ == nullptr ? sum : sum + share * second_->value(t));
  }
  std::unique_ptr<Expression> clone() const override { return std::make_unique<OscillatingElevation>(*this); }

 private:
  std::vector<WaveComponent> terms_;
  double ramp_;
  std::shared_ptr<const TabulatedOscillations> second_;
};

class SolitaryElevation final : public Expression {
 public:
  explicit SolitaryElevation(const SolitaryPiston& piston) : piston_(piston) {}
  double operator()(double, double, double, double t) const override { return piston_.elevation_beside(t); }
  std::unique_ptr<Expression> clone() const override { return std::make_unique<SolitaryElevation>(*this); }

 private:
  SolitaryPiston piston_;
};

}  // namespace

std::complex<double> face_transfer(const FaceOfPiston& face, double angular_frequency) {
  std::complex<double> sum = 0;
  for (const WaveMode& mode :
       wave_modes(WavemakerKind::piston, angular_frequency, face.depth, face.gravity, decaying_modes))
    sum += mode.transfer * std::exp(std::complex<double>(0, -1) * mode.wavenumber * face.gauge);
  return sum;
}

AbsorptionLaw long_wave_law(const FaceOfPiston& face) {
  const double unit = std::sqrt(face.depth / face.gravity);
  constexpr double periods = 10;
  const double period = 2 * std::numbers::pi / std::sqrt(std::tanh(1.0));
  return {.gain = 1 / unit, .smoothing = 0.1 * unit, .drift = periods * period * unit};
}

AbsorptionLaw tuned_law(const FaceOfPiston& face, double angular_frequency) {
  const double w = angular_frequency, k = wavenumber(w, face.depth, face.gravity);
  const double travelling = piston_transfer(k * face.depth);
  // Where R = 0. Its delay is that of the smoothing less what the drift leads.
  const std::complex<double> beta = 1.0 / (2 * travelling * std::cos(k * face.gauge) - face_transfer(face, w));
  constexpr double longest = 1.2;  // of a gauge too far from the wall
  const double delay = std::min(-std::arg(beta) + std::atan(drift_phase), longest);
  AbsorptionLaw law{.gain = 1, .smoothing = std::tan(delay) / w, .drift = 1 / (drift_phase * w)};
  law.gain = w * std::abs(beta) / std::abs(response(law, w));
  return law;
}

std::complex<double> reflection(const AbsorptionLaw& law, const FaceOfPiston& face, double angular_frequency) {
  const double w = angular_frequency, k = wavenumber(w, face.depth, face.gravity);
  const std::complex<double> beta = response(law, w) / w;
  return 1.0 - 2.0 * beta * piston_transfer(k * face.depth) * std::cos(k * face.gauge) /
                   (1.0 + beta * face_transfer(face, w));
}

std::shared_ptr<const Expression> OscillatingPiston::elevation(const FaceOfPiston& face) const {
  std::shared_ptr<const TabulatedOscillations> second;
  if (second_ != nullptr)
    second = std::make_shared<TabulatedOscillations>(second_order_elevations(terms_, face), second_->end());
  return std::make_shared<OscillatingElevation>(terms_, ramp_, face, std::move(second));
}

std::shared_ptr<const Expression> SolitaryPiston::elevation(const FaceOfPiston&) const {
  return std::make_shared<SolitaryElevation>(*this);
}

WaveAbsorption wave_absorption(const WavemakerDraft& draft, const Wavemaker& maker, const PistonMotion& motion,
                               const Scene& scene) {
  const FaceOfPiston face = face_of(maker, scene);
  const bool tuned =
      draft.absorption == AbsorptionKind::tuned && maker.angular_frequency > 0 && draft.waves != WaveKind::solitary;
  return {.law = tuned ? tuned_law(face, maker.angular_frequency) : long_wave_law(face),
          .still = maker.bed + maker.still_depth,
          .elevation = draft.waves == WaveKind::none ? nullptr : motion.elevation(face)};
}

std::string describe_absorption(const WaveAbsorption& absorption, WaveKind waves, const Wavemaker& maker,
                                const Scene& scene) {
  const FaceOfPiston face = face_of(maker, scene);
  std::string text = "velocity " + brief(absorption.law.gain) + " times the excess elevation, delay " +
                     brief(absorption.law.smoothing) + ", return " + brief(absorption.law.drift) + "; ";
  const char* after = " % of kh 0.5, 1, 1.5";
  std::array<double, 3> frequencies{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double kh = 0.5 * static_cast<double>(i + 1);
    frequencies[i] = std::sqrt(face.gravity * kh * std::tanh(kh) / face.depth);
  }
  if (const double w = maker.angular_frequency; w > 0 && waves != WaveKind::solitary) {
    after = " % of half, all and twice the frequency of the waves";
    frequencies = {w / 2, w, 2 * w};
  }
  text += "sends back ";
  for (std::size_t i = 0; i < 3; ++i)
    text += (i == 0 ? "" : ", ") + brief(100 * std::abs(reflection(absorption.law, face, frequencies[i])));
  return text + after;
}

}  // namespace spume
