// SPDX-License-Identifier: MIT
#pragma once

#include <array>

namespace spume::detail {

// Below which a fit of order 0, 1 and 2 falls back to the order below; moving_least_squares.hpp has the values of
// lattices and surfaces that these stand below.
constexpr std::array<double, 3> least_reciprocal_condition{0, 1e-3, 2e-4};

}  // namespace spume::detail
