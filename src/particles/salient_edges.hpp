// SPDX-License-Identifier: MIT
#pragma once

#include "spume/particles/boundary.hpp"

namespace spume {

// Whether a box or a body nearer than `reach` to a point that lies in the liquid bends away from it: a box has an edge
// within `reach` along every axis that the liquid goes around; a body falls away from its tangent plane at the point
// nearest to `point`, seen along both directions of the plane `reach` away, by more than a fifth of `reach`. An edge
// that turns by the angle a is seen from within reach (1 - 0.2 / sin a) of it, 0.8 reach at a right angle, a round wall
// where its radius is below 2.5 reach. Flat and hollow walls are none, nor is where a body ends on a side of the
// domain.
bool salient_edge_near(const Boundary& boundary, const Vec3& point, double reach, int dimensions);

}  // namespace spume
