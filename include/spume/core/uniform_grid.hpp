// SPDX-License-Identifier: MIT
// A uniform Cartesian grid of cell centres over a box, in two or three dimensions.
#pragma once

#include <array>
#include <cstddef>

namespace spume {

// Point (i, j, k) lies at lower + (i + 1/2, j + 1/2, k + 1/2) * spacing and is stored at i + nx (j + ny k): x varies
// fastest. In two dimensions points[2] is 1 and the third entries of lower and upper are not read.
struct UniformGrid {
  int dimensions = 3;
  std::array<double, 3> lower{}, upper{};
  std::array<std::size_t, 3> points{1, 1, 1};

  std::size_t size() const { return points[0] * points[1] * points[2]; }
  double length(int axis) const { return upper[axis] - lower[axis]; }
  double spacing(int axis) const { return length(axis) / static_cast<double>(points[axis]); }
  double coordinate(int axis, std::size_t i) const {
    return lower[axis] + (static_cast<double>(i) + 0.5) * spacing(axis);
  }
  std::size_t index(std::size_t i, std::size_t j, std::size_t k = 0) const {
    return i + points[0] * (j + points[1] * k);
  }
};

// Throws InputError, naming the finding, when the grid has no points, a length is not positive and finite, or the
// number of dimensions is neither 2 nor 3.
void require_valid(const UniformGrid& grid);

}  // namespace spume
