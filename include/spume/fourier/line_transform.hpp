// SPDX-License-Identifier: MIT
// One-dimensional transforms of lines in a small buffer, one thread each (FFTW 3, double and single precision).
// Callers own the parallel loops: batches of such lines were measured faster than FFTW's own threads.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>

namespace spume {

// How FFTW chooses a plan: by rule, or by trying. Tried plans are remembered in the user's cache folder
// ($XDG_CACHE_HOME or ~/.cache, spume/fftw-wisdom-*), so that the next run takes the same ones at once.
enum class Planning { estimate, measure };

// `lanes<T>` complex lines of n values side by side: value j of line l lies at j * lanes<T> + l, aligned to 64 bytes.
// Unscaled, in place: inverse f_j = sum_k F_k exp(+2 pi i j k / n), forward with the other sign.
template <class T>
class LaneTransform {
 public:
  explicit LaneTransform(std::size_t n, Planning planning = Planning::estimate);
  std::size_t size() const { return n_; }
  void inverse(std::complex<T>* buffer) const;
  void forward(std::complex<T>* buffer) const;

 private:
  struct Plans;
  std::size_t n_;
  std::shared_ptr<const Plans> plans_;
};

// One real line of n values (n even) and its n/2 + 1 modes, each aligned to 64 bytes; unscaled, and the input is lost.
template <class T>
class RealLineTransform {
 public:
  explicit RealLineTransform(std::size_t n, Planning planning = Planning::estimate);
  std::size_t size() const { return n_; }
  void inverse(std::complex<T>* modes, T* values) const;
  void forward(T* values, std::complex<T>* modes) const;

 private:
  struct Plans;
  std::size_t n_;
  std::shared_ptr<const Plans> plans_;
};

}  // namespace spume
