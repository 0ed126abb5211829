// SPDX-License-Identifier: MIT
// What pressures of a closed tank are measured from: a liquid of the lightest density, at rest.
//
// The force of a pair is its sum of pressures, under which an arrangement of particles resists shear as a solid does
// and, in disorder, dissipates: both in proportion to the pressure, not to its differences. An interface of oil and
// brine (900 and 1100 kg/m3, 28 spacings deep, 0.07 steep) stopped half way to level under that of its depth; by what
// is left over the still liquid it swings to 0.67 of where it started, by the method of finite differences to 0.99.
//
//   P' = P - rho_r g . (r - r_0),  rho du/dt = -grad P' + (rho - rho_r) g
//
// r_0 is the highest corner of the tank, so that P' of layers at rest is P there and grows downwards in what is
// heavier.
#pragma once

#include <array>

#include "spume/core/vectors.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

struct StillLiquid {
  double density = 0;  // rho_r; 0: none
  Vec3 gravity{};      // across sides
  Vec3 highest{};      // r_0
  double range = 0;    // of P' of layers at rest that fill the tank: (rho_max - rho_r) |g . extent|

  explicit operator bool() const { return density > 0; }
  Vec3 pressure_gradient() const { return multiply(density, gravity); }
  // The least pressure that keeps particles apart which are not shifted. Layers of 900 and 1100 kg/m3 stay at rest
  // within 6e-4 sqrt(gH) with a quarter to twice of the range, with nothing they do not settle; their wave swings to
  // 0.62, 0.59, 0.43 and 0.11 of its start with a quarter, a half, the whole and twice of it.
  double background() const { return range / 4; }
  // What gravity loses by buoyancy, where the specific volume is that: rho_r / rho.
  double lost_share(double specific_volume) const { return density * specific_volume; }
  // P' of particles [0, n) at `place` in the place of P.
  void subtract(const std::array<const double*, 3>& place, std::size_t n, float* pressure) const;
  void subtract(const std::array<const double*, 3>& place, std::size_t n, double* pressure) const;
};

// Of a scene without free surface and openings whose gravity acts across its sides. None where its lightest
// phase is a gas, which would take less than a fiftieth off the pressure; of one phase whose particles nothing but
// their pressure keeps apart; nor of phases with surface tension (the centre of the bubble of cases/rising_bubble_2d at
// a spacing of 1/32 is 0.0132 too low at t = 3 with it, 0.0103 without).
StillLiquid still_liquid(const Scene& scene, bool shifting);

// Whether several phases, closed in as above, flow from the start: they do not lie in layers at rest, something drives
// them, or they are of one density, which nothing keeps in layers.
bool liquids_flow(const Scene& scene, bool driven);

}  // namespace spume
