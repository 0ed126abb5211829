// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "spume/core/vec3.hpp"

namespace spume {

// Faces as they stand in a file, by the numbers of their corners from 0, which are not yet checked.
struct PolygonMesh {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
};

}  // namespace spume
