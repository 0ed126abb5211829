// SPDX-License-Identifier: MIT
// Where a straight way first enters a wall: steps as long as the distance from all walls, which none can be within
// (J. C. Hart, Visual Computer 12 (1996), sphere tracing), and at least `least` long: what is thinner may be missed.
#pragma once

#include <algorithm>
#include <optional>

#include "spume/core/vectors.hpp"

namespace spume {

// The first place visited of which `enters` holds. `distance`: from the walls, signed or a bound of it.
template <class Distance, class Enters>
std::optional<Vec3> way_to_wall(const Vec3& from, const Vec3& way, double least, const Distance& distance,
                                const Enters& enters) {
  const double size = length(way);
  for (double gone = 0; size > 0;) {
    const Vec3 place = add(from, multiply(gone / size, way));
    if (enters(place)) return place;
    if (gone >= size) break;
    gone = std::min(size, gone + std::max(least, distance(place)));
  }
  return std::nullopt;
}

}  // namespace spume
