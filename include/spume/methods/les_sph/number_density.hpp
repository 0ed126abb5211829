// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {

// How far the liquid moves over dt, relative to its mean velocity and without spray, over the distance that the courant
// limit allows; at most 1, and the same in every frame. A liquid at rest needs no care for its arrangement, and small
// steps no more of it than large ones.
double displacement_fraction(const Liquid& liquid, double dt);

// Subtracts from `divergence` that which evens out the number density over N = `pressure.density_relaxation` steps at
// the courant limit:
//   div u^{n+1} = displacement / (N dt) (b(<e>, 0.002) + b(e_i - <e>, 0.02)),  b(x, a) = x - min(max(x, -a), a),
//   e = S / (S of the lattice) - 1 within 0.1,  S = sum_j V_j W_ij.
// S tells the density and hardly the strain of a lattice (at 1.2 by 1/1.2 it rises by 0.3 %, div r by 1.5 %, which
// would lift the crest of a wave). Velocities free of divergence keep the density only as far as their discrete
// divergence tells the volume of a moving arrangement: without this a lid-driven cavity thins out by an eighth below
// the lid and thickens at the bottom, and the circulation is 4 % too weak. What is let be is what the disorder of an
// arrangement makes of S: 0.002 in the mean (0.0017 in a cavity), which must not raise the level of a liquid with a
// surface, and 0.02 from particle to particle. Particles that may lack neighbours, within reach of the surface, or see
// too many, within reach of a solid box, whose images overlap at edges, are left alone: the second layer of a liquid at
// rest would pass for 5 % too thin. `near_surface` is scratch, used only where there is a surface.
void even_out_density(const Liquid& liquid, double dt, std::span<double> divergence, Array<std::uint8_t>& near_surface);

}  // namespace spume::les_sph
