// SPDX-License-Identifier: MIT
// The stage of CrossProduct along z.
#include <algorithm>

#include "cross_product_scratch.hpp"
#include "lane_rows.hpp"

namespace spume {

using fourier::Turn;
using fourier::values;

// The z stage: groups of rows, one row per lane. Fields of a group travel in pairs (velocity component, vorticity
// component) as the real and imaginary part of one complex field: half the transforms, all of the same kind.
template <class T>
void CrossProduct<T>::rows(Scratch& scratch, VelocityPeak& peak) const {
  PeakLanes largest;
  for (std::size_t axis = 0; axis < 3; ++axis)
    largest.per_spacing[axis] = static_cast<T>(static_cast<double>(layout_.points[axis]) / layout_.lengths[axis]);
  for (std::size_t top = 0; top < half_[1]; top += group_rows<T>) {
    rows_to_lanes(top, scratch);
    for (std::size_t remainder = 0; remainder < phases_; ++remainder) {
      inverse_z(remainder, scratch);
      forward_z(remainder, scratch, largest);
    }
    lanes_to_rows(top, scratch);
  }
  // Rows that only fill the last group stay zero: what rounding puts there would grow from plane to plane.
  for (std::size_t f = 0; f < 3; ++f)
    std::fill(scratch.rows[f].begin() + static_cast<std::ptrdiff_t>(half_[1] * work_row_), scratch.rows[f].end(),
              Complex{});
  largest.add_to(peak);
}

template <class T>
void CrossProduct<T>::rows_to_lanes(std::size_t top, Scratch& scratch) const {
  for (std::size_t g = 0; g < 2; ++g)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t l = 0; l < lanes<T>; ++l) {
        const std::size_t at = (top + g * lanes<T> + l) * work_row_;
        fourier::rows_to_lane(scratch.rows[c].data() + at, scratch.rows[3 + c].data() + at, half_[2], l,
                              scratch.turned[6 * g + c].data(), scratch.turned[6 * g + 3 + c].data());
      }
}

template <class T>
void CrossProduct<T>::inverse_z(std::size_t remainder, Scratch& scratch) const {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const std::size_t n = half_[2];
  const Complex* const twist = twists_[2][remainder].data();
  for (std::size_t g = 0; g < 2; ++g)
    for (std::size_t c = 0; c < 3; ++c) {
      const T* const positive = values(scratch.turned[6 * g + c]);
      const T* const negative = values(scratch.turned[6 * g + 3 + c]);
      fourier::transform<true>(
          transform_[2].plan(),
          [=](std::size_t j, std::size_t q, V & real, V & imaginary) __attribute__((always_inline)) {
            const Turn<T> low(twist[j]), high(twist[n + j]);
            V ar, ai, br, bi;
            Lanes::get_numbers(positive + j * Lanes::block + q, ar, ai);
            Lanes::get_numbers(negative + (j == 0 ? 0 : n - j) * Lanes::block + q, br, bi);
            if (j == 0) br = bi = V{};
            real = low.real(ar, ai) + high.real(br, bi);
            imaginary = low.imaginary(ar, ai) + high.imaginary(br, bi);
          },
          fourier::WorkStore<T>{values(scratch.pair[3 * g + c])}, scratch.passes.data());
    }
}

// From (u, omega_x), (v, omega_y), (w, omega_z): transforms of the product's components of both groups, as (x, y) of
// group 0, (x, y) of group 1, and (z of group 0, z of group 1).
template <class T>
void CrossProduct<T>::forward_z(std::size_t remainder, Scratch& scratch, PeakLanes& peak) const {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const std::size_t n = half_[2];
  const Complex* const twist = twists_[2][remainder].data();
  const auto forward = [&](const auto& product, std::size_t p) {
    T* const sum = values(scratch.pair_modes[p]);
    const auto spread = [=](std::size_t j, std::size_t q, V real, V imaginary) __attribute__((always_inline)) {
      const Turn<T> low(std::conj(twist[j])), high(std::conj(twist[n + j]));
      V lr = low.real(real, imaginary), li = low.imaginary(real, imaginary);
      V hr = high.real(real, imaginary), hi = high.imaginary(real, imaginary);
      T *const lower = sum + j * Lanes::block + q, *const upper = lower + n * Lanes::block;
      if (remainder > 0) {
        V r, i;
        Lanes::get_parts(lower, r, i);
        lr += r, li += i;
        Lanes::get_parts(upper, r, i);
        hr += r, hi += i;
      }
      Lanes::put_parts(lower, lr, li);
      Lanes::put_parts(upper, hr, hi);
    };
    fourier::transform<false>(transform_[2].plan(), product, spread, scratch.passes.data());
  };
  PeakLanes largest = peak;
  for (std::size_t g = 0; g < 2; ++g) {
    const T *const x = values(scratch.pair[3 * g]), *const y = values(scratch.pair[3 * g + 1]),
                   *const z = values(scratch.pair[3 * g + 2]);
    forward(
        [ =, &largest ](std::size_t j, std::size_t q, V & real, V & imaginary) __attribute__((always_inline)) {
          V xr, xi, yr, yi, zr, zi;
          Lanes::get_parts(x + j * Lanes::block + q, xr, xi);
          Lanes::get_parts(y + j * Lanes::block + q, yr, yi);
          Lanes::get_parts(z + j * Lanes::block + q, zr, zi);
          real = yr * zi - zr * yi, imaginary = zr * xi - xr * zi;
          largest.take(xr, yr, zr);
        },
        g);
  }
  const T *const x0 = values(scratch.pair[0]), *const y0 = values(scratch.pair[1]);
  const T *const x1 = values(scratch.pair[3]), *const y1 = values(scratch.pair[4]);
  forward(
      [=](std::size_t j, std::size_t q, V & real, V & imaginary) __attribute__((always_inline)) {
        V xr, xi, yr, yi;
        Lanes::get_parts(x0 + j * Lanes::block + q, xr, xi);
        Lanes::get_parts(y0 + j * Lanes::block + q, yr, yi);
        real = xr * yi - yr * xi;
        Lanes::get_parts(x1 + j * Lanes::block + q, xr, xi);
        Lanes::get_parts(y1 + j * Lanes::block + q, yr, yi);
        imaginary = xr * yi - yr * xi;
      },
      2);
  peak = largest;
}

template <class T>
void CrossProduct<T>::lanes_to_rows(std::size_t top, Scratch& scratch) const {
  for (std::size_t p = 0; p < 3; ++p) {
    Complex *const x = scratch.rows[0].data() + (top + p * lanes<T>)*work_row_, *const y =
                                                                                    scratch.rows[1].data() +
                                                                                    (top + p * lanes<T>)*work_row_;
    Complex *const z = scratch.rows[2].data() + top * work_row_, *const z1 = z + lanes<T> * work_row_;
    fourier::lanes_to_rows(values(scratch.pair_modes[p]), half_[2], p < 2 ? x : z, lanes<T>, p < 2 ? y : z1, lanes<T>,
                           work_row_);
  }
}

template void CrossProduct<double>::rows(Scratch&, VelocityPeak&) const;
template void CrossProduct<float>::rows(Scratch&, VelocityPeak&) const;

}  // namespace spume
