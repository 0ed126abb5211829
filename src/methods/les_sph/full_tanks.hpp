// SPDX-License-Identifier: MIT
// Bodies that float in liquid that fills its domain: where one leaves a wall a void opens, and no equation has its
// pressure.
#pragma once

#include <string>

#include "spume/methods/les_sph/flow.hpp"

namespace spume::les_sph {

// What to say at the start of one that stands so near to a wall that no particle fits between them; empty: nothing.
std::string remark_on_gaps_in_full_tank(const Flow& flow);

// Throws StepFailure where a body that floats moves ten times as fast as gravity, inflows and given motions drive
// anything: the energy of the liquid, which walls may give any, does not tell.
void refuse_runaway_bodies(const Flow& flow, double t);

}  // namespace spume::les_sph
