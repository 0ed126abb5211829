// SPDX-License-Identifier: MIT
#include "spume/particles/excess_step.hpp"

#include "spume/core/parallel.hpp"

namespace spume {

void ExcessStep::advance(std::size_t first, std::size_t last) const {
  law.each_run(first, last, [&, step = *this](const PhaseLaw& own, std::size_t from, std::size_t to) {
    const double* const s = step.excess;
    double* const after = step.next;
    // d rho / dt = rho D by the midpoint rule: rho' = rho (1 + dt D / 2) / (1 - dt D / 2).
#pragma GCC ivdep
    for (std::size_t i = from; i < to; ++i) {
      const double grown = step.dt / 2 * step.rate[i];
      after[i] =
          s[i] + ((1 + s[i]) * 2 * grown / (1 - grown) + step.dt * step.diffusion * own.sound_speed * step.spread[i]);
    }
    for (std::size_t i = from; i < to && step.left_out != nullptr; ++i)
      if (step.left_out[i] >= 0) after[i] = s[i];
    if (step.lack != nullptr)
#pragma GCC ivdep
      for (std::size_t i = from; i < to; ++i) after[i] += step.share * step.lack[i];
    if (step.carried != nullptr) {
      std::array<double, default_block> climbed;  // delta u . grad s, of the reduced excess and of the hydrostatic part
      for (std::size_t i = from; i < to; ++i) climbed[i - from] = step.carried[i];
      for (int axis = 0; axis < step.dimensions; ++axis) {
        const float* const way = step.shift[axis];
        const double g = step.gravity[axis], c2 = own.sound_speed * own.sound_speed;
        if (g == 0) continue;
        for (std::size_t i = from; i < to; ++i) climbed[i - from] += g * way[i] / c2;
      }
      for (std::size_t i = from; i < to; ++i) after[i] += step.dt * climbed[i - from];
    }
    // Powers are rounded before 1 is taken off, as where pressures are found one by one: contracted with that, they
    // would change one pressure in a million by the last bit of a float.
    std::array<double, default_block> power;
    for (std::size_t i = from; i < to; ++i) power[i - from] = tait_power(1 + after[i], own.exponent);
    float *const p = step.pressure, *const v = step.volume;
#pragma GCC ivdep
    for (std::size_t i = from; i < to; ++i) {
      p[i] = static_cast<float>(own.stiffness() * (power[i - from] - 1) + step.background);
      v[i] = static_cast<float>(1 / (1 + after[i]));
    }
  });
}

void ReducedExcess::find(std::size_t first, std::size_t last) const {
  std::array<double, default_block> head{};  // g . r
  for (int axis = 0; axis < dimensions; ++axis) {
    if (gravity[axis] == 0) continue;
    const double g = gravity[axis], lower = origin[axis], *const r = place[axis] + first;
    for (std::size_t k = 0; k < last - first; ++k) head[k] += g * (r[k] - lower);
  }
  law.each_run(first, last,
               [&, s = excess, v = volume, below = reduced](const PhaseLaw& own, std::size_t from, std::size_t to) {
                 const double c2 = own.sound_speed * own.sound_speed, *const heads = head.data();
#pragma GCC ivdep
                 for (std::size_t i = from; i < to; ++i) {
                   v[i] = static_cast<float>(1 / (1 + s[i]));
                   below[i] = static_cast<float>(s[i] - heads[i - first] / c2);
                 }
               });
}

}  // namespace spume
