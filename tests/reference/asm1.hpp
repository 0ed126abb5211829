// SPDX-License-Identifier: MIT
// ASM1 of Henze et al. (1987) written out process by process from the published matrix: slow twin of the table.
#pragma once

#include <array>

#include "spume/physics/biokinetics/asm1.hpp"

namespace spume::reference {

inline std::array<double, 13> asm1_reaction(const biokinetics::Asm1Parameters& p, const std::array<double, 13>& c) {
  const auto [si, ss, xi, xs, xbh, xba, xp, so, sno, snh, snd, xnd, salk] = c;
  const double oxic = so / (p.k_oh + so), anoxic = p.k_oh / (p.k_oh + so) * sno / (p.k_no + sno);
  const double rho1 = p.mu_h * ss / (p.k_s + ss) * oxic * xbh;
  const double rho2 = p.mu_h * ss / (p.k_s + ss) * anoxic * p.eta_g * xbh;
  const double rho3 = p.mu_a * snh / (p.k_nh + snh) * so / (p.k_oa + so) * xba;
  const double rho4 = p.b_h * xbh, rho5 = p.b_a * xba, rho6 = p.k_a * snd * xbh;
  const double rho7 = p.k_h * (xs / xbh) / (p.k_x + xs / xbh) * (oxic + p.eta_h * anoxic) * xbh;
  const double rho8 = rho7 * xnd / xs;
  const double nitrate = (1 - p.y_h) / (2.86 * p.y_h);
  return {
      0,
      -(rho1 + rho2) / p.y_h + rho7,
      0,
      (1 - p.f_p) * (rho4 + rho5) - rho7,
      rho1 + rho2 - rho4,
      rho3 - rho5,
      p.f_p * (rho4 + rho5),
      -(1 - p.y_h) / p.y_h * rho1 - (4.57 - p.y_a) / p.y_a * rho3,
      -nitrate * rho2 + rho3 / p.y_a,
      -p.i_xb * (rho1 + rho2) - (p.i_xb + 1 / p.y_a) * rho3 + rho6,
      rho8 - rho6,
      (p.i_xb - p.f_p * p.i_xp) * (rho4 + rho5) - rho8,
      -p.i_xb / 14 * rho1 + (nitrate / 14 - p.i_xb / 14) * rho2 - (p.i_xb / 14 + 1 / (7 * p.y_a)) * rho3 + rho6 / 14};
}

}  // namespace spume::reference
