// SPDX-License-Identifier: MIT
// The pressure of layers at rest.
#pragma once

#include "spume/particles/store.hpp"

namespace spume {

// Gravity along the axes that sides bound.
Vec3 gravity_across_sides(const Scene& scene);

// Whether gravity points down a closed tank in which every phase lies wholly above the heavier ones: then the pressure
// below is that at rest.
bool lie_in_layers(const Scene& scene);

// At each particle the weight of what is above it in a column of the width of a spacing. Liquid reaches round bodies:
// cells without particles then have the mean density of their row.
Array<double> column_pressure(const Scene& scene, const ParticleStore& particles, const Array<std::int64_t>& phase);

}  // namespace spume
