// SPDX-License-Identifier: MIT
// The motion of second order against the wall condition by quadrature and the mass that a group of waves carries.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "spume/scene/second_order_waves.hpp"

namespace spume {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;
constexpr Complex i{0, 1};
constexpr auto piston = WavemakerKind::piston, flap = WavemakerKind::flap;

double transfer(WavemakerKind kind, double kh) {
  return kind == piston ? piston_transfer(kh) : flap_transfer(kh);
}

// The first-order motion for a wave of this amplitude, depth and gravity 1.
FirstOrderMotion motion(WavemakerKind kind, double amplitude, double w, double phase, std::size_t decaying) {
  return {{amplitude / transfer(kind, wavenumber(w, 1, 1)), w, phase}, kind, 1, 1, decaying};
}

double frequency(double kh) {
  return std::sqrt(kh * std::tanh(kh));
}

// A mode of the potential with the factor exp(i(wt - kappa x)) at a height above the bed, and its derivatives there.
struct Mode {
  double w;
  Complex kappa, potential;
  Complex at(double z) const { return potential * std::cosh(kappa * z) / std::cosh(kappa); }
  Complex along(double z) const { return -i * kappa * at(z); }
  Complex up(double z) const { return kappa * potential * std::sinh(kappa * z) / std::cosh(kappa); }
};

std::vector<Mode> modes(const FirstOrderMotion& of, bool conjugate) {
  std::vector<Mode> all;
  for (const WaveMode& mode : of.modes) {
    const Complex p = -of.amplitude * mode.transfer / of.angular_frequency;
    all.push_back(conjugate ? Mode{-of.angular_frequency, -std::conj(mode.wavenumber), std::conj(p)}
                            : Mode{of.angular_frequency, mode.wavenumber, p});
  }
  return all;
}

// Slow twin: fields at the wall at second order, the bound waves with their resonance denominator, and Simpson's rule
// for the projection on the wave that would travel.
Complex by_quadrature(WavemakerKind kind, const FirstOrderMotion& a, const FirstOrderMotion& b, bool difference) {
  const std::vector<Mode> of_a = modes(a, false), of_b = modes(b, difference);
  const double w = a.angular_frequency + (difference ? -1 : 1) * b.angular_frequency, k = wavenumber(w, 1, 1);
  const Complex x_a = a.amplitude, x_b = difference ? std::conj(b.amplitude) : b.amplitude;
  const auto shape = [&](double z) { return kind == piston ? 1 : z; };
  const double slope = kind == piston ? 0 : 1;
  const auto along_wall = [&](double z) {
    Complex sum = 0;
    for (const Mode& m : of_a)
      for (const Mode& n : of_b) {
        // Half the product, in both orders.
        const Complex kappa = m.kappa + n.kappa;
        const Complex squares = m.along(1) * n.along(1) + m.up(1) * n.up(1);
        const auto steep = [](const Mode& q) { return -q.w * q.w * q.up(1) + q.kappa * q.kappa * q.at(1); };
        const Complex driven = -i * w * squares + 0.5 * (i * m.w * m.at(1) * steep(n) + i * n.w * n.at(1) * steep(m));
        const Complex bound = driven / (kappa * std::tanh(kappa) - w * w);
        sum += -i * kappa * bound * std::cosh(kappa * z) / std::cosh(kappa);
      }
    const auto asked = [&](Complex x, const Mode& mode) {
      return 0.5 * x * (slope * mode.up(z) + shape(z) * mode.kappa * mode.kappa * mode.at(z));
    };
    for (const Mode& m : of_a) sum -= asked(x_b, m);
    for (const Mode& n : of_b) sum -= asked(x_a, n);
    return sum;
  };
  // Products of two modes turn by up to 6 pi over the depth: Simpson's rule leaves (6 pi / n)^4 / 180 of them, 4e-11.
  constexpr int n = 2000;
  Complex need = 0;
  double moved = 0;
  for (int j = 0; j <= n; ++j) {
    const double z = double(j) / n, weight = (j == 0 || j == n ? 1 : j % 2 == 1 ? 4 : 2) / (3.0 * n);
    need += weight * along_wall(z) * std::cosh(k * z);
    moved += weight * shape(z) * std::cosh(k * z);
  }
  return (&a == &b ? 0.5 : 1) * need / (i * w * moved);
}

TEST(SecondOrderWaves, NothingTravelsByTheWallConditionUnderQuadrature) {
  for (const auto kind : {piston, flap})
    for (const double kh : {0.4, 1.0, 2.2}) {
      // An odd number of modes is not extrapolated.
      const FirstOrderMotion a = motion(kind, 0.05, 1.3 * frequency(kh), 0.4, 3);
      const FirstOrderMotion b = motion(kind, 0.04, frequency(kh), 2, 3);
      for (const bool difference : {false, true}) {
        const Complex found = second_order_amplitude(kind, a, b, difference, 1, 1);
        EXPECT_LT(std::abs(found - by_quadrature(kind, a, b, difference)), 1e-9 * std::abs(found)) << kh << difference;
      }
      const Complex itself = second_order_amplitude(kind, a, a, false, 1, 1);
      EXPECT_LT(std::abs(itself - by_quadrature(kind, a, a, false)), 1e-9 * std::abs(itself)) << kh;
    }
}

TEST(SecondOrderWaves, APairIsTheSameInBothOrders) {
  const FirstOrderMotion a = motion(piston, 0.05, 1.1, 0.4, 8), b = motion(piston, 0.03, 0.8, 2, 8);
  const Complex one = second_order_amplitude(piston, a, b, false, 1, 1);
  EXPECT_LT(std::abs(one - second_order_amplitude(piston, b, a, false, 1, 1)), 1e-14 * std::abs(one));
  // Two equal terms are one of twice the size: two squares and a product.
  const FirstOrderMotion twice = motion(piston, 0.1, 1.1, 0.4, 8), again = a;
  EXPECT_LT(std::abs(2.0 * second_order_amplitude(piston, a, a, false, 1, 1) +
                     second_order_amplitude(piston, a, again, false, 1, 1) -
                     second_order_amplitude(piston, twice, twice, false, 1, 1)),
            1e-14);
}

// Where a wave of twice the frequency of the difference is a factor, its wavenumber is that of the free wave.
TEST(SecondOrderWaves, AFreeWaveWithTheWavenumberOfAFactorIsNoSingularity) {
  for (const auto kind : {piston, flap}) {
    const FirstOrderMotion b = motion(kind, 0.03, 0.7, 0, 20);
    const auto at = [&](double w) { return second_order_amplitude(kind, motion(kind, 0.05, w, 0, 20), b, true, 1, 1); };
    // Between its neighbours on both sides: what curvature leaves is a ten-thousandth.
    const Complex before = at(1.395), behind = at(1.405);
    for (const double off : {0.0, 1e-9, 1e-6, 1e-4, 2e-3})
      EXPECT_LT(std::abs(at(1.4 + off) - before - (behind - before) * (0.005 + off) / 0.01), 5e-4 * std::abs(before))
          << off;
  }
}

// The wave bound to a slow group carries c_g eta, eta = -a_1 a_2 g (2 c_g / c - 1/2) / (gh - c_g^2) (Longuet-Higgins
// and Stewart 1962), and all of it comes from the wall. Extrapolated modes leave 1 / n^2 of the largest term.
TEST(SecondOrderWaves, AGroupTakesItsMassFromTheWall) {
  for (const auto kind : {piston, flap})
    for (const double kh : {0.3, 0.5, 1.0, 1.5, 2.0}) {
      const double w = frequency(kh), apart = 1e-3 * w;
      const FirstOrderMotion a = motion(kind, 0.05, w + apart / 2, 0, 40), b = motion(kind, 0.04, w - apart / 2, 0, 40);
      const double n = 0.5 * (1 + 2 * kh / std::sinh(2 * kh)), c = w / kh;
      const double group = n * c, eta = -0.05 * 0.04 * (2 * n - 0.5) / (1 - group * group);
      const Complex velocity = i * apart * second_order_amplitude(kind, a, b, true, 1, 1);
      const double moved = kind == piston ? 1 : 0.5;
      EXPECT_NEAR(velocity.real() * moved / (group * eta), 1, 0.01) << kh;
      EXPECT_LT(std::abs(velocity.imag()), 0.01 * std::abs(velocity.real())) << kh;
    }
}

// Far from the piston and less what the moving gauge sees of the slope, the elevation is that of the bound waves: the
// second harmonic of Stokes and the long wave of Longuet-Higgins and Stewart; decaying modes have died out there, and
// the piston makes no free wave.
TEST(SecondOrderWaves, TheElevationOfPairsIsThatOfTheBoundWavesFarAway) {
  for (const double kh : {0.5, 1.0, 1.5}) {
    const double amplitude = 0.05, gauge = 6, w = frequency(kh), s = std::tanh(kh), apart = 1e-3 * w;
    const FaceOfPiston face{1, 1, gauge};
    // Of the motion of one with the slope that another has at the gauge.
    const auto carried = [&](const FirstOrderMotion& a, const FirstOrderMotion& b, bool difference) {
      const double k = wavenumber(b.angular_frequency, 1, 1);
      const Complex slope = -i * k * i * b.amplitude * b.modes[0].transfer * std::exp(-i * k * gauge);
      return 0.5 * a.amplitude * (difference ? std::conj(slope) : slope);
    };
    const FirstOrderMotion a = motion(piston, amplitude, w, 0, 20);
    const Complex harmonic =
        second_order_elevation(a, a, false, second_order_amplitude(piston, a, a, false, 1, 1), face) -
        carried(a, a, false);
    EXPECT_NEAR(std::abs(harmonic), amplitude * amplitude * kh * (3 - s * s) / (4 * s * s * s),
                0.01 * std::abs(harmonic));
    EXPECT_NEAR(std::remainder(std::arg(harmonic) + 2 * kh * gauge, 2 * pi), 0, 0.02);

    const FirstOrderMotion p = motion(piston, amplitude, w + apart / 2, 0, 20),
                           q = motion(piston, amplitude, w - apart / 2, 0, 20);
    const Complex slow = second_order_elevation(p, q, true, second_order_amplitude(piston, p, q, true, 1, 1), face) -
                         carried(p, q, true) - std::conj(carried(q, p, true));
    const double n = 0.5 * (1 + 2 * kh / std::sinh(2 * kh)), group = n * w / kh;
    EXPECT_NEAR(slow.real(), -amplitude * amplitude * (2 * n - 0.5) / (1 - group * group), 0.02 * std::abs(slow)) << kh;
  }
}

TEST(SecondOrderWaves, MoreModesChangeLittle) {
  for (const auto kind : {piston, flap})
    for (const double kh : {0.5, 1.0, 2.0, 4.0}) {
      const auto with = [&](std::size_t decaying) {
        const FirstOrderMotion a = motion(kind, 0.05, frequency(kh), 0, decaying);
        return second_order_amplitude(kind, a, a, false, 1, 1);
      };
      EXPECT_LT(std::abs(with(40) - with(200)), 0.01 * std::abs(with(200))) << kh;
    }
}

TEST(SecondOrderWaves, ASumHasAllSumsAndDifferences) {
  const std::vector<Oscillation> first{{0.1, 1.0, 0.3}, {0.05, 1.4, 2}};
  const std::vector<Oscillation> second = second_order_motion(first, piston, 1, 1);
  std::vector<double> found;
  for (const Oscillation& term : second) found.push_back(term.angular_frequency);
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[k], (std::vector{0.4, 2.0, 2.4, 2.8})[k], 1e-14);
  // A wave that starts later by s has all phases later by it.
  const double s = 0.7;
  std::vector<Oscillation> late = first;
  for (Oscillation& term : late) term.phase -= term.angular_frequency * s;
  const std::vector<Oscillation> second_late = second_order_motion(late, piston, 1, 1);
  const auto sum = [](const std::vector<Oscillation>& terms, double t) {
    double x = 0;
    for (const Oscillation& term : terms) x += term.amplitude * std::sin(term.angular_frequency * t + term.phase);
    return x;
  };
  for (const double t : {0.0, 1.3, 8.0}) EXPECT_NEAR(sum(second_late, t + s), sum(second, t), 1e-12);
}

TEST(SecondOrderWaves, TheTableIsTheSum) {
  std::vector<Oscillation> terms;
  for (int k = 1; k <= 30; ++k) terms.push_back({1.0 / k, 0.2 * k, 1.7 * k});
  const TabulatedOscillations table(terms, 50);
  for (int k = 0; k < 400; ++k) {
    const double t = 0.1437 * k;  // the last ones lie beyond the table
    double value = 0, rate = 0;
    for (const Oscillation& term : terms) {
      value += term.amplitude * std::sin(term.angular_frequency * t + term.phase);
      rate += term.amplitude * term.angular_frequency * std::cos(term.angular_frequency * t + term.phase);
    }
    // (w dt)^4 / 384 and (w dt)^3 / 125 of the amplitudes, w dt = 2 pi / 40 at the fastest.
    EXPECT_NEAR(table.value(t), value, 2e-6 * 4);
    EXPECT_NEAR(table.rate(t), rate, 4e-5 * 6);
  }
}

}  // namespace
}  // namespace spume
