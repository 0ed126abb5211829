// SPDX-License-Identifier: MIT
// Two snapshots of a vector field on a periodic grid, packed for interpolation at particles by B-splines.
//
// The three components of a point lie side by side, padded to four, and the two snapshots behind each other: one or two
// loads fetch all that a point adds. In single precision both snapshots share one register, which halves arithmetic and
// memory; its rounding, 6e-8 of the velocity, is far below the error of the splines themselves (1e-4 and more for
// turbulence). Layers of ghost points spare the stencil every wrap.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "spume/core/array.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/core/simd.hpp"
#include "spume/operators/b_spline.hpp"

namespace spume {

// The records of one point or a weighted sum of such: components x, y, z and a zero, of either snapshot.
template <class Real>
struct SnapshotPair;

template <>
struct SnapshotPair<float> {
  simd::f32x8 both{};

  [[gnu::always_inline]] static SnapshotPair at(const float* p) { return {simd::load(p)}; }
  [[gnu::always_inline]] void add(float weight, const SnapshotPair& other) { both += weight * other.both; }
  [[gnu::always_inline]] double first(int c) const { return both[c]; }
  [[gnu::always_inline]] double second(int c) const { return both[4 + c]; }
};

template <>
struct SnapshotPair<double> {
  simd::f64x4 low{}, high{};

  [[gnu::always_inline]] static SnapshotPair at(const double* p) {
    SnapshotPair pair;
    std::memcpy(&pair.low, p, sizeof pair.low);
    std::memcpy(&pair.high, p + 4, sizeof pair.high);
    return pair;
  }
  [[gnu::always_inline]] void add(double weight, const SnapshotPair& other) {
    low += weight * other.low;
    high += weight * other.high;
  }
  [[gnu::always_inline]] double first(int c) const { return low[c]; }
  [[gnu::always_inline]] double second(int c) const { return high[c]; }
};

template <class Real>
class SplineField {
 public:
  SplineField() = default;
  // order: 2, 4 or 6 (std::invalid_argument otherwise). Every axis needs at least one point.
  SplineField(const PeriodicGrid& grid, int order);

  // Takes the spline coefficients of the present field: grid values divided by the prefilter (`b_spline_prefilter`),
  // one array of grid.storage() values per component. What was present becomes the previous field; both are the same
  // after the first call.
  template <class Source>
  void fill(const std::array<const Source*, 3>& coefficients);

  // The coefficients of the previous (0) or present (1) field back in three arrays of the grid's layout.
  void unpack(int snapshot, const std::array<double*, 3>& coefficients) const;

  const PeriodicGrid& grid() const { return grid_; }
  int order() const { return order_; }
  const Real* records() const { return records_.data(); }
  std::size_t stride_x() const { return stride_x_; }  // in numbers, not records
  std::size_t stride_y() const { return stride_y_; }
  bool present_is_second() const { return present_ == 1; }
  double bytes() const { return static_cast<double>(records_.capacity() * sizeof(Real)); }

 private:
  template <class Source>
  void pack(const std::array<const Source*, 3>& coefficients, int half);

  PeriodicGrid grid_;
  int order_ = 0, below_ = 0;
  int present_ = -1;  // half of a record with the present field; -1: none yet
  std::array<int, 3> padded_{};
  std::size_t stride_x_ = 0, stride_y_ = 0;
  Array<Real> records_;
};

// Where a stencil starts and its weights. `slope` holds derivatives with respect to the coordinate, not the fraction.
template <int order, class Real>
struct SplineStencil {
  std::size_t offset;
  Real weight[3][order], slope[3][order];

  // (x, y, z) in the box of the grid; a coordinate that is not a number reads the first cell and yields no number.
  [[gnu::always_inline]] SplineStencil(const SplineField<Real>& field, const double (&position)[3]) {
    const PeriodicGrid& grid = field.grid();
    int cell[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double scale = grid.inverse_spacing(axis);
      const double place = (position[axis] - grid.lower[axis]) * scale;
      const int last = grid.points[axis] - 1;
      cell[axis] = place > 0 ? (place < last ? static_cast<int>(place) : last) : 0;
      BSpline<order>::weights(static_cast<Real>(place - cell[axis]), weight[axis], slope[axis]);
      for (int i = 0; i < order; ++i) slope[axis][i] *= static_cast<Real>(scale);
    }
    offset = cell[0] * field.stride_x() + cell[1] * field.stride_y() + 8 * static_cast<std::size_t>(cell[2]);
  }
};

// Both snapshots at a place: values and derivatives along x, y and z.
template <class Real>
struct FieldSample {
  SnapshotPair<Real> value, slope[3];
};

template <int order, class Real>
[[gnu::always_inline]] inline FieldSample<Real> sample(const SplineField<Real>& field,
                                                       const SplineStencil<order, Real>& s) {
  FieldSample<Real> out;
  const std::size_t stride_x = field.stride_x(), stride_y = field.stride_y();
  const Real* corner = field.records() + s.offset;
  for (int i = 0; i < order; ++i) {
    SnapshotPair<Real> value, along_y, along_z;
#pragma GCC unroll 6
    for (int j = 0; j < order; ++j) {
      const Real* row = corner + i * stride_x + j * stride_y;
      SnapshotPair<Real> row_value, row_slope;
#pragma GCC unroll 6
      for (int k = 0; k < order; ++k) {
        const auto point = SnapshotPair<Real>::at(row + 8 * k);
        row_value.add(s.weight[2][k], point);
        row_slope.add(s.slope[2][k], point);
      }
      value.add(s.weight[1][j], row_value);
      along_y.add(s.slope[1][j], row_value);
      along_z.add(s.weight[1][j], row_slope);
    }
    out.value.add(s.weight[0][i], value);
    out.slope[0].add(s.slope[0][i], value);
    out.slope[1].add(s.weight[0][i], along_y);
    out.slope[2].add(s.weight[0][i], along_z);
  }
  return out;
}

// Calls body(std::integral_constant<int, order>) for order 2, 4 or 6.
template <class Body>
void with_spline_order(int order, Body&& body) {
  if (order == 2)
    body(std::integral_constant<int, 2>{});
  else if (order == 6)
    body(std::integral_constant<int, 6>{});
  else
    body(std::integral_constant<int, 4>{});
}

// Present field at n points in the box of the grid: value[c] and, unless null, gradient[3 c + axis] = d u_c / d x_axis.
template <class Real>
void gather(const SplineField<Real>& field, std::size_t n, const std::array<const double*, 3>& position,
            const std::array<double*, 3>& value, const std::array<double*, 9>* gradient);

}  // namespace spume
