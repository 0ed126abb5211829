// SPDX-License-Identifier: MIT
#include "spume/particles/bounded_shift.hpp"

#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {

void BoundedShift::find(std::size_t first, std::size_t last) const {
  const std::size_t n = last - first;
  const double against = -strength, bound2 = bound * bound;
  std::array<double, default_block> factor{};  // before that the square of the speed
  for (int axis = 0; axis < dimensions; ++axis) {
    const float* const c = concentration[axis] + first;
    for (std::size_t k = 0; k < n; ++k) factor[k] += (against * c[k]) * (against * c[k]);
  }
  for (std::size_t k = 0; k < n; ++k) factor[k] = factor[k] > bound2 ? bound / std::sqrt(factor[k]) : 1;
  for (std::size_t k = 0; k < n && left_out != nullptr; ++k)
    if (left_out[first + k] >= 0) factor[k] = 0;
  for (int axis = 0; axis < dimensions; ++axis) {
    const float* const c = concentration[axis] + first;
    float* const moved = shift[axis] + first;
#pragma GCC ivdep
    for (std::size_t k = 0; k < n; ++k) moved[k] = static_cast<float>(factor[k] * (against * c[k]));
  }
}

}  // namespace spume
