// SPDX-License-Identifier: MIT
#include "moving_least_squares_fit.hpp"

namespace spume {

template class MovingLeastSquares<2>;

}  // namespace spume
