// SPDX-License-Identifier: MIT
#include "spume/fourier/cross_product.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cross_product_scratch.hpp"
#include "spume/core/parallel.hpp"
#include "spume/fourier/lane_vector.hpp"

namespace spume {

using fourier::prefetch_block;
using fourier::release_streams;
using fourier::Turn;
using fourier::values;

// Bytes of the planes from which on they are written past the caches, which saves reading them first: some tens of
// megabytes, the last cache of a server. On a machine with AVX-512 flow steps of 64^3 to 128^3 (7 to 50 MB), either
// precision, one thread, take the same within 3 % both ways, which is what repeats differ by.
constexpr double streamed_bytes = 3e7;

template <class T>
CrossProduct<T>::CrossProduct(const ModeLayout& layout, bool padded, Planning planning)
    : layout_(layout),
      phases_(padded ? 3 : 2),
      work_row_(layout.row + lanes<T>),
      work_plane_(layout.points[1] * work_row_ + lanes<T>) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t n = half_[axis] = layout.points[axis] / 2;
    twists_[axis].resize(phases_);
    for (std::size_t r = 0; r < phases_; ++r)
      for (std::size_t i = 0; i < 2 * n; ++i) {
        const double k = i < n ? static_cast<double>(i) : static_cast<double>(i) - 2.0 * static_cast<double>(n);
        const double angle = 2 * std::numbers::pi * k * static_cast<double>(r) / static_cast<double>(phases_ * n);
        twists_[axis][r].emplace_back(static_cast<T>(std::cos(angle)), static_cast<T>(std::sin(angle)));
      }
    for (const double k : layout.wavenumber[axis]) wavenumber_[axis].push_back(static_cast<T>(k));
    transform_.emplace_back(n, planning);
  }
  lane_wavenumber_.resize(layout.row);
  for (std::size_t iz = 0; iz < layout.row; ++iz) lane_wavenumber_[iz] = {wavenumber_[2][iz], wavenumber_[2][iz]};
  for (std::size_t at = 0; at < 2 * layout.row; at += fourier::Lanes<T>::piece_step) {
    T* const numbers = values(lane_wavenumber_) + at;
    typename fourier::Lanes<T>::V real, imaginary;
    fourier::Lanes<T>::get_numbers(numbers, real, imaginary);
    fourier::Lanes<T>::put_parts(numbers, real, imaginary);
  }
  for (auto& field : work_) field.resize(half_[0] * work_plane_);
  const std::size_t padded_rows = (half_[1] + group_rows<T> - 1) / group_rows<T> * group_rows<T>;
  for (int thread = 0; thread < thread_count(); ++thread) {
    auto scratch = std::make_unique<Scratch>();
    const auto size = [](auto& arrays, std::size_t values) {
      for (auto& array : arrays) array.resize(values);
    };
    size(scratch->line, half_[0] * lanes<T>);
    size(scratch->rows, padded_rows * work_row_);
    size(scratch->sum, layout.points[1] * work_row_);
    size(scratch->column, half_[1] * lanes<T>);
    size(scratch->turned, half_[2] * lanes<T>);
    size(scratch->pair, half_[2] * lanes<T>);
    size(scratch->pair_modes, 2 * half_[2] * lanes<T>);
    for (const auto& line : transform_) scratch->passes.resize(std::max(scratch->passes.size(), line.work_size()));
    scratch_.push_back(std::move(scratch));
  }
  peaks_.resize(half_[0]);
}

template <class T>
CrossProduct<T>::~CrossProduct() = default;

template <class T>
double CrossProduct<T>::bytes() const {
  double numbers = 0;
  for (const auto& field : work_) numbers += static_cast<double>(field.capacity());
  const auto add = [&](const auto& arrays) {
    for (const auto& array : arrays) numbers += static_cast<double>(array.capacity());
  };
  for (const auto& scratch : scratch_) {
    add(scratch->line);
    add(scratch->rows);
    add(scratch->sum);
    add(scratch->column);
    add(scratch->turned);
    add(scratch->pair);
    add(scratch->pair_modes);
    numbers += static_cast<double>(scratch->passes.capacity());
  }
  return numbers * sizeof(Complex);
}

template <class T>
VelocityPeak CrossProduct<T>::evaluate(const std::array<const Complex*, 3>& potential,
                                       const std::array<Complex*, 3>& sum, const Finish& finish) {
  VelocityPeak peak;
  for (std::size_t remainder = 0; remainder < phases_; ++remainder) {
    inverse_x(remainder, potential);
    form_planes(peak);
    forward_x(remainder, sum, finish);
  }
  return peak;
}

