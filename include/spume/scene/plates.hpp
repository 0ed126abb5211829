// SPDX-License-Identifier: MIT
// How thick solids are: what thin bodies (particles/thin_bodies.hpp) and the warning of bodies that are none take for
// plates.
#pragma once

#include "spume/scene/scene.hpp"

namespace spume {

// Spacings: the support radius of the standard kernel.
constexpr double standard_support = 2.6;

// Where liquid can meet a body: all of one that moves, else its part in the domain, and `reach` around it.
Bounds window_around(const Scene& scene, const Body& body, double reach);

// Nowhere deeper than `reach`, and thinner than `reach` or twice as long as thick. Of a body that stands still the part
// in the domain is as long as counts. By a lattice of half a spacing, the deepest place then by its surroundings.
bool is_plate(const Scene& scene, const Body& body, double spacing, double reach);

}  // namespace spume
