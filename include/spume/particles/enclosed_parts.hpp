// SPDX-License-Identifier: MIT
// Liquid that bodies enclose apart from the rest: the pressure in it is known up to a constant of its own, and the
// matrix of the pressure is singular once for each such part.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "spume/operators/pair_sweep.hpp"

namespace spume {

struct EnclosedParts {
  std::vector<std::vector<std::int32_t>> parts;  // ascending in each
  bool all = true;                               // there is nothing beside them
};

// The parts of the particles that meet as neighbours, in their list or as images, without one whose pressure
// `is_known`, in the order of their first particles. One sweep over the lists, bit-identical for any thread count.
EnclosedParts enclosed_parts(const SweepContext& context, const std::function<bool(std::size_t)>& is_known);

}  // namespace spume
