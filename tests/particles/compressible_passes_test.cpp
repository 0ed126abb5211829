// SPDX-License-Identifier: MIT
// Passes over weakly compressible particles that take several at a time, against their formulas for one.
#include <gtest/gtest.h>

#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/size_bits.hpp"
#include "spume/particles/bounded_shift.hpp"
#include "spume/particles/excess_step.hpp"
#include "spume/particles/fastest.hpp"
#include "spume/particles/half_steps.hpp"
#include "spume/particles/phase_energies.hpp"
#include "spume/particles/phase_sums.hpp"

namespace spume::test {
namespace {

constexpr double rounding = 1e-14;  // of a few products

double number(std::size_t i, std::uint32_t draw) {
  return std::sin(12.9898 * static_cast<double>(i + 1) + 78.233 * draw);
}

// Particles of a liquid and a gas in runs of all lengths, the last block of which is not full.
struct Mixed {
  static constexpr std::size_t n = 3 * default_block + 17;
  std::vector<PhaseLaw> laws{{.density = 1000, .sound_speed = 10}, {.density = 2, .sound_speed = 60, .exponent = 1.4}};
  InitialParticles initial;
  Array<std::int64_t> phase{n}, layer{n};
  Array<double> excess{n};
  std::array<Array<float>, 3> a{Array<float>(n), Array<float>(n), Array<float>(n)}, shift = a, gradient = a;

  Mixed() {
    initial.volume = 0.1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      initial.position[axis].resize(n);
      initial.velocity[axis].resize(n);
    }
    for (std::size_t i = 0; i < n; ++i) {
      phase[i] = i < default_block ? 0 : (i * i / 700) % 2;
      layer[i] = i % 5 == 0 ? 3 : -1;
      excess[i] = 0.02 * number(i, 0);
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        initial.position[axis][i] = 2 * number(i, 1 + axis);
        initial.velocity[axis][i] = number(i, 4 + axis);
        a[axis][i] = static_cast<float>(number(i, 7 + axis));
        shift[axis][i] = static_cast<float>(number(i, 10 + axis));
        gradient[axis][i] = static_cast<float>(number(i, 13 + axis));
      }
    }
  }
  const PhaseLaw& law(std::size_t i) const { return laws[static_cast<std::size_t>(phase[i])]; }
};

TEST(SizeBits, TheLargestSizeIsThatOfTheNumbersAndNaNWins) {
  std::vector<double> numbers{0.5, -3, 2, 0};
  EXPECT_EQ(largest_size(numbers.data(), 0, 4), 3);
  EXPECT_EQ(largest_size(numbers.data(), 2, 4), 2);
  EXPECT_EQ(largest_size(numbers.data(), 2, 2), 0);
  numbers[2] = -INFINITY;
  EXPECT_EQ(largest_size(numbers.data(), 0, 4), INFINITY);
  numbers[1] = -NAN;
  EXPECT_TRUE(std::isnan(largest_size(numbers.data(), 0, 4)));
  const std::vector<float> floats{1, -2.5F, NAN};
  EXPECT_EQ(largest_size(floats.data(), 0, 2), 2.5F);
  EXPECT_TRUE(std::isnan(largest_size(floats.data(), 0, 3)));
}

TEST(PhaseLaw, TheEnergyOfLiquidsIsThatOfTheGeneralFormulaAndLosesNoDigits) {
  const PhaseLaw liquid{.density = 1, .sound_speed = 1};
  for (const double s : {-0.2, -0.01, 0.03, 0.4}) {
    const double x = 1 + s, expected = (std::pow(x, 6) - 1) / 6 + 1 / x - 1;
    EXPECT_NEAR(liquid.energy_over_stiffness(s), expected, 4 * rounding) << s;
  }
  // gamma / 2 s^2 (1 + (gamma - 5) / 3 s + ...)
  EXPECT_NEAR(liquid.energy_over_stiffness(1e-7) / (3.5e-14 * (1 + 2e-7 / 3)), 1, 1e-12);
}

