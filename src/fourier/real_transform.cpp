// SPDX-License-Identifier: MIT
#include "spume/fourier/real_transform.hpp"

#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <tuple>

#include "fftw.hpp"
#include "spume/core/array.hpp"
#include "spume/core/parallel.hpp"

namespace spume {

namespace {

using Complex = std::complex<double>;
using fftw::planner_mutex;

fftw_complex* fftw_pointer(Complex* values) {
  return fftw::pointer(values);
}

}  // namespace

struct RealTransform::Plans {
  fftw_plan forward = nullptr;
  fftw_plan inverse = nullptr;

  Plans(std::array<std::size_t, 3> points, int threads) {
    static const bool threads_ready = fftw_init_threads() != 0;
    if (!threads_ready) throw std::runtime_error("FFTW cannot start its threads");
    fftw_plan_with_nthreads(threads);
    // FFTW's last axis varies fastest, which is x here.
    const int extents[3] = {static_cast<int>(points[2]), static_cast<int>(points[1]), static_cast<int>(points[0])};
    Array<double> field(points[0] * points[1] * points[2]);
    Array<Complex> spectrum((points[0] / 2 + 1) * points[1] * points[2]);
    const int skipped = points[2] == 1 ? 1 : 0;
    forward = fftw_plan_dft_r2c(3 - skipped, extents + skipped, field.data(), fftw_pointer(spectrum.data()),
                                FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
    inverse =
        fftw_plan_dft_c2r(3 - skipped, extents + skipped, fftw_pointer(spectrum.data()), field.data(), FFTW_ESTIMATE);
    if (forward == nullptr || inverse == nullptr) {
      if (forward != nullptr) fftw_destroy_plan(forward);
      if (inverse != nullptr) fftw_destroy_plan(inverse);
      throw std::runtime_error("FFTW has no transform for a grid of " + std::to_string(points[0]) + " x " +
                               std::to_string(points[1]) + " x " + std::to_string(points[2]) + " points");
    }
  }
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;
  ~Plans() {
    const std::lock_guard lock(planner_mutex());
    fftw_destroy_plan(forward);
    fftw_destroy_plan(inverse);
  }
};

RealTransform::RealTransform(std::array<std::size_t, 3> points, int threads) : points_(points) {
  for (const std::size_t n : points)
    if (n == 0 || n > (std::size_t{1} << 30))
      throw std::invalid_argument("a Fourier transform of " + std::to_string(n) +
                                  " points along one axis; expected 1 to 2^30");
  const int planned = threads > 0 ? threads : thread_count();
  using Key = std::tuple<std::size_t, std::size_t, std::size_t, int>;
  static std::map<Key, std::weak_ptr<const Plans>> cache;
  const Key key{points[0], points[1], points[2], planned};
  const std::lock_guard lock(planner_mutex());
  plans_ = cache[key].lock();
  if (!plans_) {
    plans_ = std::make_shared<const Plans>(points, planned);
    cache[key] = plans_;
  }
}

void RealTransform::require(std::span<const double> field, std::span<const Complex> spectrum) const {
  if (field.size() != real_size() || spectrum.size() != spectral_size())
    throw std::invalid_argument("a Fourier transform was given " + std::to_string(field.size()) + " values and " +
                                std::to_string(spectrum.size()) + " modes; expected " + std::to_string(real_size()) +
                                " and " + std::to_string(spectral_size()));
  const auto* modes = reinterpret_cast<const double*>(spectrum.data());
  if (fftw_alignment_of(const_cast<double*>(field.data())) != 0 || fftw_alignment_of(const_cast<double*>(modes)) != 0)
    throw std::invalid_argument("a Fourier transform was given an array that is not aligned to 16 bytes");
}

void RealTransform::forward(std::span<const double> field, std::span<Complex> spectrum) const {
  require(field, spectrum);
  // The plan preserves its input; FFTW's interface lacks the const.
  fftw_execute_dft_r2c(plans_->forward, const_cast<double*>(field.data()), fftw_pointer(spectrum.data()));
}

void RealTransform::inverse(std::span<Complex> spectrum, std::span<double> field) const {
  require(field, spectrum);
  fftw_execute_dft_c2r(plans_->inverse, fftw_pointer(spectrum.data()), field.data());
  const double scale = 1.0 / static_cast<double>(real_size());
  parallel_for(field.size(), [&](std::size_t i) { field[i] *= scale; });
}

}  // namespace spume
