// SPDX-License-Identifier: MIT
// The sections [bubbles], [[sparger]] and [[bubble_cloud]] and what they must satisfy. A method that carries bubbles
// names them in its registration and calls the checks in its own.
#pragma once

#include <vector>

#include "spume/scene/bubbles.hpp"

namespace spume {

struct Draft;
class Problems;
struct Scene;
struct Section;

// Density of the gas of a case in SI that gives none, kg/m3: air at 20 C.
inline constexpr double air_density = 1.2;
// The state of so many bubbles alone takes 14 GB, 136 bytes each.
inline constexpr double most_bubbles_of_a_cloud = 1e8;

std::vector<Section> bubble_sections();

// Gas and liquid, radii against the spacing, sources inside the domain; completes BubbleOptions.
void check_bubbles(Draft& draft, Problems& problems);

// What can be told of spargers and clouds only beside the compiled rates and the initial liquid.
void check_bubble_sources(const Draft& draft, const Scene& scene, Problems& problems);

}  // namespace spume
