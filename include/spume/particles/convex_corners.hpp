// SPDX-License-Identifier: MIT
// Places where a solid ends in an edge or a corner that sticks out, told from round ones by the exact surface.
#pragma once

#include "spume/geometry/shape.hpp"

namespace spume {

class RigidWalls;

struct ConvexCorner {
  enum class Kind { none, edge, corner };
  Kind kind = Kind::none;
  Vec3 along{};  // the edge, of length 1
};

// At a point of the surface. A corner is what is nearest to all directions within 0.1 rad of one of them; an edge is
// that across itself alone: the surface turns there by more than 0.2 rad, as facets of a prism of 31 sides do. A wall
// that turns less, facets of it longer than a spacing included, is a round one. `outwards`: about the normal there, as
// pieces of the surface have it; `spacing`: other walls within a tenth of it hide the corner.
ConvexCorner convex_corner(const RigidWalls& walls, const Vec3& point, const Vec3& outwards, double spacing,
                           int dimensions);

}  // namespace spume
