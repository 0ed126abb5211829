// SPDX-License-Identifier: MIT
// Slopes of the kernel with the tensile term, King (3.11) with W(dr) for W(0).
#pragma once

#include "spume/operators/pair_sweep.hpp"

namespace spume {

inline constexpr double tensile_factor = 0.25;

template <class Kernel>
class TensileGradient {
 public:
  TensileGradient(const SweepContext& context, double spacing)
      : inverse_reference_(static_cast<float>(1 / Kernel::w(spacing / context.smoothing_length))) {}
  // Of a slope g where the kernel, without its factor, is w.
  [[gnu::always_inline]] simd::f32n operator()(simd::f32n g, simd::f32n w) const {
    const simd::f32n ratio = w * inverse_reference_;
    const simd::f32n ratio2 = ratio * ratio;
    return g + static_cast<float>(tensile_factor) * g * ratio2 * ratio2;
  }

 private:
  float inverse_reference_;
};

}  // namespace spume
