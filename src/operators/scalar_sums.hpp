// SPDX-License-Identifier: MIT
// What the sweeps that carry scalars (scalar_transport.hpp) share: the value of points that exchange nothing, and the
// sums of a particle over its pairs.
#pragma once

#include <algorithm>
#include <array>

#include "spume/operators/pair_sweep.hpp"

namespace spume {

// The value of an image that exchanges nothing; its products with finite weights are finite.
inline constexpr float exchanges_nothing = 1e30F;

// write(record, i) for each record that has the values of particle i, and clear(record) for the images that exchange
// nothing: wall points, points behind openings, images in solid boxes.
template <class Write, class Clear>
void for_each_scalar_record(const SweepContext& context, Write&& write, Clear&& clear) {
  const std::size_t n = context.list->particles();
  parallel_for(n, [&](std::size_t i) { write(i, i); });
  const Images& images = *context.images;
  const std::int32_t* point = context.walls == nullptr ? nullptr : images.wall_point();
  parallel_for(images.size(), [&](std::size_t k) {
    const bool stands_for_wall = point != nullptr && point[k] >= 0;
    if (stands_for_wall || images.paths()[static_cast<std::size_t>(images.path()[k])].reflections() > 0)
      clear(n + k);
    else
      write(n + k, static_cast<std::size_t>(images.source()[k]));
  });
}

// Differences from what exchanges nothing, and from the sentinel, count as none.
template <class Kernel, class Batch>
[[gnu::always_inline]] inline auto exchanges(const Batch& b, simd::f32n value) {
  return (value < simd::splat<simd::f32n>(exchanges_nothing)) &
         (b.q < simd::splat<simd::f32n>(static_cast<float>(Kernel::support)));
}

// Of one particle and `count` scalars.
template <int count, bool shifted>
struct ScalarSums {
  simd::f32n exchange{};
  std::array<simd::f32n, count> rate{}, along{}, low{}, high{};

  [[gnu::always_inline]] void add(int s, simd::f32n weight, [[maybe_unused]] simd::f32n pull, simd::f32n difference) {
    rate[s] = rate[s] + weight * difference;
    if constexpr (shifted) {
      along[s] = along[s] + pull * difference;
      low[s] = simd::min(low[s], difference);
      high[s] = simd::max(high[s], difference);
    }
  }
  // By the shift: `factor` times the sum along it, within half of the extreme differences.
  float change(int s, float factor) const {
    return std::clamp(factor * simd::sum(along[s]), 0.5F * simd::least(low[s]), 0.5F * simd::largest(high[s]));
  }
};

}  // namespace spume
