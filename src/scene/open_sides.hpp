// SPDX-License-Identifier: MIT
// Warnings of liquid that nothing holds: above an open bottom, or beside an open side.
#pragma once

#include <string>
#include <vector>

#include "spume/scene/draft.hpp"

namespace spume {

// With gravity: particles within a spacing of an open side other than the top, and those with nothing solid below them
// above an open bottom.
std::vector<Problem> open_side_warnings(const Draft& draft, const Scene& scene, const std::string& file);

}  // namespace spume
