// SPDX-License-Identifier: MIT
// How far the neighbours of a particle bear a change of its velocity along a displacement s, as VelocityGradientOut has
// it: each shows the difference u_j - u_i, in proportion to how far along it s goes, s . d / d^2.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "spume/core/joined_lanes.hpp"
#include "spume/operators/sph_operators.hpp"

namespace spume {

template <int dimensions>
class ChangeBounds {
 public:
  ChangeBounds() = default;
  explicit ChangeBounds(const std::array<float, dimensions>& displacement) {
    for (int c = 0; c < dimensions; ++c) displacement_[c] = simd::splat<simd::f32n>(displacement[c]);
  }

  // The shares of a batch of neighbours that lie ahead, and of those behind, which are negative.
  struct Shares {
    simd::f32n ahead, behind;
  };
  template <class Kernel, class Batch>
  [[gnu::always_inline]] Shares shares(const Batch& b) const {
    simd::f32n along{}, square{};
    for (int c = 0; c < dimensions; ++c) {
      along = along + displacement_[c] * b.d[c];
      square = square + b.d[c] * b.d[c];
    }
    const simd::f32n share = along / simd::max(square, simd::splat<simd::f32n>(std::numeric_limits<float>::min()));
    // Not the sentinel's.
    const simd::f32n near = b.q < simd::splat<simd::f32n>(static_cast<float>(Kernel::support)) ? share : simd::f32n{};
    return {simd::max(near, simd::f32n{}), simd::min(near, simd::f32n{})};
  }
  [[gnu::always_inline]] void add(int a, const Shares& shares, simd::f32n difference) {
    ahead_.add(a, shares.ahead * difference);
    behind_.add(a, shares.behind * difference);
  }

  // Cuts a change to what those ahead and those behind both show of it.
  void cut(std::array<float, dimensions>& change) const {
    const auto ahead = ahead_.sizes(), behind = behind_.sizes();
    for (int a = 0; a < dimensions; ++a) {
      const float low = std::min(ahead[a], behind[a]);
      const float high = std::min(ahead[dimensions + a], behind[dimensions + a]);
      change[a] = std::clamp(change[a], -allowed_change * low, allowed_change * high);
    }
  }

 private:
  // The least and the largest of 0 and what neighbours of one side show.
  struct Extremes {
    std::array<simd::f32n, dimensions> least{}, largest{};

    [[gnu::always_inline]] void add(int a, simd::f32n change) {
      least[a] = simd::min(least[a], change);
      largest[a] = simd::max(largest[a], change);
    }
    // The least with the sign changed before the largest.
    std::array<float, 2 * dimensions> sizes() const {
      std::array<simd::f32n, 2 * dimensions> both;
      for (int a = 0; a < dimensions; ++a) both[a] = -least[a], both[dimensions + a] = largest[a];
      return simd::largest_of(both);
    }
  };

  std::array<simd::f32n, dimensions> displacement_{};
  Extremes ahead_, behind_;
};

}  // namespace spume
