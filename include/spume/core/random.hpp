// SPDX-License-Identifier: MIT
// Counter-based random numbers (Random123, Philox 4x32-10; Salmon et al. 2011). A number is a pure function of
// (seed, purpose, identifier, step, draw): it does not depend on the thread count or on the order of calls.
#pragma once

#include <array>
#include <cstdint>

namespace spume {

// What a stream of numbers is used for; a new use gets a new value, so that streams never coincide.
enum class RandomPurpose : std::uint32_t {
  initial_jitter = 1,
  initial_field = 2,
  initial_position = 3,
  diameter = 4,
  parting = 5,
  overlap = 6,
  separation = 7,
  bubble_fluctuation = 10,
  bubble_breakup = 11,
  bubble_entrainment = 12,
  bubble_source = 13,
  force_sample = 14,
  wave_component = 15,
  wall_point = 16,
  test = 100
};

// Four uniform numbers in [0, 1) with 32 random bits each.
std::array<double, 4> random_uniform(std::uint64_t seed, RandomPurpose purpose, std::uint64_t identifier,
                                     std::uint32_t step, std::uint32_t draw);

// Four independent standard normal numbers (Box and Muller 1958).
std::array<double, 4> random_normal(std::uint64_t seed, RandomPurpose purpose, std::uint64_t identifier,
                                    std::uint32_t step, std::uint32_t draw);

}  // namespace spume
