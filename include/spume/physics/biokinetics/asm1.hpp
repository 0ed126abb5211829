// SPDX-License-Identifier: MIT
// Activated Sludge Model No. 1 (Henze, Grady, Gujer, Marais and Matsuo 1987) as a table: 13 components, 8 processes.
// Concentrations in g/m^3 (COD, O2 or N), alkalinity in mol/m^3, time in days.
#pragma once

#include <array>

#include "spume/physics/biokinetics/model.hpp"

namespace spume::biokinetics {

namespace asm1 {
// The order of Henze et al. and of the IWA benchmark.
enum Component : std::size_t { s_i, s_s, x_i, x_s, x_bh, x_ba, x_p, s_o, s_no, s_nh, s_nd, x_nd, s_alk, components };
}  // namespace asm1

// Defaults: the IWA benchmark plant at 15 degrees C (Alex et al. 2008).
struct Asm1Parameters {
  double y_a = 0.24;   // g cell COD formed per g N oxidised
  double y_h = 0.67;   // g cell COD formed per g COD oxidised
  double f_p = 0.08;   // share of decayed biomass that becomes particulate products
  double i_xb = 0.08;  // g N per g COD of biomass
  double i_xp = 0.06;  // g N per g COD of products
  double mu_h = 4;     // 1/d
  double k_s = 10;     // g COD/m^3
  double k_oh = 0.2;   // g O2/m^3
  double k_no = 0.5;   // g N/m^3
  double b_h = 0.3;    // 1/d
  double eta_g = 0.8;  // anoxic growth over aerobic growth
  double eta_h = 0.8;  // anoxic hydrolysis over aerobic hydrolysis
  double k_h = 3;      // g slowly biodegradable COD/(g cell COD d)
  double k_x = 0.1;    // g slowly biodegradable COD/g cell COD
  double mu_a = 0.5;   // 1/d
  double k_nh = 1;     // g N/m^3
  double k_oa = 0.4;   // g O2/m^3
  double b_a = 0.05;   // 1/d
  double k_a = 0.05;   // m^3/(g COD d)
  // Half-saturations of ammonia as a nutrient and of alkalinity, which the published model does not have: without them
  // growth goes on where they are used up, and makes them negative. 0: as published.
  double k_nutrient = 0;    // g N/m^3
  double k_alkalinity = 0;  // mol/m^3

  // The defaults with the six rates that depend on temperature (degrees C) set by (4). The two sets of values are of
  // 10 and 15 degrees; beyond them (4) extrapolates.
  static Asm1Parameters at(double temperature);
};

// Throws std::invalid_argument for yields outside (0, 1), shares outside [0, 1] and negative rates or saturations.
Model asm1_model(const Asm1Parameters& parameters);

// What a gram (alkalinity: a mole) of every component holds of a conserved quantity. COD counts from ammonia: oxygen
// -1, nitrate -4.57. Dinitrogen is no component: a gram of its nitrogen takes dinitrogen_cod with it.
using Asm1Content = std::array<double, asm1::components>;
Asm1Content asm1_cod();
Asm1Content asm1_nitrogen(const Asm1Parameters& parameters);
Asm1Content asm1_charge();  // mol/m^3
inline constexpr double dinitrogen_cod = -(4.57 - 2.86);

}  // namespace spume::biokinetics
