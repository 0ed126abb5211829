// SPDX-License-Identifier: MIT
// How fast a flow will be, from its scene.
#pragma once

#include "spume/scene/scene.hpp"

namespace spume {

// The largest of free fall through the domain, the work of the forces along its longest side, the first velocities, the
// speeds of walls and of bodies until `end`, and of what tension drives, sqrt(sigma kappa / rho) of a round drop of the
// smallest phase, rho the largest density: the pressure in that drop is then rho U^2. 0: nothing tells. Without `falls`
// gravity tells nothing but along periodic axes: it does not move a liquid that fills its tank alone.
double expected_speed(const Scene& scene, double end, bool falls = true);

}  // namespace spume
