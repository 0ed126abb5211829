// SPDX-License-Identifier: MIT
#include "reference/asm1.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "spume/core/random.hpp"
#include "spume/physics/biokinetics/asm1.hpp"

namespace spume::biokinetics {
namespace {

using State = std::array<double, asm1::components>;
constexpr double rounding = std::numeric_limits<double>::epsilon();

double logarithmic(std::uint64_t draw, std::uint32_t component) {
  const double u =
      random_uniform(25, RandomPurpose::test, draw, component / 4, 0)[static_cast<std::size_t>(component % 4)];
  return std::pow(10.0, -4 + 8 * u);
}

State reaction_of(const Asm1Parameters& parameters, const State& c) {
  State change{};
  reaction(asm1_model(parameters), c, change);
  return change;
}

// Nitrogen that leaves the components is dinitrogen; COD closes when it takes its own with it.
TEST(Asm1, EveryProcessConservesCodNitrogenAndCharge) {
  for (const double temperature : {8.0, 15.0, 22.0}) {
    const Asm1Parameters p = Asm1Parameters::at(temperature);
    for (const Process& process : asm1_model(p).processes) {
      // Terms are at most 4.57 / Y_A = 19: ten roundings of it.
      const double tolerance = 10 * 19 * rounding;
      const double dinitrogen = -production(process, asm1_nitrogen(p));
      const bool denitrifies = process.name == "anoxic growth of heterotrophs";
      EXPECT_NEAR(dinitrogen, denitrifies ? (1 - p.y_h) / (2.86 * p.y_h) : 0, tolerance) << process.name;
      EXPECT_NEAR(production(process, asm1_cod()) + dinitrogen_cod * dinitrogen, 0, tolerance) << process.name;
      EXPECT_NEAR(production(process, asm1_charge()), 0, tolerance) << process.name;
    }
  }
}

TEST(Asm1, TheTableIsThePublishedMatrix) {
  const Asm1Parameters p = Asm1Parameters::at(18);
  for (std::uint64_t draw = 0; draw < 200; ++draw) {
    State c;
    for (std::uint32_t i = 0; i < c.size(); ++i) c[i] = logarithmic(draw, i);
    const State table = reaction_of(p, c), written = reference::asm1_reaction(p, c);
    double scale = 0;
    for (const Process& process : asm1_model(p).processes) scale = std::max(scale, rate(process, c));
    // Coefficients are at most 19, a rate has some twenty roundings.
    for (std::size_t i = 0; i < c.size(); ++i) EXPECT_NEAR(table[i], written[i], 20 * 19 * scale * rounding) << i;
  }
}

TEST(Asm1, NothingReactsWithoutBiomassAndNothingUsedUpIsConsumed) {
  const Model model = asm1_model({});
  for (std::size_t absent = 0; absent < model.size(); ++absent) {
    State c;
    c.fill(1);
    c[absent] = 0;
    State change{};
    reaction(model, c, change);
    for (const double v : change) EXPECT_TRUE(std::isfinite(v));
    // Ammonia and alkalinity have no switching function where they are nutrient and buffer: the model's own limit.
    if (absent == asm1::s_nh || absent == asm1::s_alk) continue;
    EXPECT_GE(change[absent], 0) << model.components[absent];
  }
  const State empty{};
  EXPECT_EQ(reaction_of({}, empty), State{});
  State sterile;
  sterile.fill(1);
  sterile[asm1::x_bh] = sterile[asm1::x_ba] = 0;
  EXPECT_EQ(reaction_of({}, sterile), State{});
}

TEST(Asm1, TemperatureGoesThroughBothPublishedSets) {
  const Asm1Parameters at15 = Asm1Parameters::at(15), at10 = Asm1Parameters::at(10);
  EXPECT_DOUBLE_EQ(at15.mu_h, 4);
  EXPECT_DOUBLE_EQ(at15.k_a, 0.05);
  EXPECT_NEAR(at10.mu_h, 3, 1e-14);
  EXPECT_NEAR(at10.b_h, 0.2, 1e-14);
  EXPECT_NEAR(at10.mu_a, 0.3, 1e-14);
  EXPECT_NEAR(at10.b_a, 0.03, 1e-14);
  EXPECT_NEAR(at10.k_h, 2.5, 1e-14);
  EXPECT_NEAR(at10.k_a, 0.04, 1e-14);
}

// One aerated tank of 1333 m^3 with the influent of the benchmark plant, kLa = 240 1/d, saturation 8 g/m^3: steady
// state by MATLAB, from the tests of bsm2-python (fau-evt).
struct Tank {
  static constexpr State influent = {30, 69.5, 51.2, 202.32, 28.17, 0, 0, 0, 0, 31.56, 6.95, 10.59, 7};
  static constexpr State steady = {30,
                                   63.8577381952497,
                                   51.2,
                                   195.543287548103,
                                   36.1897495656497,
                                   0,
                                   0.0627660451102823,
                                   7.32747877688682,
                                   0,
                                   31.7048384340176,
                                   6.49409298588329,
                                   10.2557226521405,
                                   7.01034560242983};
  Model model = asm1_model({});

  State change(const State& c) const {
    State rates{};
    reaction(model, c, rates);
    for (std::size_t i = 0; i < c.size(); ++i) rates[i] += 18446.0 / 1333 * (influent[i] - c[i]);
    rates[asm1::s_o] += 240 * (8 - c[asm1::s_o]);
    return rates;
  }
};

TEST(Asm1, ATankSettlesToThePublishedSteadyState) {
  const Tank tank;
  State c = Tank::influent;
  // Explicit midpoint, stable below 2 / (240 + 14 + uptake) d; after four days exp(-13.8 * 4) of the start is left.
  constexpr double step = 1e-3;
  for (int n = 0; n < 4000; ++n) {
    State half = c;
    const State first = tank.change(c);
    for (std::size_t i = 0; i < c.size(); ++i) half[i] += step / 2 * first[i];
    const State second = tank.change(half);
    for (std::size_t i = 0; i < c.size(); ++i) c[i] += step * second[i];
  }
  for (std::size_t i = 0; i < c.size(); ++i)
    EXPECT_NEAR(c[i], Tank::steady[i], 1e-9 * std::max(1.0, Tank::steady[i])) << tank.model.components[i];
}

TEST(Asm1, ImpossibleParametersAreRefused) {
  Asm1Parameters p;
  p.y_a = 0;
  EXPECT_THROW(asm1_model(p), std::invalid_argument);
  p = {};
  p.b_h = -0.1;
  EXPECT_THROW(asm1_model(p), std::invalid_argument);
  p = {};
  p.k_x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(asm1_model(p), std::invalid_argument);
  EXPECT_THROW(asm1_model({}).component("S_0"), std::invalid_argument);
  EXPECT_EQ(asm1_model({}).component("S_ALK"), asm1::s_alk);
}

}  // namespace
}  // namespace spume::biokinetics
