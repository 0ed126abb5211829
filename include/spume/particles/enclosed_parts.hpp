// SPDX-License-Identifier: MIT
// Liquid that bodies enclose apart from the rest: the pressure in it is known up to a constant of its own, and the
// matrix of the pressure is singular once for each such part.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "spume/operators/pair_sweep.hpp"
#include "spume/solvers/part_constants.hpp"

namespace spume {

using PartMembers = std::vector<std::int32_t>;  // ascending

// The parts of the particles that meet as neighbours, in their list or as images, without one whose pressure
// `is_known`. `singular`: no pressure is known anywhere, and the largest part is the rest of PartConstants. `is_free`:
// asked of each of the parts then, where rows meet more than neighbours; empty: all are. A serial search, some 0.2 us a
// particle.
PartConstants enclosed_parts(const SweepContext& context, bool singular,
                             const std::function<bool(std::size_t)>& is_known,
                             const std::function<bool(const PartMembers&)>& is_free = {});

}  // namespace spume
