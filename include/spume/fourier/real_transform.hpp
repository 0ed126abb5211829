// SPDX-License-Identifier: MIT
// Threaded discrete Fourier transforms of real fields in two and three dimensions (FFTW 3).
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <span>

namespace spume {

// Real field u of n = nx * ny * nz values (x fastest; nz = 1 in two dimensions) to the half spectrum
//   U(a, b, c) = sum_{i,j,k} u(i, j, k) exp(-2 pi i (a i / nx + b j / ny + c k / nz)),  a = 0 .. nx / 2,
// stored at a + (nx / 2 + 1) (b + ny c); modes with a > nx / 2 are the conjugates of the stored ones. The index b
// stands for the wavenumber b when b <= ny / 2 and b - ny otherwise, c likewise.
//
// Plans are shared by all transforms of one shape and live as long as the last of them. Creating one is
// thread-safe. Every execution uses the threads given at construction.
class RealTransform {
 public:
  // points: nx, ny, nz, all at least 1. threads: 0 takes omp_get_max_threads(). The plan, and so the last bits of
  // a result, may depend on the number of threads planned for, never on the number that happens to run.
  explicit RealTransform(std::array<std::size_t, 3> points, int threads = 0);

  std::array<std::size_t, 3> points() const { return points_; }
  std::size_t real_size() const { return points_[0] * points_[1] * points_[2]; }
  std::size_t spectral_size() const { return (points_[0] / 2 + 1) * points_[1] * points_[2]; }

  // Unscaled forward transform; `field` is kept. Both arrays hold the sizes above and are aligned to 16 bytes, as
  // every Array is; throws std::invalid_argument otherwise.
  void forward(std::span<const double> field, std::span<std::complex<double>> spectrum) const;

  // Inverse transform, scaled by 1 / n: inverse(forward(u)) = u to rounding. `spectrum` is overwritten.
  void inverse(std::span<std::complex<double>> spectrum, std::span<double> field) const;

 private:
  struct Plans;
  void require(std::span<const double> field, std::span<const std::complex<double>> spectrum) const;

  std::array<std::size_t, 3> points_;
  std::shared_ptr<const Plans> plans_;
};

}  // namespace spume
