// SPDX-License-Identifier: MIT
#include "spume/core/random.hpp"

#include <Random123/philox.h>

#include <cmath>
#include <numbers>

namespace spume {

std::array<double, 4> random_uniform(std::uint64_t seed, RandomPurpose purpose, std::uint64_t identifier,
                                     std::uint32_t step, std::uint32_t draw) {
  // The 64-bit seed and the purpose share the two key words: the purpose is mixed into the upper word, where
  // seeds below 2^32 have nothing.
  const r123::Philox4x32::key_type key{
      {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32) ^ static_cast<std::uint32_t>(purpose)}};
  const r123::Philox4x32::ctr_type counter{
      {static_cast<std::uint32_t>(identifier), static_cast<std::uint32_t>(identifier >> 32), step, draw}};
  const auto bits = r123::Philox4x32{}(counter, key);
  constexpr double scale = 1.0 / 4294967296.0;
  return {bits[0] * scale, bits[1] * scale, bits[2] * scale, bits[3] * scale};
}

std::array<double, 4> random_normal(std::uint64_t seed, RandomPurpose purpose, std::uint64_t identifier,
                                    std::uint32_t step, std::uint32_t draw) {
  const auto u = random_uniform(seed, purpose, identifier, step, draw);
  std::array<double, 4> normal;
  for (std::size_t pair = 0; pair < 4; pair += 2) {
    const double length = std::sqrt(-2 * std::log(1 - u[pair]));  // 1 - u is never zero
    const double angle = 2 * std::numbers::pi * u[pair + 1];
    normal[pair] = length * std::cos(angle);
    normal[pair + 1] = length * std::sin(angle);
  }
  return normal;
}

}  // namespace spume
