// SPDX-License-Identifier: MIT
// A uniform grid of points over a triply periodic box, as transforms store it: x slowest, z fastest.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace spume {

// Point (i, j, k) lies at lower + (i Lx / nx, j Ly / ny, k Lz / nz) and is stored at (i ny + j) z_stride + k,
// with z_stride >= nz.
struct PeriodicGrid {
  std::array<double, 3> lower{}, length{};
  std::array<int, 3> points{1, 1, 1};
  std::size_t z_stride = 1;

  double spacing(int axis) const { return length[axis] / points[axis]; }
  double inverse_spacing(int axis) const { return points[axis] / length[axis]; }
  double cell_volume() const { return spacing(0) * spacing(1) * spacing(2); }
  std::size_t point_count() const { return std::size_t(points[0]) * std::size_t(points[1]) * std::size_t(points[2]); }
  std::size_t storage() const { return std::size_t(points[0]) * std::size_t(points[1]) * z_stride; }
  std::size_t row(int i, int j) const { return (std::size_t(i) * std::size_t(points[1]) + std::size_t(j)) * z_stride; }
};

// x moved by whole lengths into [lower, lower + length). Not-a-number stays what it is.
inline double wrap_periodic(double x, double lower, double length) {
  const double offset = x - lower;
  if (offset >= 0 && offset < length) return x;
  const double wrapped = x - length * std::floor(offset / length);
  // Rounding may land a point just below `lower` on the upper end.
  if (wrapped - lower >= length) return lower;
  return wrapped < lower ? lower : wrapped;
}

// d moved by whole lengths to the nearest image. Odd in d, bit for bit.
inline double nearest_image(double d, double length) {
  return d - length * std::nearbyint(d / length);
}

}  // namespace spume
