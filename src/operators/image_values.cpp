// SPDX-License-Identifier: MIT
#include "spume/operators/image_values.hpp"

namespace spume {
namespace {

template <class T>
void pack_scalar_any(const SweepContext& context, float* records, int width, int slot, const T* values) {
  const std::size_t n = context.list->particles();
  float* out = records + context.dimensions + slot;
  const auto w = static_cast<std::size_t>(width);
  parallel_for(n, [=](std::size_t i) { out[i * w] = static_cast<float>(values[i]); });
  for_each_image_value(context, values,
                       [=](std::size_t k, double value) { out[(n + k) * w] = static_cast<float>(value); });
}

}  // namespace

void pack_scalar(const SweepContext& context, float* records, int width, int slot, const double* values) {
  pack_scalar_any(context, records, width, slot, values);
}
void pack_scalar(const SweepContext& context, float* records, int width, int slot, const float* values) {
  pack_scalar_any(context, records, width, slot, values);
}

void clear_wall_points(const SweepContext& context, float* records, int width, int slot) {
  if (context.walls == nullptr) return;
  const std::size_t n = context.list->particles();
  const std::int32_t* point = context.images->wall_point();
  float* out = records + context.dimensions + slot;
  const auto w = static_cast<std::size_t>(width);
  parallel_for(context.images->size(), [=](std::size_t k) {
    if (point != nullptr && point[k] >= 0) out[(n + k) * w] = 0;
  });
}

void pack_pressure_change(const SweepContext& context, float* records, int width, int slot, const float* values) {
  const std::size_t n = context.list->particles();
  float* out = records + context.dimensions + slot;
  const auto w = static_cast<std::size_t>(width);
  parallel_for(n, [=](std::size_t i) { out[i * w] = values[i]; });
  for_each_image_pressure(context, values, false,
                          [=](std::size_t k, double value) { out[(n + k) * w] = static_cast<float>(value); });
}

void pack_coefficient(const SweepContext& context, float* records, int width, int slot, const float* values) {
  const std::size_t n = context.list->particles();
  const std::int32_t* source = context.images->source();
  float* out = records + context.dimensions + slot;
  const auto w = static_cast<std::size_t>(width);
  parallel_for(n, [=](std::size_t i) { out[i * w] = values[i]; });
  parallel_for(context.images->size(), [=](std::size_t k) { out[(n + k) * w] = values[source[k]]; });
}

namespace {

// of_particle(i, axis) and of_point(g), the velocity of a wall point.
template <class OfParticle, class OfPoint>
void pack_velocity_any(const SweepContext& context, float* records, int width, int slot, const VelocityImageRule& rule,
                       const OfParticle& of_particle, const OfPoint& of_point) {
  const int dimensions = context.dimensions;
  const std::size_t n = context.list->particles();
  const std::int32_t* source = context.images->source();
  const std::int32_t* path = context.images->path();
  float* out = records + dimensions + slot;
  const auto w = static_cast<std::size_t>(width);
  parallel_for(n, [=](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) out[i * w + axis] = static_cast<float>(of_particle(i, axis));
  });
  const bool moving = !rule.offset[0].empty();
  const std::int32_t* point = context.walls == nullptr ? nullptr : context.images->wall_point();
  parallel_for(context.images->size(), [&, out, w, n, moving, point](std::size_t k) {
    const auto& sign = rule.sign[path[k]];
    if (point != nullptr && point[k] >= 0) {
      const auto u = of_point(static_cast<std::size_t>(point[k]));
      for (int axis = 0; axis < dimensions; ++axis) {
        const float value = sign[axis] * static_cast<float>(u[axis]);
        out[(n + k) * w + axis] = moving ? value + rule.offset[axis][k] : value;
      }
      return;
    }
    for (int axis = 0; axis < dimensions; ++axis) {
      const float value = sign[axis] * static_cast<float>(of_particle(static_cast<std::size_t>(source[k]), axis));
      out[(n + k) * w + axis] = moving ? value + rule.offset[axis][k] : value;
    }
  });
}

}  // namespace

void pack_velocity(const SweepContext& context, float* records, int width, int slot,
                   const std::array<const double*, 3>& velocity, const VelocityImageRule& rule, bool of_walls) {
  pack_velocity_any(
      context, records, width, slot, rule, [=](std::size_t i, int axis) { return velocity[axis][i]; },
      [&](std::size_t g) {
        if (of_walls) return context.walls->surface_velocity(g, context.dimensions);
        return context.walls->velocity(g, context.dimensions, velocity, rule.friction, rule.moving,
                                       rule.before_pressure, rule.bends);
      });
}

void pack_velocity(const SweepContext& context, float* records, int width, int slot,
                   const std::array<const double*, 3>& velocity, const std::array<const float*, 3>& acceleration,
                   double ahead, const VelocityImageRule& rule) {
  pack_velocity_any(
      context, records, width, slot, rule,
      [=](std::size_t i, int axis) { return velocity[axis][i] + ahead * acceleration[axis][i]; },
      [](std::size_t) { return std::array<double, 3>{}; });
}

void pack_vector(const SweepContext& context, float* records, int width, int slot,
                 const std::array<const float*, 3>& values, const std::vector<std::array<float, 3>>& reflection) {
  const int dimensions = context.dimensions;
  const std::size_t n = context.list->particles();
  const std::int32_t* source = context.images->source();
  const std::int32_t* path = context.images->path();
  float* out = records + dimensions + slot;
  const auto w = static_cast<std::size_t>(width);
  parallel_for(n, [=](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) out[i * w + axis] = values[axis][i];
  });
  const std::int32_t* point = context.walls == nullptr ? nullptr : context.images->wall_point();
  parallel_for(context.images->size(), [&, out, w, n, point](std::size_t k) {
    if (point != nullptr && point[k] >= 0) {
      const auto v = context.walls->vector(static_cast<std::size_t>(point[k]), dimensions, values);
      for (int axis = 0; axis < dimensions; ++axis)
        out[(n + k) * w + axis] = reflection[path[k]][axis] * static_cast<float>(v[axis]);
      return;
    }
    for (int axis = 0; axis < dimensions; ++axis)
      out[(n + k) * w + axis] = reflection[path[k]][axis] * values[axis][source[k]];
  });
}

}  // namespace spume
