// SPDX-License-Identifier: MIT
#include "spume/scene/second_order_waves.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

using Complex = std::complex<double>;
constexpr Complex i{0, 1};

// Modes that decay in a sum over pairs. As the edge of a wall at the surface is a singular point, what is left out
// falls as one over their number; with half of them it is twice as large, and so taken off. At kh = 4 1 % of the
// amplitude remains.
constexpr std::size_t modes_of_pairs = 40;

// A mode of the potential at the surface with the sign of its frequency.
struct SurfaceMode {
  double w = 0;
  Complex kappa, tanh, sech, potential;
};

// One of two motions whose product is looked at.
struct Factor {
  double w = 0;
  Complex motion;
  std::vector<SurfaceMode> modes;
};

// An elevation i X c has the potential -g X c / w.
Factor factor_of(const FirstOrderMotion& term, std::size_t modes, double gravity, bool conjugate) {
  Factor factor{term.angular_frequency, term.amplitude, {}};
  factor.modes.reserve(modes);
  for (std::size_t j = 0; j < modes; ++j) {
    const WaveMode& mode = term.modes[j];
    factor.modes.push_back(
        {factor.w, mode.wavenumber, mode.tanh, mode.sech, -gravity / factor.w * term.amplitude * mode.transfer});
  }
  if (!conjugate) return factor;
  factor.w = -factor.w;
  factor.motion = std::conj(factor.motion);
  for (SurfaceMode& mode : factor.modes)
    mode = {-mode.w, -std::conj(mode.kappa), -std::conj(mode.tanh), std::conj(mode.sech), std::conj(mode.potential)};
  return factor;
}

// A mode that obeys the surface by itself, of the frequency W.
struct FreeWave {
  double w = 0;
  Complex k, tanh, sech;
};

FreeWave travelling(double w, double depth, double gravity) {
  const double k = wavenumber(w, depth, gravity);
  return {w, k, w * w / (gravity * k), 1 / std::cosh(k * depth)};
}

// Integral of f cosh(k z') over cosh kappa h cosh K h, k = kappa + K or kappa - K, from the sinh and the cosh of kh
// over the same and 1 over it.
Complex moved_by(WavemakerKind kind, const Complex& k, const Complex& sinh, const Complex& cosh, const Complex& one,
                 double depth) {
  // Where a factor has the wavenumber of the free wave: leading terms.
  const bool none = std::abs(k) * depth < 1e-4;
  const Complex whole = none ? one * depth : sinh / k;
  if (kind == WavemakerKind::piston) return whole;
  return whole - (none ? one * depth / 2.0 : (cosh - one) / (k * k * depth));
}

// Integral of f sinh kappa z' sinh K z' over the depth, z' from the bed, over cosh kappa h cosh K h.
Complex overlap(WavemakerKind kind, const SurfaceMode& mode, const FreeWave& free, double depth) {
  const Complex product = mode.tanh * free.tanh, one = mode.sech * free.sech;
  return 0.5 * (moved_by(kind, mode.kappa + free.k, mode.tanh + free.tanh, 1.0 + product, one, depth) -
                moved_by(kind, mode.kappa - free.k, mode.tanh - free.tanh, 1.0 - product, one, depth));
}

// Integral of f cosh K z' over cosh K h.
Complex moved(WavemakerKind kind, const FreeWave& free, double depth) {
  const Complex whole = free.tanh / free.k;
  return kind == WavemakerKind::piston ? whole : whole - (1.0 - free.sech) / (free.k * free.k * depth);
}

// Q of two modes in both orders.
Complex driven(const SurfaceMode& a, const SurfaceMode& b, double gravity) {
  const auto inner = [&](const SurfaceMode& m) {
    return gravity * m.kappa * m.kappa - m.w * m.w * m.w * m.w / gravity;
  };
  const double w = a.w + b.w;
  const Complex squares = w * (a.kappa * b.kappa - a.w * a.w * b.w * b.w / (gravity * gravity));
  return 0.5 * i * a.potential * b.potential * (2.0 * squares + (a.w * inner(b) + b.w * inner(a)) / gravity);
}

// Of phi_x that the motion `a` asks for beside its own, where `b` moves the liquid.
Complex asked_by_wall(WavemakerKind kind, const Factor& a, const Factor& b, const FreeWave& free, double depth) {
  Complex sum = 0;
  for (const SurfaceMode& mode : b.modes)
    sum += mode.potential * (mode.kappa * mode.tanh - free.k * mode.kappa * overlap(kind, mode, free, depth));
  return 0.5 * a.motion * sum;
}

