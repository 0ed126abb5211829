// SPDX-License-Identifier: MIT
// What the sweeps that carry scalars (scalar_transport.hpp) sum over the neighbours of a particle for each of them.
#pragma once

#include <algorithm>
#include <array>

#include "spume/core/joined_lanes.hpp"
#include "spume/core/unrolled.hpp"

namespace spume {

// Of `count` scalars whose values lie side by side in a record.
template <int count, bool shifted, bool eddies = false>
class ScalarSums {
 public:
  // The particle's own values.
  [[gnu::always_inline]] explicit ScalarSums(const float* own) {
    unrolled<count>([&](auto s) __attribute__((always_inline)) { own_[s] = simd::splat<simd::f32n>(own[s]); });
  }

  // Adds weight (c_j - c_i) to the rates, pull (c_j - c_i) to the sums along the shift, where `counts`; payload[first]
  // is c_j of the first scalar.
  template <int first, class Payload, class Mask>
  [[gnu::always_inline]] void add(const Payload& payload, Mask counts, simd::f32n weight, simd::f32n pull,
                                  simd::f32n by_eddies) {
    unrolled<count>([&](auto s) __attribute__((always_inline)) {
      const simd::f32n difference = counts ? payload[first + s] - own_[s] : simd::f32n{};
      rate_[s] = rate_[s] + weight * difference;
      if constexpr (eddies) eddy_rate_[s] = eddy_rate_[s] + by_eddies * difference;
      if constexpr (shifted) {
        along_[s] = along_[s] + pull * difference;
        low_[s] = simd::min(low_[s], difference);
        high_[s] = simd::max(high_[s], difference);
      }
    });
  }

  // Over the lanes.
  struct Found {
    std::array<float, count> rate, eddy_rate{};
    std::array<float, count> change;  // the sums along the shift times a factor, within half of the extreme differences
  };
  [[gnu::always_inline]] Found found([[maybe_unused]] float factor) const {
    constexpr int sums = 1 + (shifted ? 1 : 0) + (eddies ? 1 : 0);
    std::array<simd::f32n, sums * count> to_sum;
    std::array<simd::f32n, 2 * count> to_compare;
    unrolled<count>([&](auto s) __attribute__((always_inline)) {
      to_sum[s] = rate_[s];
      if constexpr (shifted) {
        to_sum[count + s] = along_[s];
        to_compare[s] = -low_[s];
        to_compare[count + s] = high_[s];
      }
      if constexpr (eddies) to_sum[(sums - 1) * count + s] = eddy_rate_[s];
    });
    Found found;
    const std::array<float, sums* count> sum = simd::sums_of(to_sum);
    std::copy_n(sum.begin(), count, found.rate.begin());
    if constexpr (eddies) std::copy_n(sum.begin() + (sums - 1) * count, count, found.eddy_rate.begin());
    if constexpr (shifted) {
      const std::array<float, 2 * count> largest = simd::largest_of(to_compare);
      for (int s = 0; s < count; ++s)
        found.change[s] = std::clamp(factor * sum[count + s], -0.5F * largest[s], 0.5F * largest[count + s]);
    }
    return found;
  }

 private:
  std::array<simd::f32n, count> own_;
  std::array<simd::f32n, count> rate_{}, eddy_rate_{}, along_{}, low_{}, high_{};
};

}  // namespace spume
