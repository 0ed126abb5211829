// SPDX-License-Identifier: MIT
// Sums over the liquid beside edges of solids that do not depend on which side of a ray a neighbour stands.
//
// What a particle sees past an edge is seen once, but particles are points: one beside the limit of the shadow counts
// whole or not at all, or, with its reflection, twice. Differences of fields do not feel it, as the gradient correction
// does away with it; counts do: of a row of particles beside the edge of a pillar a column holds 4 % of a spacing more
// or less, and still water heaved there. So the surface counts in a box of free space around the particle, the largest
// one, which its sides mirror as if all of them were walls. A particle within half a spacing of a side that has free
// space behind it counts in part, as its volume lies in the box.
#pragma once

#include <array>
#include <span>

#include "spume/operators/pair_sweep.hpp"
#include "spume/scene/solid_union.hpp"

namespace spume {

// Around a particle, in absolute coordinates.
struct FreeBox {
  std::int32_t particle = 0;
  Vec3 place{}, lower{}, upper{};
};

// Of the box of a particle.
struct BoxMoments {
  float divergence_of_position = 0;
  std::array<float, 3> normal{};  // outward, times h
};

void box_moments(const SweepContext& context, const SolidUnion& solids, double spacing, std::span<const FreeBox> boxes,
                 std::span<BoxMoments> out);

}  // namespace spume
