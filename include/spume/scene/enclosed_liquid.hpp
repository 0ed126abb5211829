// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "spume/scene/scene.hpp"

namespace spume {

// A place in liquid that fills a chamber between solid boxes and walls, where other liquid is: such liquid has no free
// surface, and the pressure of an incompressible one is known up to a constant of its own. Nothing where there is none,
// and where all liquid fills one domain. Chambers that periodic sides bound are not looked for.
std::optional<Vec3> enclosed_liquid(const Scene& scene);

}  // namespace spume
