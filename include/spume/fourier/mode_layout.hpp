// SPDX-License-Identifier: MIT
// How the Fourier modes of a real field on a periodic box lie in memory.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

namespace spume {

// Transforms work on blocks of this many neighbouring modes (128 bytes), which stand side by side in vector registers.
template <class T>
inline constexpr std::size_t lanes = 128 / sizeof(std::complex<T>);

// A field u(x) = sum_k u_k exp(i k.x) on nx x ny x nz points (even), coefficients scaled so that u_0 is the mean.
// Stored are the modes with 0 <= k_z < nz/2; those with k_z < 0 are their conjugates. Mode (ix, iy, iz) lies at
// ix * plane + iy * row + iz; indices above n/2 along x and y stand for negative wavenumbers. Modes at the largest
// wavenumber of an axis (index n/2), which have no partner, and the entries iz >= nz/2 are zero.
struct ModeLayout {
  std::array<std::size_t, 3> points{};
  std::array<double, 3> lengths{};
  std::size_t modes_z = 0;                        // stored along z: nz / 2
  std::size_t row = 0;                            // modes_z rounded up to whole blocks
  std::size_t plane = 0;                          // ny rows and a block more, off powers of two
  std::array<std::vector<double>, 3> wavenumber;  // by index along the axis; 0 at n/2

  std::size_t size() const { return points[0] * plane; }
  double point_count() const {
    return static_cast<double>(points[0]) * static_cast<double>(points[1]) * static_cast<double>(points[2]);
  }
  // Of the stored and the conjugate mode together, in sums over all modes.
  static double weight(std::size_t iz) { return iz == 0 ? 1.0 : 2.0; }
  double unit(std::size_t axis) const { return 2 * std::numbers::pi / lengths[axis]; }
  double largest_wavenumber(std::size_t axis) const { return unit(axis) * (static_cast<double>(points[axis]) / 2 - 1); }
};

// Precondition: points even and at least 4, lengths above 0.
template <class T>
ModeLayout make_mode_layout(const std::array<std::size_t, 3>& points, const std::array<double, 3>& lengths) {
  ModeLayout layout;
  layout.points = points;
  layout.lengths = lengths;
  layout.modes_z = points[2] / 2;
  layout.row = (layout.modes_z + lanes<T> - 1) / lanes<T> * lanes<T>;
  layout.plane = points[1] * layout.row + lanes<T>;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t n = points[axis];
    const std::size_t stored = axis == 2 ? layout.row : n;
    layout.wavenumber[axis].assign(stored, 0.0);
    for (std::size_t i = 0; i < stored; ++i) {
      if (axis == 2 ? i >= layout.modes_z : i == n / 2) continue;
      const double index = i < n / 2 ? static_cast<double>(i) : static_cast<double>(i) - static_cast<double>(n);
      layout.wavenumber[axis][i] = index * layout.unit(axis);
    }
  }
  return layout;
}

}  // namespace spume
