// SPDX-License-Identifier: MIT
// Warnings of liquid that nothing holds: above an open bottom, or beside an open side; and of outflows that are to fill
// a tank.
#pragma once

#include <string>
#include <vector>

#include "spume/scene/draft.hpp"

namespace spume {

// With gravity: particles within a spacing of an open side other than the top, and those with nothing solid below them
// above an open bottom. Without gravity: particles within a spacing of the part of a side that is open around an
// opening, where what enters spreads out.
std::vector<Problem> open_side_warnings(const Draft& draft, const Scene& scene, const std::string& file);

// Below a free surface: outflows whose level stands a spacing above the liquid of the start before them, at some time.
// What comes in at the surface breaks up: a level that rose by 4 cm in 4 s beside a tank of 26 cm in spacings of 1 cm
// was left behind, and the run ended.
std::vector<Problem> outflow_warnings(const Draft& draft, const Scene& scene, const std::string& file);

}  // namespace spume
