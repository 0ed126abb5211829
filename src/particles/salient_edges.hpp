// SPDX-License-Identifier: MIT
#pragma once

#include "spume/particles/boundary.hpp"

namespace spume {

// Whether a box or a body nearer than `reach` to a point that lies in the liquid bends away from it. A box does where
// its face before the point ends within 0.8 `reach` along an axis and liquid goes on. A body does where it falls away
// by more than a fifth of `reach` from the plane that touches it at the point nearest to `point`: seen `reach` away
// both ways (2-D), or in eight directions of the plane (3-D). An edge that turns by an angle a up to 90 degrees is seen
// from within reach (1 - 0.2 / sin a) of it, 0.8 reach at a right angle (0.72 in space, between two of
// the eight directions), a round wall where its radius is below 2.4
// reach. Flat and hollow walls are none, nor is where a body ends on a side of the domain. Across a
// slot that is narrower than the reach the next wall is seen there in place of the fall: edges of slots of 3 to 5
// spacings are missed in part.
bool salient_edge_near(const Boundary& boundary, const Vec3& point, double reach, int dimensions);

}  // namespace spume
