// SPDX-License-Identifier: MIT
// Kernel sums at particles over the points of other sets (bubbles and their images).
//
//   sum_k w(|r_i - r_k| / h_i) v_k,  w without its normalisation.
//
// Sixteen particles that follow each other in the sorted order share one search; each point that it finds is taken to
// eight of them at a time. Groups depend on the sorted particles alone, so that the sums have the same bits for any
// number of threads.
//
// And the other way, at one point over the particles, with their widths: sum_j w(|r - r_j| / h_j) v_j.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "spume/core/kernel.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/simd.hpp"
#include "spume/neighbours/cross_search.hpp"

namespace spume {

// The particles that receive, sorted.
struct CrossTargets {
  std::size_t size = 0;
  std::array<const double*, 3> position{};
  std::array<double, 3> origin{};  // of the float coordinates of the points
  double smoothing_length = 0;     // h_i = smoothing_length length_ratio[i]
  const float* length_ratio = nullptr;
  const float* support_radius = nullptr;  // support of h_i
};

namespace detail {

inline constexpr std::size_t cross_block = 256, cross_group = 16;
// The longest box of a group along any axis, in support radii of the grid: more than the width of a row of cells, so
// that only thin liquid ends a group early. With half of it the sums over 100,000 particles take 4 times as long, with
// twice as much 2 % less, which is less than the repeats differ.
inline constexpr double cross_length = 1.25;

// The positions of a block, and what follows from h_i.
struct CrossBlock {
  alignas(32) float x[3][cross_block + cross_group], inverse_h[cross_block + cross_group];

  CrossBlock(const CrossTargets& targets, std::size_t first, std::size_t last) {
    const std::size_t size = last - first;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t k = 0; k < size; ++k)
        x[a][k] = static_cast<float>(targets.position[a][first + k] - targets.origin[a]);
    const auto h = static_cast<float>(targets.smoothing_length);
    for (std::size_t k = 0; k < size; ++k) inverse_h[k] = 1 / (h * targets.length_ratio[first + k]);
    for (std::size_t k = size; k < size + cross_group; ++k) {
      for (auto& axis : x) axis[k] = axis[size - 1];
      inverse_h[k] = inverse_h[size - 1];
    }
  }

  // The box of the group from k on, nowhere longer than `longest`; returns its end.
  std::size_t group(std::size_t k, std::size_t end, float longest, CrossSearch::Box& box) const {
    box = {{x[0][k], x[1][k], x[2][k]}, {x[0][k], x[1][k], x[2][k]}};
    std::size_t last = k + 1;
    for (; last < std::min(end, k + cross_group); ++last) {
      CrossSearch::Box larger = box;
      bool close = true;
      for (std::size_t a = 0; a < 3; ++a) {
        larger.lower[a] = std::min(box.lower[a], x[a][last]);
        larger.upper[a] = std::max(box.upper[a], x[a][last]);
        close = close && larger.upper[a] - larger.lower[a] <= longest;
      }
      if (!close) break;
      box = larger;
    }
    return last;
  }
};

}  // namespace detail

