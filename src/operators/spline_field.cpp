// SPDX-License-Identifier: MIT
#include "spume/operators/spline_field.hpp"

#include <stdexcept>
#include <string>

#include "spume/core/parallel.hpp"

namespace spume {

template <class Real>
SplineField<Real>::SplineField(const PeriodicGrid& grid, int order) : grid_(grid), order_(order) {
  if (order != 2 && order != 4 && order != 6)
    throw std::invalid_argument("spline order " + std::to_string(order) + "; the orders are 2, 4 and 6");
  below_ = order / 2 - 1;
  for (int axis = 0; axis < 3; ++axis) padded_[axis] = grid.points[axis] + order - 1;
  // An odd number of cache lines per row keeps the rows of a stencil off one set of the cache.
  std::size_t row = 8 * static_cast<std::size_t>(padded_[2]);
  const std::size_t line = 64 / sizeof(Real);
  row = (row + line - 1) / line * line;
  if (row / line % 2 == 0) row += line;
  stride_y_ = row;
  stride_x_ = row * static_cast<std::size_t>(padded_[1]);
  records_.resize(stride_x_ * static_cast<std::size_t>(padded_[0]));
}

template <class Real>
template <class Source>
void SplineField<Real>::fill(const std::array<const Source*, 3>& coefficients) {
  if (present_ < 0) {
    pack(coefficients, 0);
    pack(coefficients, 1);
    present_ = 1;
    return;
  }
  present_ = 1 - present_;
  pack(coefficients, present_);
}

template <class Real>
template <class Source>
void SplineField<Real>::pack(const std::array<const Source*, 3>& coefficients, int half) {
  const auto rows_x = static_cast<std::size_t>(padded_[0]), rows_y = static_cast<std::size_t>(padded_[1]);
  const auto wrapped = [this](int padded, int axis) {
    const int n = grid_.points[axis];
    return ((padded - below_) % n + n) % n;
  };
  const int nz = grid_.points[2];
  parallel_blocks(rows_x * rows_y, 16, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t r = first; r < last; ++r) {
      const std::size_t source =
          grid_.row(wrapped(static_cast<int>(r / rows_y), 0), wrapped(static_cast<int>(r % rows_y), 1));
      const Source* u = coefficients[0] + source;
      const Source* v = coefficients[1] + source;
      const Source* w = coefficients[2] + source;
      Real* out = records_.data() + r / rows_y * stride_x_ + r % rows_y * stride_y_ + 4 * half;
      const auto put = [&](int padded, int k) {
        const Real record[4] = {static_cast<Real>(u[k]), static_cast<Real>(v[k]), static_cast<Real>(w[k]), Real(0)};
        std::memcpy(out + 8 * padded, &record, sizeof record);
      };
      for (int padded = 0; padded < below_; ++padded) put(padded, wrapped(padded, 2));
      for (int k = 0; k < nz; ++k) put(below_ + k, k);
      for (int padded = below_ + nz; padded < padded_[2]; ++padded) put(padded, wrapped(padded, 2));
    }
  });
}

template <class Real>
void SplineField<Real>::unpack(int snapshot, const std::array<double*, 3>& coefficients) const {
  const int half = snapshot == 1 ? present_ : 1 - present_;
  const auto ny = static_cast<std::size_t>(grid_.points[1]);
  const auto below = static_cast<std::size_t>(below_);
  parallel_blocks(static_cast<std::size_t>(grid_.points[0]) * ny, 16,
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    for (std::size_t r = first; r < last; ++r) {
                      const Real* in = records_.data() + (r / ny + below) * stride_x_ + (r % ny + below) * stride_y_ +
                                       8 * below + 4 * static_cast<std::size_t>(half);
                      for (int k = 0; k < grid_.points[2]; ++k)
                        for (int c = 0; c < 3; ++c)
                          coefficients[c][r * grid_.z_stride + static_cast<std::size_t>(k)] = in[8 * k + c];
                    }
                  });
}

template <class Real>
void gather(const SplineField<Real>& field, std::size_t n, const std::array<const double*, 3>& position,
            const std::array<double*, 3>& value, const std::array<double*, 9>* gradient) {
  const bool second = field.present_is_second();
  with_spline_order(field.order(), [&](auto order) {
    parallel_for(n, [&](std::size_t p) {
      const SplineStencil<order(), Real> stencil(field, {position[0][p], position[1][p], position[2][p]});
      const FieldSample<Real> at = sample(field, stencil);
      const auto present = [second](const SnapshotPair<Real>& pair, int c) {
        return second ? pair.second(c) : pair.first(c);
      };
      for (int c = 0; c < 3; ++c) {
        value[c][p] = present(at.value, c);
        if (gradient != nullptr)
          for (int axis = 0; axis < 3; ++axis) (*gradient)[3 * c + axis][p] = present(at.slope[axis], c);
      }
    });
  });
}

template class SplineField<double>;
template class SplineField<float>;
template void SplineField<double>::fill(const std::array<const double*, 3>&);
template void SplineField<double>::fill(const std::array<const float*, 3>&);
template void SplineField<float>::fill(const std::array<const double*, 3>&);
template void SplineField<float>::fill(const std::array<const float*, 3>&);
template void gather(const SplineField<double>&, std::size_t, const std::array<const double*, 3>&,
                     const std::array<double*, 3>&, const std::array<double*, 9>*);
template void gather(const SplineField<float>&, std::size_t, const std::array<const double*, 3>&,
                     const std::array<double*, 3>&, const std::array<double*, 9>*);

}  // namespace spume