template <class T>
void CrossProduct<T>::form_planes(VelocityPeak& peak) {
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t j = 0; j < half_[0]; ++j) {
    peaks_[j] = {};
    plane(j, *scratch_[static_cast<std::size_t>(omp_get_thread_num())], peaks_[j]);
  }
  for (const VelocityPeak& p : peaks_) {
    // A value that is not a number has to reach the caller.
    peak.speed = p.speed > peak.speed || p.speed != p.speed ? p.speed : peak.speed;
    peak.rate = p.rate > peak.rate || p.rate != p.rate ? p.rate : peak.rate;
  }
}

template <class T>
void CrossProduct<T>::inverse_x(std::size_t remainder, const std::array<const Complex*, 3>& potential) {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
  const std::size_t n = half_[0], ny = layout_.points[1];
  const std::vector<Complex>& twist = twists_[0][remainder];
  const bool stream = static_cast<double>(work_[0].size() * work_.size() * sizeof(Complex)) > streamed_bytes;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t iy = 0; iy < ny; ++iy) {
    Scratch& scratch = *scratch_[static_cast<std::size_t>(omp_get_thread_num())];
    const T ky = wavenumber_[1][iy];
    for (std::size_t first = 0; first < layout_.row; first += lanes<T>) {
      for (std::size_t j = 0; j < n; ++j) {
        // i times the twist: u = i k x b.
        const Turn<T> low(Complex(-twist[j].imag(), twist[j].real()));
        const Turn<T> high(Complex(-twist[n + j].imag(), twist[n + j].real()));
        const T k = wavenumber_[0][j], l = wavenumber_[0][n + j];
        const std::size_t at = j * layout_.plane + iy * layout_.row + first, above = at + n * layout_.plane;
        // The next block's lines lie a plane apart each: no prefetcher of the processor sees them coming.
        for (std::size_t c = 0; c < 3; ++c) {
          prefetch_block(potential[c] + at + lanes<T>);
          prefetch_block(potential[c] + above + lanes<T>);
        }
        for (std::size_t q = 0; q < Lanes::block; q += Lanes::piece_step) {
          const V kz = Lanes::get(values(lane_wavenumber_) + 2 * first + q);
          V xr, xi, yr, yi, zr, zi;
          Lanes::get_numbers(values(potential[0] + at) + q, xr, xi);
          Lanes::get_numbers(values(potential[1] + at) + q, yr, yi);
          Lanes::get_numbers(values(potential[2] + at) + q, zr, zi);
          const V cxr = ky * zr - kz * yr, cxi = ky * zi - kz * yi;
          const V cyr = kz * xr - k * zr, cyi = kz * xi - k * zi;
          const V czr = k * yr - ky * xr, czi = k * yi - ky * xi;
          V ur = low.real(cxr, cxi), ui = low.imaginary(cxr, cxi);
          V vr = low.real(cyr, cyi), vi = low.imaginary(cyr, cyi);
          V wr = low.real(czr, czi), wi = low.imaginary(czr, czi);
          V dvr = k * vr, dvi = k * vi, dwr = k * wr, dwi = k * wi;
          if (j > 0) {
            Lanes::get_numbers(values(potential[0] + above) + q, xr, xi);
            Lanes::get_numbers(values(potential[1] + above) + q, yr, yi);
            Lanes::get_numbers(values(potential[2] + above) + q, zr, zi);
            const V dxr = ky * zr - kz * yr, dxi = ky * zi - kz * yi;
            const V dyr = kz * xr - l * zr, dyi = kz * xi - l * zi;
            const V dzr = l * yr - ky * xr, dzi = l * yi - ky * xi;
            const V ar = high.real(dyr, dyi), ai = high.imaginary(dyr, dyi);
            const V br = high.real(dzr, dzi), bi = high.imaginary(dzr, dzi);
            ur += high.real(dxr, dxi), ui += high.imaginary(dxr, dxi);
            vr += ar, vi += ai;
            wr += br, wi += bi;
            dvr += l * ar, dvi += l * ai;
            dwr += l * br, dwi += l * bi;
          }
          const std::size_t to = j * Lanes::block + q;
          Lanes::put_parts(values(scratch.line[0]) + to, ur, ui);
          Lanes::put_parts(values(scratch.line[1]) + to, vr, vi);
          Lanes::put_parts(values(scratch.line[2]) + to, wr, wi);
          Lanes::put_parts(values(scratch.line[3]) + to, -dvi, dvr);
          Lanes::put_parts(values(scratch.line[4]) + to, -dwi, dwr);
        }
      }
      if (iy == 0 && first == 0)  // the mean velocity; number 0 of a block is the first of both parts
        for (std::size_t c = 0; c < 3; ++c) values(scratch.line[c])[0] += potential[c][0].real();
      for (std::size_t f = 0; f < 5; ++f) {
        T* const out = values(work_[f]) + 2 * (iy * work_row_ + first);
        const std::size_t apart = 2 * work_plane_;
        const fourier::WorkLoad<T> line{values(scratch.line[f])};
        if (stream)
          fourier::transform<true>(
              transform_[0].plan(), line,
              [=](std::size_t j, std::size_t q, V real, V imaginary)
                  __attribute__((always_inline)) { Lanes::stream_parts(out + j * apart + q, real, imaginary); },
              scratch.passes.data());
        else
          fourier::transform<true>(
              transform_[0].plan(), line,
              [=](std::size_t j, std::size_t q, V real, V imaginary)
                  __attribute__((always_inline)) { Lanes::put_parts(out + j * apart + q, real, imaginary); },
              scratch.passes.data());
      }
    }
    release_streams();
  }
}

