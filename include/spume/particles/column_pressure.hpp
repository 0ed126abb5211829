// SPDX-License-Identifier: MIT
// Liquid under gravity at the start: its pressure, and whether it is at rest. Both look at the cells of the lattice
// that fills the scene (scene/lattice.hpp), in which what touches, by a corner too, is one part of the liquid.
#pragma once

#include <cstdint>
#include <vector>

#include "spume/particles/store.hpp"

namespace spume {

// Gravity along the axes that sides bound.
Vec3 gravity_across_sides(const Scene& scene);

// Whether gravity points down a closed tank in which every phase lies wholly above the heavier ones: then the pressure
// below is that at rest.
bool lie_in_layers(const Scene& scene);

// Where gravity points down, 1 for each particle of a part of the liquid that is level and at rest: nothing of it has a
// velocity, and no cell that it could flow into, beside it or below, is lower than its top. Cells that bodies cover are
// none. Empty where there is no such part.
std::vector<std::uint8_t> particles_at_rest(const Scene& scene);

// At each particle the weight of what its part has above it in a column of the width of a cell; zero in parts that rest
// on nothing, which fall. Liquid reaches round bodies: cells that bodies cover have the mean density of the row in that
// part, so that what they close off bears its own weight alone. `particles`: those of the scene, in its order.
Array<double> column_pressure(const Scene& scene, const ParticleStore& particles, const Array<std::int64_t>& phase);

}  // namespace spume
