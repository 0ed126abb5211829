// SPDX-License-Identifier: MIT
// Volume, centroid and inertia of a solid.
#pragma once

#include "spume/geometry/rigid_place.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume {

// Of a uniform density of one; the inertia is that about the centroid. In two dimensions per length.
struct SolidMoments {
  double volume = 0;
  Vec3 centroid{};
  RotationMatrix inertia{};
};

// By the middles of a lattice over the bounds, which are finite. Cells that the surface passes count by the distance
// of their middle: the area of a disc is found within 1e-4, that of a box, for its corners, within 6e-4.
SolidMoments moments_of(const Combination& solid, const Bounds& bounds, int dimensions);

// That of a mass about a point `away` from its centroid (Steiner).
RotationMatrix inertia_about(const RotationMatrix& central, double mass, const Vec3& away);

}  // namespace spume
