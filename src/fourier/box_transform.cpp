// SPDX-License-Identifier: MIT
#include "spume/fourier/box_transform.hpp"

#include <algorithm>

#include "spume/core/parallel.hpp"
#include "spume/fourier/lane_vector.hpp"

namespace spume {

using fourier::copy_block;
using fourier::load;
using fourier::store;
using fourier::vector_width;

template <class T>
BoxTransform<T>::BoxTransform(const ModeLayout& layout, Planning planning, const std::array<Complex*, 2>& work)
    : layout_(layout), real_transform_(layout.points[2], planning), work_(work) {
  if (work_[0] == nullptr) {
    own_work_.resize(layout.size());
    work_ = {own_work_.data(), own_work_.data() + layout.points[0] / 2 * layout.plane};
  }
  for (std::size_t axis = 0; axis < 2; ++axis) transform_.emplace_back(layout.points[axis], planning);
  scratch_.resize(static_cast<std::size_t>(thread_count()));
  for (Scratch& scratch : scratch_) {
    scratch.line.resize(layout.points[0] * lanes<T>);
    scratch.column.resize(layout.points[1] * lanes<T>);
    scratch.modes.resize(layout.points[2] / 2 + 1);
    scratch.values.resize(layout.points[2]);
  }
}

template <class T>
double BoxTransform<T>::bytes() const {
  double bytes = static_cast<double>(own_work_.capacity() * sizeof(Complex));
  for (const Scratch& s : scratch_)
    bytes += static_cast<double>((s.line.capacity() + s.column.capacity() + s.modes.capacity()) * sizeof(Complex) +
                                 s.values.capacity() * sizeof(T));
  return bytes;
}

template <class T>
void BoxTransform<T>::inverse(const Source& modes, const Visitor& visit) {
  const std::size_t nx = layout_.points[0], ny = layout_.points[1], nz = layout_.points[2];
  const std::size_t row = layout_.row;
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
#pragma omp parallel num_threads(threads)
  {
    Scratch& scratch = scratch_[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(static)
    for (std::size_t iy = 0; iy < ny; ++iy)
      for (std::size_t first = 0; first < row; first += lanes<T>) {
        for (std::size_t ix = 0; ix < nx; ++ix) modes(ix, iy, first, &scratch.line[ix * lanes<T>]);
        transform_[0].inverse(scratch.line.data());
        for (std::size_t ix = 0; ix < nx; ++ix) copy_block(&scratch.line[ix * lanes<T>], page(ix) + iy * row + first);
      }
#pragma omp for schedule(static)
    for (std::size_t ix = 0; ix < nx; ++ix) {
      Complex* const page = this->page(ix);
      for (std::size_t first = 0; first < row; first += lanes<T>) {
        for (std::size_t iy = 0; iy < ny; ++iy) copy_block(page + iy * row + first, &scratch.column[iy * lanes<T>]);
        transform_[1].inverse(scratch.column.data());
        for (std::size_t iy = 0; iy < ny; ++iy) copy_block(&scratch.column[iy * lanes<T>], page + iy * row + first);
      }
      for (std::size_t iy = 0; iy < ny; ++iy) {
        std::copy_n(page + iy * row, nz / 2, scratch.modes.data());
        scratch.modes[nz / 2] = 0;
        real_transform_.inverse(scratch.modes.data(), scratch.values.data());
        visit(ix, iy, scratch.values.data());
      }
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

template <class T>
void BoxTransform<T>::forward(const T* values, std::size_t z_stride, const Sink& sink) {
  const std::size_t nx = layout_.points[0], ny = layout_.points[1], nz = layout_.points[2];
  const std::size_t row = layout_.row;
  const T scale = static_cast<T>(1 / layout_.point_count());
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
#pragma omp parallel num_threads(threads)
  {
    Scratch& scratch = scratch_[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(static)
    for (std::size_t ix = 0; ix < nx; ++ix) {
      Complex* const page = this->page(ix);
      for (std::size_t iy = 0; iy < ny; ++iy) {
        std::copy_n(values + (ix * ny + iy) * z_stride, nz, scratch.values.data());
        real_transform_.forward(scratch.values.data(), scratch.modes.data());
        std::copy_n(scratch.modes.data(), nz / 2, page + iy * row);
        std::fill(page + iy * row + nz / 2, page + (iy + 1) * row, Complex{});
      }
      for (std::size_t first = 0; first < row; first += lanes<T>) {
        for (std::size_t iy = 0; iy < ny; ++iy) copy_block(page + iy * row + first, &scratch.column[iy * lanes<T>]);
        transform_[1].forward(scratch.column.data());
        for (std::size_t iy = 0; iy < ny; ++iy) copy_block(&scratch.column[iy * lanes<T>], page + iy * row + first);
      }
    }
#pragma omp for schedule(static)
    for (std::size_t iy = 0; iy < ny; ++iy) {
      if (iy == ny / 2) continue;
      for (std::size_t first = 0; first < row; first += lanes<T>) {
        for (std::size_t ix = 0; ix < nx; ++ix)
          for (std::size_t q = 0; q < lanes<T>; q += vector_width<T>)
            store<T>(&scratch.line[ix * lanes<T> + q], scale * load(page(ix) + iy * row + first + q));
        transform_[0].forward(scratch.line.data());
        for (std::size_t ix = 0; ix < nx; ++ix)
          if (ix != nx / 2) sink(ix, iy, first, &scratch.line[ix * lanes<T>]);
      }
    }
  }
}

template class BoxTransform<double>;
template class BoxTransform<float>;

}  // namespace spume
