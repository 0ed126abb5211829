// SPDX-License-Identifier: MIT
// Regions of phases that are too thin for their interfaces to be told apart.
#pragma once

#include <cstddef>
#include <vector>

#include "spume/scene/scene.hpp"

namespace spume {

struct ThinRegion {
  std::size_t region = 0;  // of InitialParticles::region
  double width = 0;        // where it is widest
};

// Regions that hold particles and are nowhere as wide as `width`, in their order. The width is twice the distance of
// the particle that is farthest from other phases to the nearest of them, less a spacing: n spacings in a layer of n
// rows, n - 1 where n is even and no row is in the middle. Regions go on behind mirrors and periodic sides. Of one
// phase: none.
std::vector<ThinRegion> thin_regions(const Scene& scene, double width);

}  // namespace spume
