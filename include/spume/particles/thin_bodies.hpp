// SPDX-License-Identifier: MIT
// Bodies so thin that what mirrors the liquid before one of their faces does not fit behind it: their solid is nowhere
// deeper than the support radius, most of their surface is flat, which a ball of a few spacings is not, and they are
// twice as long as thick or thinner than a support radius.
//
// Wall points of such a body stand behind each of its faces as if the solid went on there, through the body and the
// liquid beyond: mirror images of places before the face, and of places past its edges in the plane of the face. What
// stands before the face sees them there in place of what the body hides (particles/thin_walls.hpp). In a corner of two
// faces a place is mirrored in both in turns, as long as its image is before the next face, and the face that is last
// is that which it is seen through: at any angle from 45 degrees on every place behind the corner then mirrors one
// before it. Images that both orders have, as at right angles, are one and seen where the place is.
#pragma once

#include <cstdint>
#include <vector>

#include "spume/particles/wall_points.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

// One per body of the scene. Bodies that are released, and those that others are taken away from, are not looked at.
std::vector<std::uint8_t> find_thin_bodies(const Scene& scene, const Resolution& resolution);

// A body that is a wall, as it stands in what moves as one.
struct StandingBody {
  ShapePointer solid;
  bool thin = false;
};

// A point and the body that it belongs to, among those given: the one of the face that it is seen through, of points in
// the corner of several the last. The nearest to its foot may be another, past an edge.
struct SheetPoint : WallPoint {
  std::size_t body = 0;
};

// Wall points of the thin ones of `bodies`, whose union is `walls`, and those in corners of their faces and with other
// bodies, of thick ones at 45 degrees or more.
std::vector<SheetPoint> make_sheet_points(const std::vector<StandingBody>& bodies, const Combination& walls,
                                          const Domain& domain, const Resolution& resolution, double particle_volume);

}  // namespace spume