template <class T>
void CrossProduct<T>::plane(std::size_t j, Scratch& scratch, VelocityPeak& peak) {
  for (std::size_t remainder = 0; remainder < phases_; ++remainder) {
    inverse_y(remainder, j, scratch);
    rows(scratch, peak);
    forward_y(remainder, j, scratch);
  }
}

template <class T>
void CrossProduct<T>::inverse_y(std::size_t remainder, std::size_t j, Scratch& scratch) const {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const std::size_t n = half_[1];
  const std::vector<Complex>& twist = twists_[1][remainder];
  for (std::size_t first = 0; first < layout_.row; first += lanes<T>) {
    const Complex* from[5];
    for (std::size_t f = 0; f < 5; ++f) from[f] = work_[f].data() + j * work_plane_ + first;
    for (std::size_t jy = 0; jy < n; ++jy) {
      const Turn<T> low(twist[jy]), high(twist[n + jy]);
      const T k = wavenumber_[1][jy], l = wavenumber_[1][n + jy];
      const std::size_t at = jy * work_row_, above = at + n * work_row_;
      for (std::size_t q = 0; q < Lanes::block; q += Lanes::piece_step) {
        const V kz = Lanes::get(values(lane_wavenumber_) + 2 * first + q);
        V r[5], i[5], yr[2], yi[2];  // of u, v, w, dv/dx, dw/dx; of u and w times i k_y
#pragma GCC unroll 5
        for (std::size_t f = 0; f < 5; ++f) {
          V ar, ai;
          Lanes::get_parts(values(from[f] + at) + q, ar, ai);
          r[f] = low.real(ar, ai), i[f] = low.imaginary(ar, ai);
          if (f == 0 || f == 2) yr[f / 2] = k * r[f], yi[f / 2] = k * i[f];
        }
        if (jy > 0) {
#pragma GCC unroll 5
          for (std::size_t f = 0; f < 5; ++f) {
            V ar, ai;
            Lanes::get_parts(values(from[f] + above) + q, ar, ai);
            const V br = high.real(ar, ai), bi = high.imaginary(ar, ai);
            r[f] += br, i[f] += bi;
            if (f == 0 || f == 2) yr[f / 2] += l * br, yi[f / 2] += l * bi;
          }
        }
        const std::size_t to = jy * Lanes::block + q;
#pragma GCC unroll 3
        for (std::size_t f = 0; f < 3; ++f) Lanes::put_parts(values(scratch.column[f]) + to, r[f], i[f]);
        // Vorticity: dw/dy - dv/dz, du/dz - dw/dx, dv/dx - du/dy.
        Lanes::put_parts(values(scratch.column[3]) + to, kz * i[1] - yi[1], yr[1] - kz * r[1]);
        Lanes::put_parts(values(scratch.column[4]) + to, -kz * i[0] - r[4], kz * r[0] - i[4]);
        Lanes::put_parts(values(scratch.column[5]) + to, r[3] + yi[0], i[3] - yr[0]);
      }
    }
    for (std::size_t f = 0; f < 6; ++f) {
      T* const out = values(scratch.rows[f]) + 2 * first;
      const std::size_t apart = 2 * work_row_;
      fourier::transform<true>(
          transform_[1].plan(), fourier::WorkLoad<T>{values(scratch.column[f])},
          [=](std::size_t jy, std::size_t q, V real, V imaginary)
              __attribute__((always_inline)) { Lanes::put_numbers(out + jy * apart + q, real, imaginary); },
          scratch.passes.data());
    }
  }
}

