// SPDX-License-Identifier: MIT
#include "spume/particles/half_steps.hpp"

namespace spume {
namespace {

// write(i, dt/2 (u' + delta u))
template <class Write>
[[gnu::always_inline]] inline void each_way(const HalfSteps& steps, int axis, std::size_t first, std::size_t last,
                                            Write&& write) {
  const double* const u = steps.velocity[axis];
  const float* const a = steps.acceleration[axis];
  const float* const shift = steps.shift[axis];
  const double half = steps.dt / 2;
  if (shift == nullptr) {
#pragma GCC ivdep
    for (std::size_t i = first; i < last; ++i) write(i, half * (u[i] + half * a[i]));
  } else {
#pragma GCC ivdep
    for (std::size_t i = first; i < last; ++i) write(i, half * (u[i] + half * a[i] + shift[i]));
  }
}

}  // namespace

void HalfSteps::velocities(int axis, std::size_t first, std::size_t last, double* result) const {
  const double* const u = velocity[axis];
  const float* const a = acceleration[axis];
  const double half = dt / 2;
#pragma GCC ivdep
  for (std::size_t i = first; i < last; ++i) result[i] = u[i] + half * a[i];
}

void HalfSteps::middles(int axis, std::size_t first, std::size_t last, double* result) const {
  const double* const r = position[axis];
  each_way(*this, axis, first, last, [=](std::size_t i, double way) { result[i] = r[i] + way; });
}

void HalfSteps::go_on(int axis, std::size_t first, std::size_t last, double* place) const {
  each_way(*this, axis, first, last, [=](std::size_t i, double way) { place[i] += way; });
}

void HalfSteps::finish(std::size_t first, std::size_t last, const double* of_first, float* after, double* u) const {
  const double half = dt / 2;
#pragma GCC ivdep
  for (std::size_t i = first; i < last; ++i) {
    after[i] = static_cast<float>(of_first[i - first]);
    u[i] += half * after[i];
  }
}

}  // namespace spume
