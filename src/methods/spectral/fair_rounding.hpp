// SPDX-License-Identifier: MIT
// Sums in single precision that are right in the mean. In slow flows a step changes a mode by less than half of its
// last place: rounded to the nearest, no step would change it at all. So a sum is rounded up with the probability that
// its rest has of the last place (stochastic rounding: Croci et al., R. Soc. Open Sci. 9 (2022) 211631), by a uniform
// number of half the last place at most that is added before. The number is a hash of step, stage and place (the final
// mix of MurmurHash3): the same for any number of threads and after a resume.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "spume/fourier/lane_vector.hpp"

namespace spume::spectral {

template <class T>
class FairRounding;

// The last place of a double is far below what a step changes.
template <>
class FairRounding<double> {
  using V = fourier::Vector<double>;

 public:
  FairRounding(std::int64_t, std::size_t) {}
  V sum(V state, V change, std::size_t, std::size_t) const { return state + change; }
};

template <>
class FairRounding<float> {
  using V = fourier::Vector<float>;
  using U = std::uint32_t __attribute__((vector_size(sizeof(V))));

 public:
  FairRounding(std::int64_t step, std::size_t stage)
      : seed_(static_cast<std::uint32_t>(step) * 0x9E3779B1U + static_cast<std::uint32_t>(stage) * 0x7F4A7C15U) {}

  // state + change of component `c` of the complex numbers from `at` on.
  V sum(V state, V change, std::size_t at, std::size_t c) const {
    constexpr U lanes{0, 1, 2, 3, 4, 5, 6, 7};
    U x = lanes + (static_cast<std::uint32_t>(2 * at) ^ (seed_ + static_cast<std::uint32_t>(c) * 0x632BE5ABU));
    x = (x ^ x >> 16) * 0x85EBCA6BU;
    x = (x ^ x >> 13) * 0xC2B2AE35U;
    x ^= x >> 16;
    const V uniform = std::bit_cast<V>((x >> 9) | 0x3F800000U) - 1.5F;  // of [1, 2), less 1.5
    const V last_place = std::bit_cast<V>(std::bit_cast<U>(state) & 0x7F800000U) * 0x1p-23F;
    return state + (change + uniform * last_place);
  }

 private:
  std::uint32_t seed_;
};

}  // namespace spume::spectral
