// SPDX-License-Identifier: MIT
// Layers beside sides of the domain that damp the velocity, so that waves do not come back from them.
#pragma once

#include <vector>

#include "spume/particles/store.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

// Solves du/dt = -rate (u - velocity) over dt for every particle, exactly at its place. The rate falls from the
// strength of a sponge at its side to 0 at its inner end as a square, which at a length of one wavelength sends back
// less than a linear or a cubic profile does (2 %, 9 % and 4 %, long-wave theory); where sponges overlap, each acts.
// Returns what the kinetic energy of unit particles gains, below zero for liquid that is slowed down.
double damp_in_sponges(const Domain& domain, const std::vector<Sponge>& sponges, const VectorField& position,
                       std::size_t particles, double dt, VectorScratch& velocity);

}  // namespace spume
