// SPDX-License-Identifier: MIT
// Evens out particles at the start: they move by -C h^2 grad C of their concentration, images and wall points included,
// until the largest move is short.
//
// Beside walls of bodies the lattice that fills a scene is cut by the surface: some particles stand closer to it than
// half a spacing, some leave a gap. Those nearer than four spacings to a body move; those that see a free surface keep
// its height: they move horizontally. Below a free surface those nearer than a quarter of a spacing to a face are moved
// out to there. With `phase`, where phases lie in layers, so do those that see an interface:
// moved up and down with its particles it would be a wave of a tenth of a spacing. Layers behind openings, the
// particles with 0 or more in `layer`, stay, and no particle leaves the domain.
//
// Between faces of solids off the lattice, columns have cells and layers of other sizes, whole numbers of which make up
// the volume to half a particle only. Thin ones draw particles in as soon as the liquid moves, and take themselves for
// a free surface: still water is thrown out of a gap of 1.3 spacings with 0.9 sqrt(g H). Where kernel sums below what a
// free surface sees are more than 5 % off, all particles there move. Those that see it stay in their columns, which end
// on it.
#pragma once

#include "spume/particles/arrangement.hpp"
#include "spume/particles/boundary.hpp"

namespace spume {

// Moves particles, in both `particles.position` and `at`, and leaves them in cell order of `at`.
void pack_beside_bodies(Arrangement& arrangement, ParticleStore& particles, Boundary& boundary,
                        const Resolution& resolution, const VectorField& at, bool free_surface, double t,
                        const Array<std::int64_t>* phase = nullptr, const Array<std::int64_t>* layer = nullptr);
void pack_beside_solids(Arrangement& arrangement, ParticleStore& particles, Boundary& boundary,
                        const Resolution& resolution, const VectorField& at, bool free_surface, double t);

}  // namespace spume
