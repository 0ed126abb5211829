// SPDX-License-Identifier: MIT
// Values carried by images: scalars are copied; vectors are reflected, and velocities at walls also take the
// wall's motion: u' = 2 u_wall - u in the components that the wall holds.
#pragma once

#include <array>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/operators/pair_sweep.hpp"
#include "spume/operators/wall_stencils.hpp"

namespace spume {

// How velocities change along an image path: v' = sign * v + offset.
struct VelocityImageRule {
  // Per path of Images::paths() and component.
  std::vector<std::array<float, 3>> sign;
  // Per image and component; empty when no wall moves.
  std::array<Array<float>, 3> offset;
  // At wall points of bodies: whether no-slip surfaces hold the liquid, and whether their motion counts.
  bool friction = true, moving = true;
  bool bends = true;             // velocities go on behind no-slip surfaces as cubics, else odd about them: linear
  bool before_pressure = false;  // the velocities are those that the pressure of the step is to correct
};

// How values at images follow from those of their sources: the one place for everyone who reads images one by one.
struct ImageMap {
  const Images& images;
  const VelocityImageRule& velocity_rule;
  const std::vector<std::array<float, 3>>& reflection;  // of geometric vectors, per path

  std::size_t source(std::size_t k) const { return static_cast<std::size_t>(images.source()[k]); }
  std::size_t path(std::size_t k) const { return static_cast<std::size_t>(images.path()[k]); }
  // Component of the velocity of image k whose source has u; of what follows a velocity without the motion of walls
  // (an acceleration); of a geometric vector.
  double velocity(std::size_t k, int axis, double u) const {
    return velocity_rule.sign[path(k)][axis] * u + wall_velocity(k, axis);
  }
  float velocity_sign(std::size_t k, int axis) const { return velocity_rule.sign[path(k)][axis]; }
  float vector_sign(std::size_t k, int axis) const { return reflection[path(k)][axis]; }
  // d u_a / d x_b.
  double gradient(std::size_t k, int a, int b, double value) const {
    return value * (velocity_sign(k, a) * vector_sign(k, b));
  }
  bool walls_move() const { return !velocity_rule.offset[0].empty(); }
  float wall_velocity(std::size_t k, int axis) const { return walls_move() ? velocity_rule.offset[axis][k] : 0.0F; }
};

// Writes `payload` component `slot` (0-based) of all records from a scalar per particle.
void pack_scalar(const SweepContext& context, float* records, int width, int slot, const double* values);
void pack_scalar(const SweepContext& context, float* records, int width, int slot, const float* values);
// Sets it to 0 at wall points and their images.
void clear_wall_points(const SweepContext& context, float* records, int width, int slot);
// The same of a coefficient that must not change its sign: wall points take it from the nearest particle, not from a
// fit.
void pack_coefficient(const SweepContext& context, float* records, int width, int slot, const float* values);

// The same of a change of the pressure, which behind openings keeps to what is given there.
void pack_pressure_change(const SweepContext& context, float* records, int width, int slot, const float* values);

// write(k, value) for every image k, with the scalar that it carries; `values` is indexed by particle.
template <class T, class Write>
void for_each_image_value(const SweepContext& context, const T* values, Write&& write) {
  const std::int32_t* source = context.images->source();
  if (context.walls == nullptr) {
    parallel_for(context.images->size(), [&](std::size_t k) { write(k, static_cast<double>(values[source[k]])); });
    return;
  }
  const std::int32_t* point = context.images->wall_point();
  parallel_for(context.images->size(), [&](std::size_t k) {
    write(k, point[k] < 0 ? static_cast<double>(values[source[k]])
                          : context.walls->mirrored(static_cast<std::size_t>(point[k]), values));
  });
}

// The same of the pressure q, which has a part that is given behind openings and accelerated walls; `given` false
// leaves that out, as for a correction of q.
template <class T, class Write>
void for_each_image_pressure(const SweepContext& context, const T* values, bool given, Write&& write) {
  const double* own = given ? context.image_pressure : nullptr;
  if (own == nullptr && (context.walls == nullptr || !context.walls->openings())) {
    for_each_image_value(context, values, write);
    return;
  }
  const std::int32_t* source = context.images->source();
  const std::int32_t* point = context.walls == nullptr ? nullptr : context.images->wall_point();
  parallel_for(context.images->size(), [&](std::size_t k) {
    const double value = point == nullptr || point[k] < 0
                             ? static_cast<double>(values[source[k]])
                             : context.walls->pressure(static_cast<std::size_t>(point[k]), values, given);
    write(k, own == nullptr ? value : value + own[k]);
  });
}

// Writes components slot .. slot + dimensions - 1 from a velocity per particle. `of_walls`: wall points have that of
// their wall, in place of what the liquid has behind it.
void pack_velocity(const SweepContext& context, float* records, int width, int slot,
                   const std::array<const double*, 3>& velocity, const VelocityImageRule& rule, bool of_walls = false);

// The same of u + ahead a, without wall points: what a leap of half a step makes of a velocity need not be kept.
void pack_velocity(const SweepContext& context, float* records, int width, int slot,
                   const std::array<const double*, 3>& velocity, const std::array<const float*, 3>& acceleration,
                   double ahead, const VelocityImageRule& rule);

// The same for a geometric vector (a normal): reflected, without wall motion.
void pack_vector(const SweepContext& context, float* records, int width, int slot,
                 const std::array<const float*, 3>& values, const std::vector<std::array<float, 3>>& reflection);

}  // namespace spume