// Of phi_x at the wall, projected on a free wave: that of the bound waves less what the wall asks for.
Complex left_at_wall(WavemakerKind kind, const Factor& first, const Factor& second, const FreeWave& free, double depth,
                     double gravity) {
  Complex bound = 0;
  for (const SurfaceMode& m : first.modes)
    for (const SurfaceMode& n : second.modes) {
      const Complex kappa = m.kappa + n.kappa;
      bound -= i * kappa * driven(m, n, gravity) / (gravity * (kappa * kappa - free.k * free.k));
    }
  return bound - asked_by_wall(kind, first, second, free, depth) - asked_by_wall(kind, second, first, free, depth);
}

// A square has no second order of its factors.
double orders(const FirstOrderMotion& a, const FirstOrderMotion& b) {
  return &a == &b ? 0.5 : 1;
}

// With so many modes, the one that travels among them.
Complex amplitude_with(std::size_t modes, WavemakerKind kind, const FirstOrderMotion& a, const FirstOrderMotion& b,
                       bool difference, double depth, double gravity) {
  const Factor first = factor_of(a, modes, gravity, false), second = factor_of(b, modes, gravity, difference);
  const FreeWave free = travelling(first.w + second.w, depth, gravity);
  return orders(a, b) * left_at_wall(kind, first, second, free, depth, gravity) /
         (i * free.w * moved(kind, free, depth));
}

// -g times the elevation of the bound wave of two modes: of its potential, and of the squares in Bernoulli's equation.
Complex bound_head(const SurfaceMode& m, const SurfaceMode& n, double depth, double gravity) {
  const Complex kappa = m.kappa + n.kappa;
  const double w = m.w + n.w;
  const Complex potential = driven(m, n, gravity) / (gravity * kappa * std::tanh(kappa * depth) - w * w);
  const Complex squares = -m.kappa * n.kappa + m.w * m.w * n.w * n.w / (gravity * gravity) +
                          m.w * n.w * (m.w * m.w + n.w * n.w) / (gravity * gravity);
  return i * w * potential + 0.5 * m.potential * n.potential * squares;
}

// Calls use(a, b, difference) for all sums and differences of the terms: use() returns what belongs to exp(iWt).
template <class Use>
std::vector<Oscillation> over_pairs(const std::vector<FirstOrderMotion>& terms, Use&& use) {
  const std::size_t n = terms.size();
  std::vector<Oscillation> found(n * n);  // row a: the sums with b >= a, the differences with b < a
  parallel_for(n * n, [&](std::size_t pair) {
    const FirstOrderMotion *a = &terms[pair / n], *b = &terms[pair % n];
    const bool difference = pair % n < pair / n;
    if (difference && a->angular_frequency < b->angular_frequency) std::swap(a, b);
    const double w = a->angular_frequency + (difference ? -1 : 1) * b->angular_frequency;
    if (w == 0) return;
    const Complex x = use(*a, *b, difference);
    found[pair] = {std::abs(x), w, std::arg(x) + std::numbers::pi / 2};
  });
  std::erase_if(found, [](const Oscillation& term) { return term.amplitude == 0; });
  return found;
}

std::vector<FirstOrderMotion> first_order(const std::vector<Oscillation>& terms, WavemakerKind kind, double depth,
                                          double gravity, std::size_t decaying) {
  std::vector<FirstOrderMotion> motions;
  motions.reserve(terms.size());
  for (const Oscillation& term : terms) motions.emplace_back(term, kind, depth, gravity, decaying);
  return motions;
}

}  // namespace

FirstOrderMotion::FirstOrderMotion(const Oscillation& term, WavemakerKind kind, double depth, double gravity,
                                   std::size_t decaying)
    : angular_frequency(term.angular_frequency),
      amplitude(-i * std::polar(term.amplitude, term.phase)),
      modes(wave_modes(kind, term.angular_frequency, depth, gravity, decaying)) {}

std::complex<double> second_order_amplitude(WavemakerKind kind, const FirstOrderMotion& a, const FirstOrderMotion& b,
                                            bool difference, double depth, double gravity) {
  const std::size_t decaying = std::min(a.modes.size(), b.modes.size()) - 1;
  const Complex all = amplitude_with(1 + decaying, kind, a, b, difference, depth, gravity);
  if (decaying % 2 != 0 || decaying == 0) return all;
  return 2.0 * all - amplitude_with(1 + decaying / 2, kind, a, b, difference, depth, gravity);
}

std::vector<Oscillation> second_order_motion(const std::vector<Oscillation>& first, WavemakerKind kind, double depth,
                                             double gravity) {
  return over_pairs(first_order(first, kind, depth, gravity, modes_of_pairs),
                    [&](const FirstOrderMotion& a, const FirstOrderMotion& b, bool difference) {
                      return second_order_amplitude(kind, a, b, difference, depth, gravity);
                    });
}

