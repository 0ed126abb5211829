// SPDX-License-Identifier: MIT
// How lines of a length are transformed: passes of our own, or a plan of FFTW.
#pragma once

#include <complex>
#include <vector>

#include "fftw.hpp"
#include "spume/core/array.hpp"
#include "spume/fourier/line_transform.hpp"
#include "spume/fourier/mode_layout.hpp"

namespace spume::fourier {

template <class T>
struct LanePass {
  int radix = 0;
  std::size_t rest = 0;   // product of the radices that follow
  std::size_t apart = 0;  // product of those before
  Array<T> turns;         // cos and sin of 2 pi p k / (radix rest), for each p < rest all 0 < k < radix
};

template <class T>
struct PlanPair {
  typename fftw::Api<T>::Plan forward = nullptr, inverse = nullptr;
  PlanPair() = default;
  PlanPair(const PlanPair&) = delete;
  PlanPair& operator=(const PlanPair&) = delete;
  ~PlanPair() {
    const std::lock_guard lock(fftw::planner_mutex());
    fftw::Api<T>::destroy(forward);
    fftw::Api<T>::destroy(inverse);
  }
};

template <class T>
struct LanePlan {
  std::size_t n;
  std::vector<LanePass<T>> passes;  // at least two; none: FFTW
  PlanPair<T> fftw_plans;           // in place, lines side by side without gaps

  LanePlan(std::size_t n, Planning planning, LineKernels kernels);
  std::size_t work_size() const { return (passes.size() > 2 ? 2 : 1) * n * lanes<T>; }
  void execute_fftw(bool inverse, std::complex<T>* buffer) const {
    auto* const line = fftw::pointer(buffer);
    fftw::Api<T>::execute(inverse ? fftw_plans.inverse : fftw_plans.forward, line, line);
  }
};

}  // namespace spume::fourier
