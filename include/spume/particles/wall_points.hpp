// SPDX-License-Identifier: MIT
// Points inside the walls of bodies that stand for the liquid mirrored at them: in layers half a spacing, one and a
// half
// ... below the surface, as liquid stands above it, each with the volume of a particle.
//
// A lattice is cut into shells of one spacing along the distance from the surface; the points of a shell, which are as
// many as it has volume for, move to its middle and are evened out along it by the gradient of their concentration,
// together with shells on the side of the liquid.
#pragma once

#include <array>
#include <vector>

#include "spume/particles/resolution.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

struct WallPoint {
  Vec3 position{};
  Vec3 foot{}, normal{};  // on the surface, and out of the solid there
  Vec3 mirror{};          // as far before the foot as the position is behind it
  // Of a thin body (particles/thin_bodies.hpp): seen through the face of its foot alone, which may lie past the edge of
  // that in its plane; mirrored in the faces of a corner in turns; with another face of a thin body within the support
  // radius of the mirror.
  bool one_sided = false, past_edge = false, in_corner = false, beside_edge = false;
  bool flat = false;  // no other face is, and this one is flat
  // What faces of thin bodies that meet turn about the corner between them: seen by ways that enter one of these, too.
  bool turned = false;
  // Of a one-sided point: of the cosine of the angle between the normal and that of a place of the surface where what
  // enters sees the point.
  float least_cosine = 0;

  // Where a way to the point leads on from the face that it is seen through; of other points what they mirror.
  Vec3 unfolded() const {
    if (!one_sided) return mirror;
    double before = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) before += (foot[axis] - position[axis]) * normal[axis];
    Vec3 place = position;
    for (std::size_t axis = 0; axis < 3; ++axis) place[axis] += 2 * before * normal[axis];
    return place;
  }
};

// Down to the support radius below the walls, as far as liquid may see: inside the domain, and beyond its open sides.
// Sides that are walls or periodic have images of what lies inside.
std::vector<WallPoint> make_wall_points(const Combination& walls, const Domain& domain, const Resolution& resolution,
                                        double particle_volume);

}  // namespace spume
