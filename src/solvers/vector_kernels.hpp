// SPDX-License-Identifier: MIT
// Vector updates fused with double-precision sums. Sixteen partial sums per block, combined in a fixed order: the
// loop vectorises without letting the compiler choose an order of addition.
#pragma once

#include <array>
#include <cstddef>

#include "spume/core/parallel.hpp"

namespace spume::detail {

// Calls body(i, sums) for every i in [0, n); body adds its K terms to sums[0..K).
template <std::size_t K, class Body>
std::array<double, K> fused_sums(std::size_t n, Body&& body) {
  constexpr std::size_t lanes = 16;
  using Sums = std::array<double, K>;
  return parallel_reduce(
      n, Sums{},
      [&](std::size_t first, std::size_t last) {
        double lane[K][lanes] = {};
        std::size_t i = first;
        for (; i + lanes <= last; i += lanes) {
#pragma omp simd
          for (std::size_t l = 0; l < lanes; ++l) {
            const Sums term = body(i + l);
            for (std::size_t k = 0; k < K; ++k) lane[k][l] += term[k];
          }
        }
        Sums sum{};
        for (; i < last; ++i) {
          const Sums term = body(i);
          for (std::size_t k = 0; k < K; ++k) sum[k] += term[k];
        }
        for (std::size_t k = 0; k < K; ++k)
          for (std::size_t l = 0; l < lanes; ++l) sum[k] += lane[k][l];
        return sum;
      },
      [](Sums a, const Sums& b) {
        for (std::size_t k = 0; k < K; ++k) a[k] += b[k];
        return a;
      });
}

}  // namespace spume::detail