TEST(ParticleLaws, RunsHoldEveryParticleOnceWithItsLaw) {
  const Mixed mixed;
  const ParticleLaws law(mixed.laws, mixed.phase);
  std::size_t next = 7;
  law.each_run(7, Mixed::n - 3, [&](const PhaseLaw& own, std::size_t from, std::size_t to) {
    EXPECT_EQ(from, next);
    EXPECT_LT(from, to);
    for (std::size_t i = from; i < to; ++i) EXPECT_EQ(own.density, mixed.law(i).density) << i;
    next = to;
  });
  EXPECT_EQ(next, Mixed::n - 3);
}

TEST(HalfSteps, GoAsTheFormulasSay) {
  const Mixed mixed;
  const double dt = 0.3;
  for (const bool shifts : {false, true}) {
    const HalfSteps half{dt, read(mixed.initial.position), read(mixed.initial.velocity), read(mixed.a),
                         shifts ? read(mixed.shift) : std::array<const float*, 3>{}};
    Array<double> u(Mixed::n), r(Mixed::n);
    half.velocities(1, 3, Mixed::n, u.data());
    half.middles(1, 3, Mixed::n, r.data());
    for (std::size_t i = 3; i < Mixed::n; ++i) {
      const double speed = mixed.initial.velocity[1][i] + dt / 2 * mixed.a[1][i];
      EXPECT_NEAR(u[i], speed, rounding) << i;
      EXPECT_NEAR(half.velocity_of(1, i), speed, rounding) << i;
      EXPECT_NEAR(r[i], mixed.initial.position[1][i] + dt / 2 * (speed + (shifts ? mixed.shift[1][i] : 0)), rounding);
    }
    half.go_on(1, 3, Mixed::n, r.data());
    for (std::size_t i = 3; i < Mixed::n; ++i) EXPECT_NEAR(r[i], half.end_of(1, i, u[i]), rounding) << i;
    Array<float> after(Mixed::n);
    const Array<double> before = u;
    std::vector<double> given(Mixed::n - 3, 1.0 / 3);
    half.finish(3, Mixed::n, given.data(), after.data(), u.data());
    EXPECT_EQ(after[5], static_cast<float>(given[2]));
    EXPECT_NEAR(u[5], before[5] + dt / 2 * after[5], rounding);
  }
}

TEST(ExcessStep, AdvancesEachParticleByItsLaw) {
  const Mixed mixed;
  Array<double> next(Mixed::n), lack(Mixed::n);
  for (std::size_t i = 0; i < Mixed::n; ++i) lack[i] = 0.01 * number(i, 20);
  Array<float> pressure(Mixed::n), volume(Mixed::n);
  const ExcessStep step{.dt = 0.02,
                        .dimensions = 3,
                        .law = {mixed.laws, mixed.phase},
                        .excess = mixed.excess.data(),
                        .left_out = mixed.layer.data(),
                        .rate = mixed.a[0].data(),
                        .spread = mixed.a[1].data(),
                        .diffusion = 0.01,
                        .lack = lack.data(),
                        .share = 0.2,
                        .carried = mixed.a[2].data(),
                        .shift = read(mixed.shift),
                        .gravity = {0, 0.5, -2},
                        .background = 30,
                        .next = next.data(),
                        .pressure = pressure.data(),
                        .volume = volume.data()};
  for (std::size_t first = 0; first < Mixed::n; first += default_block)
    step.advance(first, std::min(Mixed::n, first + default_block));
  for (std::size_t i = 0; i < Mixed::n; ++i) {
    const PhaseLaw& own = mixed.law(i);
    const double grown = step.dt / 2 * step.rate[i], c = own.sound_speed;
    double s = mixed.excess[i];
    if (mixed.layer[i] < 0) s += (1 + s) * 2 * grown / (1 - grown) + step.dt * 0.01 * c * step.spread[i];
    s += 0.2 * lack[i];
    s += step.dt * (step.carried[i] + (0.5 * mixed.shift[1][i] - 2 * mixed.shift[2][i]) / (c * c));
    EXPECT_NEAR(next[i], s, rounding) << i;
    EXPECT_NEAR(pressure[i], own.pressure(s) + 30, 1e-6 * own.stiffness()) << i;
    EXPECT_NEAR(volume[i], 1 / (1 + s), 1e-7) << i;
  }
  const ReducedExcess properties{.dimensions = 3,
                                 .law = step.law,
                                 .excess = mixed.excess.data(),
                                 .gravity = step.gravity,
                                 .origin = {-2, -1, -3},
                                 .place = read(mixed.initial.position),
                                 .volume = volume.data(),
                                 .reduced = pressure.data()};
  properties.find(5, 400);
  for (std::size_t i = 5; i < 400; ++i) {
    const double c = mixed.law(i).sound_speed, y = mixed.initial.position[1][i], z = mixed.initial.position[2][i];
    EXPECT_NEAR(pressure[i], mixed.excess[i] - (0.5 * (y + 1) - 2 * (z + 3)) / (c * c), 1e-7) << i;
    EXPECT_NEAR(volume[i], 1 / (1 + mixed.excess[i]), 1e-7) << i;
  }
}

