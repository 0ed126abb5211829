// SPDX-License-Identifier: MIT
// From the [[inflow]] and [[outflow]] entries of a case to the openings of the scene.
#pragma once

#include <vector>

#include "spume/scene/draft.hpp"
#include "spume/scene/option.hpp"

namespace spume {

// Sides, corners, and what tells how liquid passes.
void check_openings(const Draft& draft, Problems& problems);

std::vector<Opening> make_openings(const Draft& draft, const CompileExpression& compile, Problems& problems);

// Sides that an opening covers wholly are no walls, whatever [domain] says.
void open_sides_at(const std::vector<Opening>& openings, Domain& domain);

// What can be told only of the filled scene: a velocity that leads out of the domain at an inflow, a closed tank that
// is filled, an outflow of an incompressible liquid that nothing enters.
void check_openings_of(const Draft& draft, const Scene& scene, double particle_volume, Problems& problems);

}  // namespace spume
