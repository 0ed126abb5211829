// SPDX-License-Identifier: MIT
#include "spume/neighbours/periodic_cells.hpp"

#include <algorithm>
#include <cmath>

namespace spume {

PeriodicCells PeriodicCells::with_side(const std::array<double, 3>& lower, const std::array<double, 3>& length,
                                       double least_side, double most_cells) {
  PeriodicCells cells{lower, length, {1, 1, 1}};
  // An axis shorter than the side has one cell whatever the side: the others share the cells out.
  double side = least_side;
  for (int pass = 0; pass < 3; ++pass) {
    double measure = 1;
    int divided = 0;
    for (const double l : length)
      if (l >= side) measure *= l, ++divided;
    const double share = measure / std::max(most_cells, 1.0);
    side = std::max(side, divided == 3 ? std::cbrt(share) : (divided == 2 ? std::sqrt(share) : share));
  }
  for (int axis = 0; axis < 3; ++axis)
    cells.count[axis] = static_cast<int>(std::clamp(std::floor(length[axis] / side), 1.0, 32768.0));
  return cells;
}

}  // namespace spume
