// SPDX-License-Identifier: MIT
// Options of weakly compressible SPH. The sound speed and the exponent of a phase stand in [[phase]].
#pragma once

#include "spume/scene/option.hpp"

namespace spume::wcsph {

// How the density is smoothed within each phase: operators/wcsph_sums.hpp.
enum class DensityFilter { delta, shepard, none };

// Whether particles are shifted towards an even spacing.
enum class Shifting { automatic, on, off };

// What phases meet at: the mean of their pressures, or the one weighted with densities (operators/wcsph_sums.hpp).
enum class InterfacePressure { automatic, mean, weighted };

// What a run says of liquids that it does not shift. Shifted beside bodies they gain energy in acute wedges between
// no-slip walls: at a box turned by 10 degrees on the floor, in space, brine below water reached 3.6 m/s within 3 s
// under a lid that moves with 0.1; unshifted 0.09.
inline constexpr const char* uneven_liquids =
    "liquids that flow beside bodies are not shifted, and lose energy by the disorder of their particles, in exchanges "
    "a third of it; where no body makes an acute wedge with a no-slip wall set compressibility.shifting = \"on\"";

struct CompressibilityOptions {
  double max_speed = 0;             // that the flow will reach; 0: estimated
  double background_pressure = -1;  // negative: chosen by the scene
  double repulsion = 0.04;          // of Monaghan (2013), who takes 0.08
  DensityFilter density_filter = DensityFilter::delta;
  double diffusion = 0.1;         // delta of Molteni and Colagrossi (2009)
  double density_relaxation = 2;  // spacings that the fastest particle moves
  int filter_interval = 25;       // steps, of the Shepard filter
  int settling_rounds = 4000;     // tanks of 28 rows take 490 to 1,000, of 55 rows and in space more
  Shifting shifting = Shifting::automatic;
  InterfacePressure interface_pressure = InterfacePressure::automatic;
};

struct ListOptions {
  double skin = 0.4;  // in spacings
};

Section compressibility_section();
Section list_section();

}  // namespace spume::wcsph
