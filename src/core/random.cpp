// SPDX-License-Identifier: MIT
#include "spume/core/random.hpp"

#include <Random123/philox.h>

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

}  // namespace spume
