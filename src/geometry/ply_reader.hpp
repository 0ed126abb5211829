// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "mesh_polygons.hpp"

namespace spume {

// The faces of a PLY file, text or binary. It is read here and not by assimp, which goes on for minutes when a count in
// the file is damaged. Throws InputError with the reason.
PolygonMesh read_ply(const std::string& path);

}  // namespace spume
