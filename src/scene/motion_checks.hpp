// SPDX-License-Identifier: MIT
// What can be told of moving walls, bodies and inflows only beside the filled scene.
#pragma once

#include <string>
#include <vector>

#include "spume/scene/draft.hpp"

namespace spume {

// Surfaces and inflows that are too fast for the sound speed of the liquid, and walls that press a tank which is full,
// closed and incompressible.
void check_motions(const Draft& draft, const Scene& scene, bool one_liquid, Problems& problems);

// Sides that move along their normal, which the method takes to slide along themselves alone.
void check_sliding_walls(const Draft& draft, const Scene& scene, const std::string& method, Problems& problems);

// Bodies whose given motion leads into another body or through a wall of the domain, and those at rest that a wall of
// the domain bares as it moves off.
std::vector<Problem> collision_warnings(const Draft& draft, const Scene& scene, const std::string& file);

}  // namespace spume