template <class T>
void CrossProduct<T>::forward_y(std::size_t remainder, std::size_t j, Scratch& scratch) {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const std::size_t n = half_[1], row = 2 * work_row_;
  const Complex* const twist = twists_[1][remainder].data();
  const bool last = remainder + 1 == phases_;
  for (std::size_t first = 0; first < layout_.row; first += lanes<T>)
    for (std::size_t f = 0; f < 3; ++f) {
      const T* const from = values(scratch.rows[f]) + 2 * first;
      const T* const sum = values(scratch.sum[f]) + 2 * first;
      // The last remainder goes straight to the plane: its modes are no longer needed.
      T* const out = last ? values(work_[f]) + 2 * (j * work_plane_ + first) : values(scratch.sum[f]) + 2 * first;
      fourier::transform<false>(
          transform_[1].plan(),
          [=](std::size_t jy, std::size_t q, V & real, V & imaginary)
              __attribute__((always_inline)) { Lanes::get_numbers(from + jy * row + q, real, imaginary); },
          [=](std::size_t jy, std::size_t q, V real, V imaginary) __attribute__((always_inline)) {
            const Turn<T> low(std::conj(twist[jy])), high(std::conj(twist[n + jy]));
            const std::size_t at = jy * row + q, above = at + n * row;
            V lr = low.real(real, imaginary), li = low.imaginary(real, imaginary);
            V hr = high.real(real, imaginary), hi = high.imaginary(real, imaginary);
            if (remainder > 0) {
              V r, i;
              Lanes::get_parts(sum + at, r, i);
              lr += r, li += i;
              Lanes::get_parts(sum + above, r, i);
              hr += r, hi += i;
            }
            Lanes::put_parts(out + at, lr, li);
            Lanes::put_parts(out + above, hr, hi);
          },
          scratch.passes.data());
    }
}

template <class T>
void CrossProduct<T>::forward_x(std::size_t remainder, const std::array<Complex*, 3>& sum, const Finish& finish) {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
  const std::size_t n = half_[0], ny = layout_.points[1];
  const std::vector<Complex>& twist = twists_[0][remainder];
  const bool last = remainder + 1 == phases_;
  const T scale = static_cast<T>(1 / (layout_.point_count() / 8 * static_cast<double>(phases_ * phases_ * phases_)));
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t iy = 0; iy < ny; ++iy) {
    if (iy == ny / 2) continue;
    Scratch& scratch = *scratch_[static_cast<std::size_t>(omp_get_thread_num())];
    for (std::size_t first = 0; first < layout_.row; first += lanes<T>) {
      for (std::size_t f = 0; f < 3; ++f) {
        const T* const from = values(work_[f]) + 2 * (iy * work_row_ + first);
        const std::size_t apart = 2 * work_plane_;
        fourier::transform<false>(
            transform_[0].plan(),
            [=](std::size_t j, std::size_t q, V & real, V & imaginary) __attribute__((always_inline)) {
              __builtin_prefetch(from + j * apart + q + Lanes::block);
              Lanes::get_parts(from + j * apart + q, real, imaginary);
            },
            fourier::WorkStore<T>{values(scratch.line[f])}, scratch.passes.data());
      }
      const auto mode = [&](std::size_t ix, std::size_t j) {
        const std::size_t at = ix * layout_.plane + iy * layout_.row + first;
        const Turn<T> factor(scale * std::conj(twist[ix]));
        for (std::size_t f = 0; f < 3; ++f) prefetch_block<T>(sum[f] + at + lanes<T>);
        alignas(64) Complex product[3][lanes<T>];
        for (std::size_t f = 0; f < 3; ++f)
          for (std::size_t q = 0; q < Lanes::block; q += Lanes::piece_step) {
            V r, i;
            Lanes::get_parts(values(scratch.line[f]) + j * Lanes::block + q, r, i);
            V real = factor.real(r, i), imaginary = factor.imaginary(r, i);
            T* const partial = values(sum[f] + at) + q;
            if (remainder > 0) {
              Lanes::get_parts(partial, r, i);
              real += r, imaginary += i;
            }
            if (last)
              Lanes::put_numbers(values(product[f]) + q, real, imaginary);
            else
              Lanes::put_parts(partial, real, imaginary);
          }
        if (!last) return;
        const Complex* const pointers[3] = {product[0], product[1], product[2]};
        finish(ix, iy, first, pointers);
      };
      for (std::size_t j = 0; j < n; ++j) mode(j, j);
      for (std::size_t j = 1; j < n; ++j) mode(n + j, j);
    }
  }
}

template class CrossProduct<double>;
template class CrossProduct<float>;

}  // namespace spume