TEST(BoundedShift, IsDownTheGradientWithinItsBound) {
  Mixed mixed;
  const BoundedShift velocity{.dimensions = 3,
                              .strength = 4,
                              .bound = 3,
                              .concentration = read(mixed.gradient),
                              .left_out = mixed.layer.data(),
                              .shift = write(mixed.shift)};
  velocity.find(0, default_block);
  int bounded = 0;
  for (std::size_t i = 0; i < default_block; ++i) {
    double size = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) size += std::pow(4 * mixed.gradient[axis][i], 2);
    size = std::sqrt(size);
    bounded += size > 3;
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(mixed.shift[axis][i],
                  mixed.layer[i] >= 0 ? 0 : -4 * mixed.gradient[axis][i] * std::min(1.0, 3 / size), 1e-6)
          << i;
  }
  EXPECT_GT(bounded, 0);
  EXPECT_LT(bounded, static_cast<int>(default_block));
}

TEST(Fastest, IsTheLargestOfEachAndNaNWins) {
  Mixed mixed;
  Fastest::State state{.dimensions = 3,
                       .law = {mixed.laws, mixed.phase},
                       .excess = mixed.excess.data(),
                       .velocity = read(mixed.initial.velocity),
                       .acceleration = read(mixed.a),
                       .shift = read(mixed.shift)};
  Fastest expected, fastest;
  for (std::size_t i = 0; i < Mixed::n; ++i) {
    double u2 = 0, t2 = 0, a2 = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double u = mixed.initial.velocity[axis][i];
      u2 += u * u;
      t2 += std::pow(u + mixed.shift[axis][i], 2);
      a2 += std::pow(mixed.a[axis][i], 2);
    }
    const double s = mixed.excess[i], e = (mixed.law(i).exponent - 1) / 2;
    expected = Fastest::of_both(expected, {.signal = mixed.law(i).sound_speed * std::pow(1 + s, e) + std::sqrt(u2),
                                           .speed2 = u2,
                                           .transport2 = t2,
                                           .acceleration2 = a2,
                                           .strain = std::abs(s) / mixed.law(i).largest_change()});
  }
  fastest.take(state, 0, Mixed::n);
  EXPECT_NEAR(fastest.signal, expected.signal, 1e-12);
  EXPECT_NEAR(fastest.speed2, expected.speed2, rounding);
  EXPECT_NEAR(fastest.transport2, expected.transport2, 2 * rounding);
  EXPECT_NEAR(fastest.acceleration2, expected.acceleration2, rounding);
  EXPECT_NEAR(fastest.strain, expected.strain, rounding);
  state.shift = state.acceleration = {};
  Fastest still;
  still.take(state, 0, Mixed::n);
  EXPECT_EQ(still.transport2, fastest.speed2);
  EXPECT_EQ(still.acceleration2, 0);
  mixed.initial.velocity[2][700] = NAN;
  still.take(state, 0, Mixed::n);
  EXPECT_TRUE(std::isnan(still.speed2) && std::isnan(still.transport2) && std::isnan(still.signal));
  EXPECT_FALSE(std::isnan(still.strain));
}

