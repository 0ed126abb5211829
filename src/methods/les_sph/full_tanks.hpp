// SPDX-License-Identifier: MIT
// Bodies that move in liquid that fills its domain (Features::moves_in_full_tank; a tank that moves around it does
// not): where one leaves a wall a void opens, and no equation has its pressure. Two rules differ there.
//
// What neighbours share of the shift stays in it. It lifts a surface, of which there is none, and fills the lack that a
// body leaves over more than a spacing; without it the pressure alone closes that, with jets.
//
// Particles that met a wall on their way lose what leads into it, as spray does at a surface. Nearer to its image than
// half a spacing a particle sees little of it, and no pressure stops it: reflected in every step, it kept 0.4 sqrt(gH)
// into the face that it slid along.
#pragma once

#include <string>

#include "spume/methods/les_sph/flow.hpp"

namespace spume::les_sph {

// What to say at the start of one that stands so near to a wall that no particle fits between them; empty: nothing.
std::string remark_on_gaps_in_full_tank(const Flow& flow);

// The fastest that gravity, the liquid at the start, inflows and given motions drive anything with; without gravity,
// which alone bounds what forces do, infinite. While the scene has its particles.
double speed_of_bodies(const Scene& scene, double end);

// Throws StepFailure where a body that floats moves ten times as fast: the energy of the liquid, which walls may give
// any, does not tell.
void refuse_runaway_bodies(const Flow& flow);

}  // namespace spume::les_sph
