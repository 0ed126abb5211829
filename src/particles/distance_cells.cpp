// SPDX-License-Identifier: MIT
#include "spume/particles/distance_cells.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {

DistanceCells::DistanceCells(const Combination& walls, int dimensions, const Vec3& lower, const Vec3& upper,
                             double spacing, double support_radius, double error)
    : walls_(walls), dimensions_(dimensions), cell_(2 * support_radius), fine_(spacing) {
  for (int axis = 0; axis < dimensions; ++axis) {
    lower_[axis] = lower[axis] - cell_;
    cells_[axis] = static_cast<std::size_t>(std::ceil((upper[axis] - lower_[axis]) / cell_)) + 1;
    fine_lower_[axis] = lower[axis];
    fine_cells_[axis] = static_cast<std::size_t>(std::ceil((upper[axis] - lower[axis]) / fine_));
  }
  fill(middle_, cells_, lower_, cell_, [&](const Vec3& place) { return walls_.distance(place); });
  // Half a diagonal, what rounding to float takes, and what interpolated distances are off by.
  const double off = (0.5 * std::sqrt(static_cast<double>(dimensions)) + 1e-3) * fine_ + error;
  fill(least_, fine_cells_, fine_lower_, fine_, [&](const Vec3& place) { return distance(place) - off; });
}

template <class Value>
void DistanceCells::fill(std::vector<float>& values, const std::array<std::size_t, 3>& count, const Vec3& lower,
                         double side, Value&& value) const {
  values.resize(count[0] * count[1] * count[2]);
  parallel_blocks(count[1] * count[2], 1, [&](std::size_t row, std::size_t, std::size_t) {
    const std::size_t j = row % count[1], k = row / count[1];
    for (std::size_t i = 0; i < count[0]; ++i) {
      const Vec3 place{lower[0] + (static_cast<double>(i) + 0.5) * side,
                       lower[1] + (static_cast<double>(j) + 0.5) * side,
                       dimensions_ == 3 ? lower[2] + (static_cast<double>(k) + 0.5) * side : 0.0};
      values[row * count[0] + i] = static_cast<float>(value(place));
    }
  });
}

double DistanceCells::distance(const Vec3& point) const {
  std::array<std::size_t, 3> at{};
  double outside = 0;  // of the cells, along one axis at most
  for (int axis = 0; axis < dimensions_; ++axis) {
    const double cell = (point[axis] - lower_[axis]) / cell_;
    const double inside = std::clamp(cell, 0.0, static_cast<double>(cells_[axis]) - 0.5);
    outside = std::max(outside, std::abs(cell - inside));
    at[axis] = static_cast<std::size_t>(inside);
  }
  const double middle = middle_[(at[2] * cells_[1] + at[1]) * cells_[0] + at[0]];
  // Half the diagonal of a cell, and the reach of whoever asks.
  const double half = 0.5 * std::sqrt(static_cast<double>(dimensions_)) * cell_;
  if (outside == 0 && std::abs(middle) > half + 2 * cell_) return std::copysign(std::abs(middle) - half, middle);
  return walls_.distance(point);
}

double DistanceCells::least(const Vec3& point) const {
  std::array<std::size_t, 3> at{};
  for (int axis = 0; axis < dimensions_; ++axis) {
    const double cell = (point[axis] - fine_lower_[axis]) / fine_;
    if (!(cell >= 0 && cell < static_cast<double>(fine_cells_[axis]))) return -infinite;
    at[axis] = static_cast<std::size_t>(cell);
  }
  return least_[(at[2] * fine_cells_[1] + at[1]) * fine_cells_[0] + at[0]];
}

double DistanceCells::bytes() const {
  return static_cast<double>(4 * (middle_.capacity() + least_.capacity()));
}

}  // namespace spume
