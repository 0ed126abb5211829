// SPDX-License-Identifier: MIT
#pragma once

#include "spume/scene/scene.hpp"

namespace spume {

// Whether walls of bodies, or openings, stand in a scene.
bool has_wall_points(const Scene& scene);

// [[solid]] boxes become bodies of the same kind of wall, named "solid.0" and so on, behind all others: a place that
// they share with another body is of the nearer surface. Faces in sides of the domain are taken beyond them.
void make_bodies_of_boxes(Scene& scene);

}  // namespace spume
