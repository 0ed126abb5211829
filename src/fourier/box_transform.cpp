// SPDX-License-Identifier: MIT
#include "spume/fourier/box_transform.hpp"

#include <algorithm>

#include "lane_passes.hpp"
#include "lane_rows.hpp"
#include "spume/core/parallel.hpp"

namespace spume {

template <class T>
BoxTransform<T>::BoxTransform(const ModeLayout& layout, Planning planning, const std::array<Complex*, 2>& work)
    : layout_(layout), work_(work) {
  if (work_[0] == nullptr) {
    own_work_.resize(layout.size());
    work_ = {own_work_.data(), own_work_.data() + layout.points[0] / 2 * layout.plane};
  }
  for (std::size_t axis = 0; axis < 3; ++axis) transform_.emplace_back(layout.points[axis], planning);
  const std::size_t nz = layout.points[2];
  scratch_.resize(static_cast<std::size_t>(thread_count()));
  for (Scratch& scratch : scratch_) {
    scratch.line.resize(layout.points[0] * lanes<T>);
    for (const auto& line : transform_) scratch.passes.resize(std::max(scratch.passes.size(), line.work_size()));
    for (auto& modes : scratch.turned) modes.resize(nz / 2 * lanes<T>);
    scratch.pair.resize(nz * lanes<T>);
    scratch.values.resize(2 * nz * lanes<T>);
  }
}

template <class T>
double BoxTransform<T>::bytes() const {
  double bytes = static_cast<double>(own_work_.capacity() * sizeof(Complex));
  for (const Scratch& s : scratch_)
    bytes += static_cast<double>((s.line.capacity() + s.passes.capacity() + s.turned[0].capacity() +
                                  s.turned[1].capacity() + s.pair.capacity()) *
                                     sizeof(Complex) +
                                 s.values.capacity() * sizeof(T));
  return bytes;
}

// Rows top to top + 2 lanes<T> - 1 of a page to values; rows beyond the last repeat it.
template <class T>
void BoxTransform<T>::inverse_rows(Scratch& scratch, std::size_t ix, std::size_t top, const Visitor& visit) {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const std::size_t ny = layout_.points[1], nz = layout_.points[2], n = nz / 2;
  const Complex* const page = this->page(ix);
  for (std::size_t l = 0; l < lanes<T>; ++l)
    fourier::rows_to_lane(page + std::min(top + l, ny - 1) * layout_.row,
                          page + std::min(top + lanes<T> + l, ny - 1) * layout_.row, n, l, scratch.turned[0].data(),
                          scratch.turned[1].data());
  const auto* const positive = reinterpret_cast<const T*>(scratch.turned[0].data());
  const auto* const negative = reinterpret_cast<const T*>(scratch.turned[1].data());
  T* const line = reinterpret_cast<T*>(scratch.pair.data());
  fourier::transform<true>(
      transform_[2].plan(),
      [=](std::size_t k, std::size_t q, V & real, V & imaginary) __attribute__((always_inline)) {
        if (k == n)
          real = imaginary = V{};
        else
          Lanes::get_numbers((k < n ? positive + k * Lanes::block : negative + (nz - k) * Lanes::block) + q, real,
                             imaginary);
      },
      fourier::WorkStore<T>{line}, scratch.passes.data());
  for (std::size_t g = 0; g < 2; ++g) {
    T* const rows = scratch.values.data() + g * lanes<T> * nz;
    fourier::lanes_to_reals(line, g, nz, rows, nz);
    for (std::size_t l = 0, iy = top + g * lanes<T>; l < lanes<T> && iy < ny; ++l, ++iy) visit(ix, iy, rows + l * nz);
  }
}

template <class T>
void BoxTransform<T>::inverse(const Source& modes, const Visitor& visit) {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const std::size_t nx = layout_.points[0], ny = layout_.points[1], row = layout_.row;
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
#pragma omp parallel num_threads(threads)
  {
    Scratch& scratch = scratch_[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(static)
    for (std::size_t iy = 0; iy < ny; ++iy)
      for (std::size_t first = 0; first < row; first += lanes<T>) {
        for (std::size_t ix = 0; ix < nx; ++ix) modes(ix, iy, first, &scratch.line[ix * lanes<T>]);
        const auto* const line = reinterpret_cast<const T*>(scratch.line.data());
        fourier::transform<true>(
            transform_[0].plan(),
            [=](std::size_t j, std::size_t q, V & real, V & imaginary)
                __attribute__((always_inline)) { Lanes::get_numbers(line + j * Lanes::block + q, real, imaginary); },
            [ =, this ](std::size_t ix, std::size_t q, V real, V imaginary) __attribute__((always_inline)) {
              Lanes::put_numbers(reinterpret_cast<T*>(page(ix) + iy * row + first) + q, real, imaginary);
            },
            scratch.passes.data());
      }
#pragma omp for schedule(static)
    for (std::size_t ix = 0; ix < nx; ++ix) {
      Complex* const page = this->page(ix);
      for (std::size_t first = 0; first < row; first += lanes<T>)
        transform_[1].inverse(page + first, row, page + first, row, scratch.passes.data());
      for (std::size_t top = 0; top < ny; top += 2 * lanes<T>) inverse_rows(scratch, ix, top, visit);
    }
  }
}

template <class T>
void BoxTransform<T>::inverse(const Source& modes, T* values, std::size_t z_stride) {
  const std::size_t ny = layout_.points[1], nz = layout_.points[2];
  inverse(modes, [=](std::size_t ix, std::size_t iy, const T* line) {
    std::copy_n(line, nz, values + (ix * ny + iy) * z_stride);
  });
}

// Values to rows top to top + 2 lanes<T> - 1 of a page.
template <class T>
void BoxTransform<T>::forward_rows(Scratch& scratch, std::size_t ix, std::size_t top, const T* values,
                                   std::size_t z_stride) {
  const std::size_t ny = layout_.points[1], nz = layout_.points[2], n = nz / 2, row = layout_.row;
  T* const line = reinterpret_cast<T*>(scratch.pair.data());
  std::array<std::size_t, 2> rows{};
  for (std::size_t g = 0; g < 2; ++g) {
    const std::size_t begin = top + g * lanes<T>;
    rows[g] = begin < ny ? std::min(lanes<T>, ny - begin) : 0;
    const T* from = values + (ix * ny + begin) * z_stride;
    std::size_t apart = z_stride;
    if (rows[g] < lanes<T>) {  // rows that only fill the group
      from = scratch.values.data();
      apart = nz;
      for (std::size_t l = 0; l < lanes<T>; ++l)
        std::copy_n(values + (ix * ny + std::min(begin + l, ny - 1)) * z_stride, nz, scratch.values.data() + l * nz);
    }
    fourier::reals_to_lanes(from, apart, nz, g, line);
  }
  fourier::transform<false>(transform_[2].plan(), fourier::WorkLoad<T>{line}, fourier::WorkStore<T>{line},
                            scratch.passes.data());
  Complex* const first = page(ix) + top * row;
  fourier::lanes_to_rows(line, n, first, rows[0], first + lanes<T> * row, rows[1], row);
  for (std::size_t l = 0; l < rows[0] + rows[1]; ++l) std::fill(first + l * row + n, first + (l + 1) * row, Complex{});
}

template <class T>
void BoxTransform<T>::forward(const T* values, std::size_t z_stride, const Sink& sink) {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const std::size_t nx = layout_.points[0], ny = layout_.points[1], row = layout_.row;
  const T scale = static_cast<T>(1 / layout_.point_count());
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
#pragma omp parallel num_threads(threads)
  {
    Scratch& scratch = scratch_[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(static)
    for (std::size_t ix = 0; ix < nx; ++ix) {
      Complex* const page = this->page(ix);
      for (std::size_t top = 0; top < ny; top += 2 * lanes<T>) forward_rows(scratch, ix, top, values, z_stride);
      for (std::size_t first = 0; first < row; first += lanes<T>)
        transform_[1].forward(page + first, row, page + first, row, scratch.passes.data());
    }
#pragma omp for schedule(static)
    for (std::size_t iy = 0; iy < ny; ++iy) {
      if (iy == ny / 2) continue;
      for (std::size_t first = 0; first < row; first += lanes<T>) {
        T* const line = reinterpret_cast<T*>(scratch.line.data());
        fourier::transform<false>(
            transform_[0].plan(),
            [ =, this ](std::size_t ix, std::size_t q, V & real, V & imaginary) __attribute__((always_inline)) {
              Lanes::get_numbers(reinterpret_cast<const T*>(page(ix) + iy * row + first) + q, real, imaginary);
              real *= scale, imaginary *= scale;
            },
            [=](std::size_t j, std::size_t q, V real, V imaginary)
                __attribute__((always_inline)) { Lanes::put_numbers(line + j * Lanes::block + q, real, imaginary); },
            scratch.passes.data());
        for (std::size_t ix = 0; ix < nx; ++ix)
          if (ix != nx / 2) sink(ix, iy, first, &scratch.line[ix * lanes<T>]);
      }
    }
  }
}

template class BoxTransform<double>;
template class BoxTransform<float>;

}  // namespace spume
