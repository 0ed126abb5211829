// SPDX-License-Identifier: MIT
#include "spume/particles/moving_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace spume {
namespace {

// In spacings: a disc of 14 spacings across then marks a third more than its area.
constexpr double cell_width = 4;

}  // namespace

MovingBounds::MovingBounds(const Domain& domain, double spacing, double margin)
    : dimensions_(domain.dimensions), margin_(margin), lower_(domain.lower) {
  std::size_t cells = 1;
  for (int axis = 0; axis < dimensions_; ++axis) {
    const double length = domain.upper[axis] - domain.lower[axis];
    count_[axis] = static_cast<std::size_t>(std::max(1.0, std::ceil(length / (cell_width * spacing))));
    inverse_width_[axis] = static_cast<double>(count_[axis]) / length;
    periodic_[axis] = domain.periodic(axis);
    cells *= count_[axis];
  }
  first_.resize(cells, -1);
}

void MovingBounds::clear() {
  std::fill(first_.begin(), first_.end(), -1);
  marks_.clear();
}

void MovingBounds::mark(const Bounds& box, std::size_t body) {
  std::array<std::ptrdiff_t, 3> first{}, last{};
  for (int axis = 0; axis < dimensions_; ++axis) {
    const auto count = static_cast<std::ptrdiff_t>(count_[axis]);
    const double low = (box.lower[axis] - margin_ - lower_[axis]) * inverse_width_[axis],
                 high = (box.upper[axis] + margin_ - lower_[axis]) * inverse_width_[axis];
    // Rounding may put a point into the cell beside the one that its bound is in.
    constexpr double slack = 1e-9;
    const bool whole = periodic_[axis] ? high - low + 2 * slack >= static_cast<double>(count)
                                       : !(low > slack) && !(high < static_cast<double>(count) - slack);
    if (whole) {
      first[axis] = 0;
      last[axis] = count - 1;
      continue;
    }
    if (!periodic_[axis] && (high < -slack || low > static_cast<double>(count) + slack)) return;
    first[axis] = static_cast<std::ptrdiff_t>(std::floor(std::max(low, periodic_[axis] ? low : 0.0) - slack));
    last[axis] = static_cast<std::ptrdiff_t>(
        std::floor(std::min(high, periodic_[axis] ? high : static_cast<double>(count)) + slack));
    if (!periodic_[axis]) {
      first[axis] = std::clamp<std::ptrdiff_t>(first[axis], 0, count - 1);
      last[axis] = std::clamp<std::ptrdiff_t>(last[axis], 0, count - 1);
    }
  }
  const auto wrapped = [&](std::ptrdiff_t cell, int axis) {
    const auto count = static_cast<std::ptrdiff_t>(count_[axis]);
    return static_cast<std::size_t>((cell % count + count) % count);
  };
  for (std::ptrdiff_t k = first[2]; k <= last[2]; ++k)
    for (std::ptrdiff_t j = first[1]; j <= last[1]; ++j)
      for (std::ptrdiff_t i = first[0]; i <= last[0]; ++i) {
        std::int32_t& top = first_[(wrapped(k, 2) * count_[1] + wrapped(j, 1)) * count_[0] + wrapped(i, 0)];
        // A box longer than a period comes to the same cell twice.
        if (top >= 0 && marks_[static_cast<std::size_t>(top)].body == static_cast<std::int32_t>(body)) continue;
        marks_.push_back({static_cast<std::int32_t>(body), top});
        top = static_cast<std::int32_t>(marks_.size()) - 1;
      }
}

}  // namespace spume
