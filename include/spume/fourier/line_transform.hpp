// SPDX-License-Identifier: MIT
// One-dimensional transforms of lines, one thread each. Callers own the parallel loops: batches of such lines were
// measured faster than FFTW's own threads.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>

namespace spume {

// How FFTW chooses a plan: by rule, or by trying. Tried plans are remembered in the user's cache folder
// ($XDG_CACHE_HOME or ~/.cache, spume/fftw-wisdom-*), so that the next run takes the same ones at once.
enum class Planning { estimate, measure };

// Who transforms lines. `own`: our passes over the lanes of vector registers, where the length is a product of 2, 3 and
// 5, and FFTW elsewhere. The rule is fixed, because a choice by the clock would change the last bits from run to run.
enum class LineKernels { own, fftw };

namespace fourier {
template <class T>
struct LanePlan;
}

// `lanes<T>` complex lines of n values side by side: value j of line l lies at j * stride + l, blocks of lanes<T>
// values aligned to 64 bytes. Unscaled: inverse f_j = sum_k F_k exp(+2 pi i j k / n), forward with the other sign.
template <class T>
class LaneTransform {
 public:
  using Complex = std::complex<T>;
  explicit LaneTransform(std::size_t n, Planning planning = Planning::estimate, LineKernels kernels = LineKernels::own);
  std::size_t size() const { return n_; }
  bool uses_fftw() const;
  const fourier::LanePlan<T>& plan() const { return *plan_; }
  // Numbers that a transform needs for itself.
  std::size_t work_size() const;

  // `to` may be `from` with the same stride.
  void inverse(const Complex* from, std::size_t from_stride, Complex* to, std::size_t to_stride, Complex* work) const;
  void forward(const Complex* from, std::size_t from_stride, Complex* to, std::size_t to_stride, Complex* work) const;
  // In place, lines side by side without gaps.
  void inverse(Complex* buffer, Complex* work) const;
  void forward(Complex* buffer, Complex* work) const;

 private:
  template <bool inverse>
  void execute(const Complex* from, std::size_t from_stride, Complex* to, std::size_t to_stride, Complex* work) const;
  std::size_t n_;
  std::shared_ptr<const fourier::LanePlan<T>> plan_;
};

// One real line of n values (n even) and its n/2 + 1 modes, each aligned to 64 bytes, by FFTW; unscaled, and the input
// is lost.
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
