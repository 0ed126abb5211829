// SPDX-License-Identifier: MIT
#include "spume/operators/wall_stencils.hpp"

#include <cmath>

namespace spume {

std::array<double, 3> WallStencils::velocity(std::size_t g, int dimensions,
                                             const std::array<const double*, 3>& velocity, bool friction, bool moving,
                                             bool before, bool bends) const {
  std::array<double, 3> u{}, wall{};
  double across = 0;
  if (!is_wall(g) && moving && kind[g] == PointKind::inflow) {
    for (int axis = 0; axis < dimensions; ++axis)
      u[axis] = double{wall_velocity[axis][g]} + (before ? predicted[axis][g] : 0.0F);
    return u;
  }
  for (int axis = 0; axis < dimensions; ++axis) {
    u[axis] = mirrored(g, velocity[axis]);
    wall[axis] = moving ? wall_velocity[axis][g] : 0.0;
    across += (u[axis] - wall[axis]) * normal[axis][g];
  }
  if (!is_wall(g)) return u;
  if (!friction || no_slip[g] == 0) {
    for (int axis = 0; axis < dimensions; ++axis) u[axis] -= 2 * across * normal[axis][g];
    return u;
  }
  if (bend.empty() || !bends) {
    for (int axis = 0; axis < dimensions; ++axis) u[axis] = 2 * wall[axis] - u[axis];
    return u;
  }
  // At most as large as the difference from the wall, as of a profile that turns round half as far before it: slopes of
  // disordered particles may be anything.
  std::array<double, 3> bent{};
  double bent2 = 0, slip2 = 0;
  const std::int64_t begin = first[g], end = first[g + 1];
  for (int axis = 0; axis < dimensions; ++axis) {
    const double slip = u[axis] - wall[axis];
    const double* const value = velocity[axis];
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::int64_t k = begin; k < end; ++k) sum += bend[k] * (value[source[k]] - wall[axis]);
    bent[axis] = sum;
    bent2 += sum * sum;
    slip2 += slip * slip;
  }
  const double share = bent2 > slip2 ? std::sqrt(slip2 / bent2) : 1;
  for (int axis = 0; axis < dimensions; ++axis) u[axis] = 2 * wall[axis] - u[axis] + share * bent[axis];
  return u;
}

std::array<double, 3> WallStencils::vector(std::size_t g, int dimensions,
                                           const std::array<const float*, 3>& values) const {
  std::array<double, 3> v{};
  double across = 0;
  for (int axis = 0; axis < dimensions; ++axis) {
    v[axis] = mirrored(g, values[axis]);
    across += v[axis] * normal[axis][g];
  }
  if (!is_wall(g)) return v;
  for (int axis = 0; axis < dimensions; ++axis) v[axis] -= 2 * across * normal[axis][g];
  return v;
}

void WallStencils::clear() {
  first.resize(0);
  no_slip.resize(0);
  nearest.resize(0);
  kind.resize(0);
  pressure_sign.resize(0);
  given_pressure.resize(0);
  source.resize(0);
  coefficient.resize(0);
  bend.resize(0);
  for (auto* vector : {&normal, &wall_velocity, &predicted})
    for (auto& component : *vector) component.resize(0);
}

double WallStencils::bytes() const {
  double sum = kind.bytes() + pressure_sign.bytes() + given_pressure.bytes() + first.bytes() + no_slip.bytes() +
               nearest.bytes() + source.bytes() + coefficient.bytes() + bend.bytes();
  for (const auto* vector : {&normal, &wall_velocity, &predicted})
    for (const auto& component : *vector) sum += component.bytes();
  return sum;
}

}  // namespace spume
