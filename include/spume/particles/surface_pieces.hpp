// SPDX-License-Identifier: MIT
// The surface of a body in pieces of about a spacing, where the body stands at the start.
#pragma once

#include <vector>

#include "spume/scene/scene.hpp"

namespace spume {

struct SurfacePiece {
  std::array<Vec3, 3> corner{};  // in two dimensions the first two, counter-clockwise around the shape
  Vec3 middle{}, area{};         // area times the normal out of the shape
};

// As far as the domain reaches; of a body that moves a diagonal of the domain farther.
std::vector<SurfacePiece> surface_pieces(const Domain& domain, const Body& body, double spacing);

}  // namespace spume
