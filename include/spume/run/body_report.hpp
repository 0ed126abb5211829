// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "spume/scene/scene.hpp"

namespace spume {

// A line for each body of a scene: name, kind, what it is for, bounds, volume (area in two dimensions) of its shape,
// and how many particles its solid has room for within the domain; with an error of its distances where they have one.
// Counted on the lattice of the spacing, or a coarser one of a million points, cells at the surface by their distance.
std::string body_table(const Scene& scene);

}  // namespace spume
