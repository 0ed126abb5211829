// SPDX-License-Identifier: MIT
// Slots between parallel faces too narrow for a particle, which stands half a spacing from walls: nothing fills them,
// and what comes near is led out (particles/pockets.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spume/scene/case.hpp"
#include "spume/scene/draft.hpp"

namespace spume {

// Spacings: as in particles/pockets.hpp, less what rounding makes of it.
inline constexpr double too_narrow = 0.5 * (1 - 1e-6);

// Of the slot that a place before the walls is in, the width, if the face across is nearer to the wall than `width`:
// another wall, or a side of the domain.
struct SlotWidth {
  double width = 0;
  bool beside_side = false;
};
std::optional<SlotWidth> slot_at(const Combination& walls, const Domain& domain, const Vec3& place, double width);

// Slots that bodies leave at the start.
std::vector<Problem> slot_warnings(const Draft& draft, const Scene& scene, const std::string& file);

}  // namespace spume
