// SPDX-License-Identifier: MIT
#include "spume/particles/fastest.hpp"

#include <algorithm>
#include <cmath>

#include "spume/particles/blocks.hpp"

namespace spume {
namespace {

// Of a bound that is not to be missed by rounding.
constexpr double above_rounding = 1e-12;

// Powers are found where the sum may be the largest so far alone: (1 + s)^e, 0 <= e <= 1, lies below its tangent at 0.
double largest_of_gas(const PhaseLaw& own, const double* excess, const double* speed2, std::size_t n, double so_far) {
  const double e = (own.exponent - 1) / 2;
  for (std::size_t k = 0; k < n; ++k) {
    const double s = excess[k], speed = std::sqrt(speed2[k]);
    if (e >= 0 && e <= 1 && (1 + above_rounding) * (own.sound_speed * (1 + e * s) + speed) <= so_far) continue;
    so_far = larger_or_nan(so_far, own.local_sound_speed(s) + speed);
  }
  return so_far;
}

}  // namespace

void Fastest::take(const State& state, std::size_t first, std::size_t last) {
  for (; last - first > default_block; first += default_block) take(state, first, first + default_block);
  ParticleBlock sum;
  if (state.acceleration[0] != nullptr) {
    const double largest = largest_square(state.dimensions, first, last, sum, [&](int axis) {
      return [a = state.acceleration[axis]](std::size_t i) { return double{a[i]}; };
    });
    acceleration2 = larger_or_nan(acceleration2, largest);
  }
  if (state.shift[0] != nullptr) {
    const double largest = largest_square(state.dimensions, first, last, sum, [&](int axis) {
      return [u = state.velocity[axis], s = state.shift[axis]](std::size_t i) { return u[i] + s[i]; };
    });
    transport2 = larger_or_nan(transport2, largest);
  }
  const double largest = largest_square(state.dimensions, first, last, sum, [&](int axis) {
    return [u = state.velocity[axis]](std::size_t i) { return u[i]; };
  });
  speed2 = larger_or_nan(speed2, largest);
  if (state.shift[0] == nullptr) transport2 = larger_or_nan(transport2, largest);
  state.law.each_run(first, last, [&](const PhaseLaw& own, std::size_t from, std::size_t to) {
    const double* const s = state.excess + from;
    const double* const squares = sum.data() + (from - first);
    const std::size_t n = to - from;
    strain = larger_or_nan(strain, largest_size(s, 0, n) / own.largest_change());
    if (own.exponent == liquid_exponent) {
      std::int64_t fastest = 0;
      for (std::size_t k = 0; k < n; ++k)
        fastest = std::max(fastest, size_bits(own.local_sound_speed(s[k]) + std::sqrt(squares[k])));
      signal = larger_or_nan(signal, of_size_bits(fastest));
    } else {
      signal = largest_of_gas(own, s, squares, n, signal);
    }
  });
}

Fastest Fastest::of_both(const Fastest& a, const Fastest& b) {
  return {.signal = larger_or_nan(a.signal, b.signal),
          .speed2 = larger_or_nan(a.speed2, b.speed2),
          .transport2 = larger_or_nan(a.transport2, b.transport2),
          .acceleration2 = larger_or_nan(a.acceleration2, b.acceleration2),
          .strain = larger_or_nan(a.strain, b.strain)};
}

}  // namespace spume
