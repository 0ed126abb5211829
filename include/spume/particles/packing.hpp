// SPDX-License-Identifier: MIT
// Evens out particles beside walls of bodies, where the lattice that fills a scene is cut by the surface: some stand
// closer to it than half a spacing, some leave a gap.
//
// Particles nearer than four spacings to a body move by -C h^2 grad C of their concentration, wall points included,
// until the largest move is short. Those that see a free surface keep its height: they move horizontally.
#pragma once

#include "spume/particles/arrangement.hpp"
#include "spume/particles/boundary.hpp"

namespace spume {

// Moves particles, in both `particles.position` and `at`, and leaves them in cell order of `at`.
void pack_beside_bodies(Arrangement& arrangement, ParticleStore& particles, Boundary& boundary,
                        const Resolution& resolution, const VectorField& at, bool free_surface, double t);

}  // namespace spume
