// SPDX-License-Identifier: MIT
// Bodies given by triangles.
#pragma once

#include <string>
#include <vector>

#include "spume/geometry/shape.hpp"

namespace spume {

// The triangles of an STL, OBJ (by assimp) or PLY file (also .ply.gz) in its order; polygons are cut into triangles,
// corners at the same place are one point. Throws InputError with the reason when the file is missing, damaged, too
// large, of another kind or empty.
TriangleSurface read_mesh(const std::string& path);

// What keeps triangles from bounding a solid, each fault with the number and the place of its first triangle and the
// fix; triangles count from 1, as in the file. Faults: a triangle without area, an edge at a hole, a triangle turned
// over against its neighbours, an edge of more than two triangles, a part that is inside out, parts that cross. Faces
// of one part that cross each other are not looked for.
std::vector<std::string> mesh_faults(const TriangleSurface& surface);

// The solid within triangles without faults. The distance is exact: the nearest triangle from a tree of boxes, the sign
// from the angle-weighted normal of the nearest face, edge or corner (J. A. Baerentzen and H. Aanaes, Signed distance
// computation using the angle weighted pseudonormal, IEEE TVCG 11, 2005).
ShapePointer make_mesh(TriangleSurface surface);

// The volume within closed triangles; negative when they are inside out.
double enclosed_volume(const TriangleSurface& surface);

}  // namespace spume
