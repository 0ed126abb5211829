// SPDX-License-Identifier: MIT
// The surfaces of bodies as a file for ParaView.
#pragma once

#include <filesystem>

#include "spume/scene/scene.hpp"

namespace spume {

// Writes the triangles of all bodies, of those without end as far as the domain, as VTK XML PolyData: points as 32-bit
// numbers; for every triangle `body`, the number of its [[body]] from 0, `wall` (0: none, 1: free-slip, 2: no-slip),
// `inside` and `subtract` (0 or 1). In two dimensions triangles fill the shapes. Throws FileError.
void write_body_surfaces(const std::filesystem::path& path, const Scene& scene);

}  // namespace spume
