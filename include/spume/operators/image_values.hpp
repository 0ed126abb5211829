// SPDX-License-Identifier: MIT
// Values carried by images: scalars are copied; vectors are reflected, and velocities at walls also take the
// wall's motion: u' = 2 u_wall - u in the components that the wall holds.
#pragma once

#include <array>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/operators/pair_sweep.hpp"

namespace spume {

// How velocities change along an image path: v' = sign * v + offset.
struct VelocityImageRule {
  // Per path of Images::paths() and component.
  std::vector<std::array<float, 3>> sign;
  // Per image and component; empty when no wall moves.
  std::array<Array<float>, 3> offset;
};

// Writes `payload` component `slot` (0-based) of all records from a scalar per particle.
void pack_scalar(const SweepContext& context, float* records, int width, int slot, const double* values);
void pack_scalar(const SweepContext& context, float* records, int width, int slot, const float* values);

// Writes components slot .. slot + dimensions - 1 from a velocity per particle.
void pack_velocity(const SweepContext& context, float* records, int width, int slot,
                   const std::array<const double*, 3>& velocity, const VelocityImageRule& rule);

// The same for a geometric vector (a normal): reflected, without wall motion.
void pack_vector(const SweepContext& context, float* records, int width, int slot,
                 const std::array<const float*, 3>& values, const std::vector<std::array<float, 3>>& reflection);

}  // namespace spume
