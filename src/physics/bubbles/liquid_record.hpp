// SPDX-License-Identifier: MIT
// What bubbles see of a particle, times its volume times its kernel's normalisation over h_i^3, in units of V / h^3:
// one line of cache. The factor itself is among them, so that its sum comes with the others; the last is h_i / h.
// Oxygen takes the place of the energy of what is not resolved, or of the dissipation, where no fluctuation or no
// breakup reads them.
#pragma once

#include "spume/operators/cross_sums.hpp"

namespace spume::bubbles::liquid_record {

inline constexpr int velocity_at = 0, vorticity_at = 3, acceleration_at = 6, energy_at = 9, dissipation_at = 10,
                     normal_at = 11, factor_at = 14, length_at = 15, record = line_floats;

}  // namespace spume::bubbles::liquid_record