std::complex<double> second_order_elevation(const FirstOrderMotion& a, const FirstOrderMotion& b, bool difference,
                                            const std::complex<double>& motion, const FaceOfPiston& face) {
  constexpr WavemakerKind kind = WavemakerKind::piston;
  const double depth = face.depth, gravity = face.gravity;
  const std::size_t modes = std::min(a.modes.size(), b.modes.size());
  const Factor first = factor_of(a, modes, gravity, false), second = factor_of(b, modes, gravity, difference);
  const double w = first.w + second.w;
  Complex head = 0;
  for (const SurfaceMode& m : first.modes)
    for (const SurfaceMode& n : second.modes)
      head += bound_head(m, n, depth, gravity) * std::exp(-i * (m.kappa + n.kappa) * face.gauge);
  // The gauge moves with the wall.
  const auto carried = [&](const Complex& x, const Factor& waves) {
    for (const SurfaceMode& mode : waves.modes)
      head += 0.5 * x * mode.kappa * mode.w * mode.potential * std::exp(-i * mode.kappa * face.gauge);
  };
  carried(first.motion, second);
  carried(second.motion, first);
  head *= orders(a, b);
  for (std::size_t j = 1; j < modes; ++j) {
    const double k = decaying_wavenumber(w, depth, gravity, j);
    const FreeWave free{w, -i * k, w * w / (gravity * -i * k), 1 / std::cos(k * depth)};
    const Complex along = i * w * motion * moved(kind, free, depth) -
                          orders(a, b) * left_at_wall(kind, first, second, free, depth, gravity);
    const Complex norm = 0.5 * (depth * free.sech * free.sech + free.tanh / free.k);
    head += i * w * along / (-i * free.k * norm) * std::exp(-i * free.k * face.gauge);
  }
  return -head / gravity;
}

std::vector<Oscillation> second_order_elevations(const std::vector<Oscillation>& first, const FaceOfPiston& face) {
  constexpr std::size_t decaying = 8;  // the gauge is off the edge, where they matter most
  return over_pairs(first_order(first, WavemakerKind::piston, face.depth, face.gravity, decaying),
                    [&](const FirstOrderMotion& a, const FirstOrderMotion& b, bool difference) {
                      const Complex motion =
                          second_order_amplitude(WavemakerKind::piston, a, b, difference, face.depth, face.gravity);
                      return second_order_elevation(a, b, difference, motion, face);
                    });
}

TabulatedOscillations::TabulatedOscillations(std::vector<Oscillation> terms, double end)
    : terms_(std::move(terms)), end_(end) {
  constexpr double per_period = 40, most = 2e6;
  constexpr std::size_t block = 64;  // times between phases that are found anew
  double fastest = 0;
  for (const Oscillation& term : terms_) fastest = std::max(fastest, term.angular_frequency);
  if (fastest == 0) return;
  step_ = 2 * std::numbers::pi / (per_period * fastest);
  const auto times = static_cast<std::size_t>(std::min(std::ceil(end / step_), most)) + 2;
  value_.resize(times);
  rate_.resize(times);
  parallel_blocks(times, block, [&](std::size_t, std::size_t begin, std::size_t stop) {
    for (const Oscillation& term : terms_) {
      const double w = term.angular_frequency;
      Complex now = std::polar(term.amplitude, w * step_ * static_cast<double>(begin) + term.phase);
      const Complex turn = std::polar(1.0, w * step_);
      for (std::size_t k = begin; k < stop; ++k) {
        value_[k] += now.imag();
        rate_[k] += w * step_ * now.real();
        now = {now.real() * turn.real() - now.imag() * turn.imag(),
               now.real() * turn.imag() + now.imag() * turn.real()};
      }
    }
  });
}

bool TabulatedOscillations::find(double t, std::size_t& interval, double& share) const {
  if (value_.empty() || !(t >= 0)) return false;
  const double place = t / step_;
  if (!(place < static_cast<double>(value_.size() - 1))) return false;
  interval = static_cast<std::size_t>(place);
  share = place - static_cast<double>(interval);
  return true;
}

double TabulatedOscillations::value(double t) const {
  std::size_t k = 0;
  double s = 0;
  if (!find(t, k, s)) {
    double sum = 0;
    for (const Oscillation& term : terms_) sum += term.amplitude * std::sin(term.angular_frequency * t + term.phase);
    return sum;
  }
  const double r = 1 - s;
  return r * r * (1 + 2 * s) * value_[k] + s * s * (3 - 2 * s) * value_[k + 1] + s * r * r * rate_[k] -
         s * s * r * rate_[k + 1];
}

double TabulatedOscillations::rate(double t) const {
  std::size_t k = 0;
  double s = 0;
  if (!find(t, k, s)) {
    double sum = 0;
    for (const Oscillation& term : terms_)
      sum += term.amplitude * term.angular_frequency * std::cos(term.angular_frequency * t + term.phase);
    return sum;
  }
  return (6 * s * (1 - s) * (value_[k + 1] - value_[k]) + (1 - s) * (1 - 3 * s) * rate_[k] +
          s * (3 * s - 2) * rate_[k + 1]) /
         step_;
}

}  // namespace spume
