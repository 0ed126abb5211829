// SPDX-License-Identifier: MIT
// Points in shells along the surface of walls, half a spacing, one and a half ... from it.
#pragma once

#include <cstdint>
#include <vector>

#include "spume/geometry/shapes.hpp"
#include "spume/particles/resolution.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

struct ShellPoint {
  Vec3 place{};
  double distance = 0;       // from the surface, of the middle of its shell; negative inside the solid
  std::int32_t corner = -1;  // number among corners that even_out_in_corners() is given; -1: in none
};

// A shell is as deep as a spacing and has a point for every volume of a particle, evenly along the surface, as far as
// the support radius. `outside`: shells outside the solid alone, with a point for every volume of a particle where they
// are mirrored at the surface.
std::vector<ShellPoint> make_shells(const Combination& walls, const Domain& domain, const Resolution& resolution,
                                    double particle_volume, bool outside);

// A plane, by a point of it and the normal.
struct CornerPlane {
  Vec3 point{}, normal{};
};

// Evens shells outside a solid out once more where faces make corners, each given by their planes: points there are
// then as far from a face as if the shells went on behind it mirrored. Without what lies behind the second face of a
// corner two points end at one place in it.
void even_out_in_corners(const Combination& walls, const Domain& domain, const Resolution& resolution,
                         double particle_volume, const std::vector<std::vector<CornerPlane>>& corners,
                         std::vector<ShellPoint>& shells);

// What a piece of a shell at a place before a surface is when it is mirrored at it, as a share: |1 - 2 s H| with the
// distance s and the second derivatives H of the distance along the surface; 1 before planes and edges, 0 where the
// normals cross before they are there. By differences of normals over a quarter of a spacing, of two sides the smaller,
// so that a plane ends where its edge does. `edge`: the place is before an edge or a corner.
struct MirroredShare {
  double share = 1;
  bool edge = false;
};
MirroredShare mirrored_share(const Combination& walls, const NearestPoint& near, const Vec3& place, double spacing,
                             int dimensions);

}  // namespace spume
