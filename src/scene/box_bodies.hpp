// SPDX-License-Identifier: MIT
#pragma once

#include "spume/scene/scene.hpp"

namespace spume {

// In spacings: bodies and their copies that come as near to a periodic side, and boxes that reach a side, are seen so
// far beyond it, which is more than liquid sees.
inline constexpr double beyond_side = 10;

// Whether walls of bodies, or openings, stand in a scene.
bool has_wall_points(const Scene& scene);

// Whether a liquid that fills its domain is better off with bodies than with boxes: where streams part from edges the
// images of boxes leave particles without neighbours. Boxes thinner than a spacing part their sides by images alone.
bool boxes_stand_in_full_domain(const Scene& scene);

// [[solid]] boxes become bodies of the same kind of wall, named "solid.0" and so on, behind all others: a place that
// they share with another body is of the nearer surface. Faces in sides of the domain are taken beyond them.
void make_bodies_of_boxes(Scene& scene);

}  // namespace spume
