// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "mesh_polygons.hpp"

namespace spume {

inline constexpr std::uintmax_t largest_mesh_file = std::uintmax_t{2} << 30;  // 40 million triangles of binary STL

// The faces of a PLY file, text or binary, also as gzip leaves it. It is read here and not by assimp, which goes on for
// minutes when a count in the file is damaged. Throws InputError with the reason.
PolygonMesh read_ply(const std::string& path);

}  // namespace spume
