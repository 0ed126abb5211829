// SPDX-License-Identifier: MIT
// Three-dimensional transforms between the modes of a ModeLayout and real values on its points.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/fourier/line_transform.hpp"
#include "spume/fourier/mode_layout.hpp"

namespace spume {

// Real values u(ix, iy, iz) at lower + (ix Lx/nx, iy Ly/ny, iz Lz/nz) lie at (ix * ny + iy) * z_stride + iz.
// Results do not depend on the number of threads, bit for bit. Blocks are lanes<T> modes beginning at (ix, iy, first).
template <class T>
class BoxTransform {
 public:
  using Complex = std::complex<T>;
  // Fills a block of modes. Called from several threads.
  using Source = std::function<void(std::size_t ix, std::size_t iy, std::size_t first, Complex* block)>;
  // Takes a line of real values along z; from several threads, each (ix, iy) once, all of an ix from one thread.
  using Visitor = std::function<void(std::size_t ix, std::size_t iy, const T* values)>;
  // Takes a block of modes; those with a vanishing partner (index n/2 along x or y) are not reported.
  using Sink = std::function<void(std::size_t ix, std::size_t iy, std::size_t first, const Complex* block)>;

  // work: memory that is free whenever a transform runs, two pieces of nx/2 * layout.plane values; null: its own.
  explicit BoxTransform(const ModeLayout& layout, Planning planning = Planning::estimate,
                        const std::array<Complex*, 2>& work = {});

  // u(x) = sum over all modes of u_k exp(i k.x).
  void inverse(const Source& modes, const Visitor& visit);
  void inverse(const Source& modes, T* values, std::size_t z_stride);
  // u_k = mean over the points of u exp(-i k.x), for the modes below the Nyquist wavenumber of each axis.
  void forward(const T* values, std::size_t z_stride, const Sink& sink);

  double bytes() const;

 private:
  struct Scratch {  // of a thread
    Array<Complex> line, passes;
    std::array<Array<Complex>, 2> turned;  // modes of two groups of rows, one row per lane
    Array<Complex> pair;                   // their values, or modes: two real rows as one complex
    Array<T> values;                       // both groups, by rows
  };
  void inverse_rows(Scratch& scratch, std::size_t ix, std::size_t top, const Visitor& visit);
  void forward_rows(Scratch& scratch, std::size_t ix, std::size_t top, const T* values, std::size_t z_stride);
  ModeLayout layout_;
  std::vector<LaneTransform<T>> transform_;
  Complex* page(std::size_t ix) const {
    const std::size_t half = layout_.points[0] / 2;
    return ix < half ? work_[0] + ix * layout_.plane : work_[1] + (ix - half) * layout_.plane;
  }
  Array<Complex> own_work_;
  std::array<Complex*, 2> work_;
  std::vector<Scratch> scratch_;
};

}  // namespace spume