// records: per point its float coordinates and `components` values, 4 floats for one value, 8 for up to five. Calls
// store(i, sums) once for every particle, in parallel; `sums` is null where no point lies within the support of i, and
// is not where one does so only by rounding.
template <int components, class Kernel, class Store>
void sum_over_points(const CrossTargets& targets, const CrossSearch& search, double grid_support_radius,
                     const float* records, Store&& store) {
  using simd::f32x8;
  constexpr std::size_t width = components == 1 ? 4 : 8, vectors = detail::cross_group / simd::lanes;
  static_assert(components <= 5);
  // The least distance that counts as outside, (r / h)^2: a thousandth beyond the support, far above float rounding.
  const f32x8 beyond = simd::splat(static_cast<float>(1.001 * Kernel::support * Kernel::support));
  const auto longest = static_cast<float>(detail::cross_length * grid_support_radius);
  parallel_blocks(targets.size, detail::cross_block, [&](std::size_t, std::size_t first, std::size_t last) {
    thread_local CrossSearch::Found thread_found;
    CrossSearch::Found& found = thread_found;
    const detail::CrossBlock block(targets, first, last);
    const std::size_t size = last - first;
    for (std::size_t k = 0, end = 0; k < size; k = end) {
      CrossSearch::Box box;
      end = block.group(k, size, longest, box);
      float support_radius = 0;
      for (std::size_t l = k; l < end; ++l)
        support_radius = std::max(support_radius, targets.support_radius[first + l]);
      search.near_box(box, support_radius, found);
      alignas(32) float sums[components][detail::cross_group], least[detail::cross_group];
      for (std::size_t v = 0; v < vectors && found.size > 0; ++v) {
        const std::size_t lane = k + v * simd::lanes;
        const f32x8 x = simd::load(block.x[0] + lane), y = simd::load(block.x[1] + lane),
                    z = simd::load(block.x[2] + lane), inverse = simd::load(block.inverse_h + lane);
        const f32x8 inverse2 = inverse * inverse;
        std::array<f32x8, components> sum{};
        f32x8 nearest = beyond;
        for (std::size_t f = 0; f < found.size; ++f) {
          const float* point = records + static_cast<std::size_t>(found.index[f]) * width;
          const f32x8 dx = x - point[0], dy = y - point[1], dz = z - point[2];
          const f32x8 q2 = (dx * dx + dy * dy + dz * dz) * inverse2;
          nearest = simd::min(nearest, q2);
          const f32x8 w = Kernel::w(simd::sqrt(q2));
          for (std::size_t c = 0; c < components; ++c) sum[c] = sum[c] + w * point[3 + c];
        }
        for (std::size_t c = 0; c < components; ++c) simd::store(sums[c] + v * simd::lanes, sum[c]);
        simd::store(least + v * simd::lanes, nearest);
      }
      for (std::size_t l = 0; l < end - k; ++l) {
        std::array<float, components> own{};
        const bool near = found.size > 0 && least[l] < beyond[0];
        for (std::size_t c = 0; c < components && near; ++c) own[c] = sums[c][l];
        store(first + k + l, near ? own.data() : nullptr);
      }
    }
  });
}

// Floats of a line: v_j of sum_of_lines.
inline constexpr std::size_t line_floats = 2 * simd::lanes;

// The sum at a place over what near_place found around it; lines: line_floats values for every point. The shares in
// `found` become the weights.
template <class Kernel>
[[gnu::always_inline]] inline std::array<simd::f32x8, 2> sum_of_lines(CrossSearch::Found& found, const float* lines) {
  using simd::f32x8;
  float* const weight = found.share2.data();
  for (std::size_t k = 0; k < found.size; k += simd::lanes)
    simd::store(weight + k, Kernel::w(static_cast<float>(Kernel::support) * simd::sqrt(simd::load(weight + k))));
  // Two sums, of even and odd places, as an addition takes longer than a load. Behind an odd number stands a share of
  // 1, which weighs nothing.
  f32x8 low{}, high{}, odd_low{}, odd_high{};
  found.index[found.size] = found.size > 0 ? found.index[0] : 0;
  for (std::size_t k = 0; k < found.size; k += 2) {
    const float* even = lines + static_cast<std::size_t>(found.index[k]) * line_floats;
    const float* odd = lines + static_cast<std::size_t>(found.index[k + 1]) * line_floats;
    low = low + weight[k] * simd::load(even);
    high = high + weight[k] * simd::load(even + simd::lanes);
    odd_low = odd_low + weight[k + 1] * simd::load(odd);
    odd_high = odd_high + weight[k + 1] * simd::load(odd + simd::lanes);
  }
  return {low + odd_low, high + odd_high};
}

}  // namespace spume