TEST(PhaseEnergies, AndSumsAreThoseOfTheParticles) {
  for (const int dimensions : {2, 3}) {
    const Mixed mixed;
    const ParticleStore particles(dimensions, mixed.initial);
    Domain domain;
    domain.dimensions = dimensions;
    domain.lower = {-1, -3, -3};
    domain.upper = {1, 3, 3};
    for (auto& side : domain.sides[0]) side.kind = BoundaryKind::periodic;
    const Vec3 gravity{0, -2, 0}, gradient{0.5, -3, 0}, from{1, 2, 0};
    for (const bool all : {true, false}) {
      const std::int64_t* const left_out = all ? nullptr : mixed.layer.data();
      PhaseSums sums(particles, mixed.phase, {1000, 2}, all ? nullptr : &mixed.layer);
      sums.go_round(domain);
      sums.find();
      PhaseEnergies expected;
      std::array<PhaseSums::Sums, 2> of{};
      std::array<double, 2> most{};
      for (std::size_t i = 0; i < Mixed::n; ++i) {
        if (!all && mixed.layer[i] >= 0) continue;
        const PhaseLaw& own = mixed.law(i);
        const auto k = static_cast<std::size_t>(mixed.phase[i]);
        const double mass = 0.1 * own.density, speed2 = squared_norm(particles.velocity, dimensions, i);
        expected.kinetic += mass * speed2 / 2;
        expected.potential += 2 * mass * (*particles.position[1])[i];
        expected.compression += 0.1 * own.stiffness() * own.energy_over_stiffness(mixed.excess[i]);
        const double head = 0.5 * ((*particles.position[0])[i] - 1) - 3 * ((*particles.position[1])[i] - 2);
        expected.reference += 0.1 / (1 + mixed.excess[i]) * (head - 7);
        expected.largest_speed = std::max(expected.largest_speed, std::sqrt(speed2));
        most[k] = std::max(most[k], std::abs(mixed.excess[i]));
        of[k].mass += mass;
        for (int axis = 0; axis < dimensions; ++axis) {
          of[k].momentum[axis] += mass * (*particles.velocity[axis])[i];
          of[k].moment[axis] += mass * domain.inside(axis, (*particles.position[axis])[i]);
        }
      }
      const PhaseEnergies found = phase_energies({.particles = particles,
                                                  .law = {mixed.laws, mixed.phase},
                                                  .excess = mixed.excess.data(),
                                                  .gravity = gravity,
                                                  .left_out = left_out,
                                                  .reference_gradient = gradient,
                                                  .reference_place = from,
                                                  .background = 7});
      EXPECT_NEAR(found.kinetic / expected.kinetic, 1, 1e-12);
      EXPECT_NEAR(found.potential, expected.potential, 1e-9 * expected.kinetic);
      EXPECT_NEAR(found.compression / expected.compression, 1, 1e-12);
      EXPECT_NEAR(found.reference / expected.reference, 1, 1e-12);
      EXPECT_NEAR(found.largest_speed, expected.largest_speed, rounding);
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(largest_excess(k, mixed.phase, mixed.excess, left_out), most[k]);
        EXPECT_NEAR(sums.of(k).mass / of[k].mass, 1, 1e-12);
        for (int axis = 0; axis < dimensions; ++axis) {
          EXPECT_NEAR(sums.of(k).momentum[axis], of[k].momentum[axis], 1e-12 * of[k].mass);
          EXPECT_NEAR(sums.of(k).moment[axis], of[k].moment[axis], 1e-12 * of[k].mass);
        }
      }
    }
  }
}

}  // namespace
}  // namespace spume::test
