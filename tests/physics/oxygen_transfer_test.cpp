// SPDX-License-Identifier: MIT
// Saturation and transfer coefficients against tables, and the gas of one bubble.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "spume/physics/oxygen/transfer.hpp"

namespace spume::oxygen {
namespace {

// Benson & Krause (1984) as tabulated by APHA, g/m^3 in fresh water; the table has six digits.
TEST(Oxygen, SaturationIsThatOfTheTables) {
  constexpr std::array<std::array<double, 2>, 8> table{{{0, 14.6208},
                                                        {5, 12.7710},
                                                        {10, 11.2879},
                                                        {15, 10.0839},
                                                        {20, 9.09243},
                                                        {25, 8.26346},
                                                        {30, 7.5588},
                                                        {35, 6.94932}}};
  for (const auto& [temperature, saturation] : table)
    EXPECT_NEAR(saturation_concentration(temperature, 0), saturation, 1e-5 * saturation) << temperature;
  // Sea water of 35 g/kg holds a fifth less: 7.4 g/m^3 at 20 C.
  EXPECT_NEAR(saturation_concentration(20, 35), 7.4, 0.05);
  EXPECT_NEAR(vapour_pressure(20), 2339, 5);  // of steam tables
}

// d, u, Higbie, solid sphere for D = 2.1e-9 and nu = 1e-6, of five digits.
TEST(Oxygen, CoefficientsAreThoseOfTheTable) {
  constexpr std::array<std::array<double, 4>, 6> table{{{1, 0.11, 0.00054233, 0.00011545},
                                                        {2, 0.21, 0.00052986, 0.00010887},
                                                        {3, 0.25, 0.00047203, 9.5642e-05},
                                                        {5, 0.24, 0.00035825, 7.1802e-05},
                                                        {11.3, 0.22, 0.00022816, 4.5648e-05},
                                                        {16.4, 0.21, 0.00018503, 3.7603e-05}}};
  for (const auto& [d, u, higbie, rigid] : table) {
    const Motion motion{.diameter = d * 1e-3, .slip = u, .viscosity = 1e-6, .diffusivity = 2.1e-9};
    EXPECT_NEAR(transfer_coefficient(Coefficient::higbie, motion, 0) / higbie, 1, 5e-5);
    EXPECT_NEAR(transfer_coefficient(Coefficient::rigid_sphere, motion, 0) / rigid, 1, 5e-4) << d;
    EXPECT_EQ(transfer_coefficient(Coefficient::given, motion, 3e-4), 3e-4);
    EXPECT_EQ(transfer_coefficient(Coefficient::none, motion, 3e-4), 0);
  }
  // A sphere at rest: Sh = 2.
  const Motion rest{.diameter = 1e-3, .slip = 0, .viscosity = 1e-6, .diffusivity = 2e-9};
  for (const Coefficient solid : {Coefficient::rigid_sphere, Coefficient::froessling})
    EXPECT_DOUBLE_EQ(transfer_coefficient(solid, rest, 0), 2 * 2e-9 / 1e-3);
}

Gas air_in_water() {
  return {.coefficient = Coefficient::given,
          .given = 4e-4,
          .diffusivity = 2.1e-9,
          .viscosity = 1e-6,
          .temperature = 20,
          .saturation = saturation_concentration(20, 0),
          .weight = 9810,
          .level = 4};
}

TEST(Oxygen, SaturationGrowsWithDepthAndOxygenOfTheGas) {
  const Gas gas = air_in_water();
  EXPECT_DOUBLE_EQ(gas.saturation_below_air(), gas.saturation);
  EXPECT_DOUBLE_EQ(gas.pressure(5), atmosphere);  // above the level
  EXPECT_DOUBLE_EQ(gas.pressure(1), atmosphere + 3 * 9810);
  const double vapour = vapour_pressure(20);
  EXPECT_NEAR(gas.solubility(gas.pressure(0)) * oxygen_of_air / gas.saturation, 1 + 4 * 9810 / (atmosphere - vapour),
              1e-12);
  EXPECT_NEAR(gas.volume(gas.moles(1e-8, 2), 2), 1e-8, 1e-22);
  // Air of 20 C at one atmosphere holds 0.2095 * 31.998 g * 41.57 mol/m^3 less the 2.3 % of vapour.
  EXPECT_NEAR(gas.moles(1, 4) * oxygen_of_air * molar_mass, 272, 1);
}

// Twin: the rate k_L A (c* - c) in small explicit steps. They are off by half of the rate times their length.
TEST(Oxygen, ABubbleGivesWhatSmallStepsGive) {
  const Gas gas = air_in_water();
  const double radius = 1e-3, volume = 4 * std::numbers::pi / 3 * std::pow(radius, 3), dt = 5;
  for (const double c : {0.0, 5.0, 30.0}) {
    const double total = gas.moles(volume, 1);
    const Contents before{oxygen_of_air * total, (1 - oxygen_of_air) * total};
    const Exchange exact = exchange(gas, before, sphere(radius), 1, 0.2, c, dt);
    EXPECT_NEAR(mass(exact.after) + exact.given, mass(before), 4e-16 * mass(before));
    EXPECT_EQ(exact.after.inert, before.inert);
    double oxygen = before.oxygen;
    constexpr int steps = 20000;
    for (int k = 0; k < steps; ++k) {
      const double saturation = gas.solubility(gas.pressure(1)) * oxygen / total;
      oxygen -= gas.given * 4 * std::numbers::pi * radius * radius * (saturation - c) / molar_mass * dt / steps;
    }
    EXPECT_NEAR(exact.given / (molar_mass * (before.oxygen - oxygen)), 1, 1e-4) << c;
    EXPECT_NEAR(exact.conductance, gas.given * 4 * std::numbers::pi * radius * radius, 1e-18);
  }
}

// However long the step: the oxygen neither ends below zero nor beyond the balance with the water.
TEST(Oxygen, ALongStepEndsInBalance) {
  const Gas gas = air_in_water();
  const double radius = 1e-3, total = gas.moles(4e-9, 1);
  const Contents before{oxygen_of_air * total, (1 - oxygen_of_air) * total};
  const Exchange empty = exchange(gas, before, sphere(radius), 1, 0.2, 0, 1e6);
  EXPECT_GE(empty.after.oxygen, 0);
  EXPECT_LT(empty.after.oxygen, 1e-12 * before.oxygen);
  const Exchange full = exchange(gas, before, sphere(radius), 1, 0.2, 20, 1e6);
  EXPECT_NEAR(gas.solubility(gas.pressure(1)) * full.after.oxygen / total, 20, 1e-9);
  EXPECT_LT(full.given, 0);
  EXPECT_EQ(exchange(gas, {}, sphere(radius), 1, 0.2, 5, 1).given, 0);
}

}  // namespace
}  // namespace spume::oxygen
