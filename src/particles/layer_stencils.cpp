// SPDX-License-Identifier: MIT
#include "spume/particles/layer_stencils.hpp"

#include <algorithm>
#include <cmath>

namespace spume {

void LayerStencils::find(const Arrangement& arrangement, const ParticleStore& particles,
                         std::span<const std::uint8_t> phase, const ThinWalls* thin, double dt) {
  const int d = particles.dimensions;
  const std::vector<OpenGate>& gates = layers_.gates().list;
  members_ = &layers_.find_members();
  points_.resize(members_->size());
  masked_.resize(particles.size());
  point_of_.resize(particles.size());
  masked_.fill(0);
  point_of_.fill(-1);
  parallel_for(points_.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>((*members_)[k]);
    const BufferLayers::Column& column = layers_.column_of(i);
    const OpenGate& gate = gates[static_cast<std::size_t>(column.gate)];
    OpeningPoint& point = points_[k];
    point = opening_point(gate, column.gate, gate.wrapped(vector_at(particles.position, d, i)),
                          gate.opening->inflow ? column.velocity : vector_at(particles.velocity, d, i), -1);
    if (gate.opening->inflow) {
      // What the liquid has met in the last step.
      point.acceleration[gate.opening->axis] = column.acceleration;
      point.velocity[gate.opening->axis] -= dt * column.acceleration;
    }
    point.phase = phase[i];
    masked_[i] = 1;
    point_of_[i] = static_cast<std::int32_t>(k);
  });
  stencils_.clear();
  append_opening_points({.domain = scene_.domain,
                         .resolution = resolution_,
                         .gates = gates,
                         .particle_volume = particles.volume,
                         .arrangement = arrangement,
                         .at = particles.position,
                         .layer = &layers_.column(),
                         .phase = scene_.phases.size() > 1 ? phase.data() : nullptr,
                         .thin = thin},
                        points_, stencils_);
  parallel_for(points_.size(), [&](std::size_t g) {
    if (stencils_.kind[g] == PointKind::outflow) stencils_.pressure_sign[g] = static_cast<float>(-behind(points_[g]));
  });
  tied_ = {{members_->data(), members_->size()}, {point_of_.data(), point_of_.size()}, &stencils_};
}

double LayerStencils::behind(const OpeningPoint& point) const {
  return share_behind(layers_.gates().list[static_cast<std::size_t>(point.gate)], point);
}

// What comes back has been at rest outside: it has no velocity along the side. Were it that of the liquid before it,
// the flow along the side would feed itself.
Vec3 LayerStencils::velocity_at(std::size_t g, const std::array<const double*, 3>& velocity, bool before) const {
  const int d = scene_.domain.dimensions;
  Vec3 u = stencils_.velocity(g, d, velocity, false, true, before);
  if (stencils_.kind[g] != PointKind::outflow) return u;
  const int normal = layers_.gates().list[static_cast<std::size_t>(points_[g].gate)].opening->axis;
  if (u[normal] * stencils_.normal[normal][g] <= 0) return u;
  for (int axis = 0; axis < d; ++axis)
    if (axis != normal) u[axis] = 0;
  return u;
}

void LayerStencils::predict(const std::array<const double*, 3>& before, const std::array<double*, 3>& after, double dt,
                            std::span<const float> density) {
  const int d = scene_.domain.dimensions;
  give_opening_gradients(layers_.gates().list, points_, 0, before, {after[0], after[1], after[2]}, dt, d, stencils_);
  parallel_for(points_.size(), [&](std::size_t g) {
    const auto i = static_cast<std::size_t>((*members_)[g]);
    Vec3 u = velocity_at(g, {after[0], after[1], after[2]}, true);
    for (int axis = 0; axis < d; ++axis) u[axis] += dt * points_[g].acceleration[axis];  // to this step
    for (int axis = 0; axis < d; ++axis) after[axis][i] = u[axis];
    stencils_.given_pressure[g] *= density[i];
  });
}

void LayerStencils::follow(const std::array<double*, 3>& velocity) const {
  const int d = scene_.domain.dimensions;
  parallel_for(points_.size(), [&](std::size_t g) {
    const auto i = static_cast<std::size_t>((*members_)[g]);
    const Vec3 u = layers_.leads(i) ? layers_.column_of(i).velocity
                                    : velocity_at(g, {velocity[0], velocity[1], velocity[2]}, false);
    for (int axis = 0; axis < d; ++axis) velocity[axis][i] = u[axis];
  });
}

// Expressions are not for several threads at a time.
void LayerStencils::give_pressures(double t, const std::array<const double*, 3>& velocity,
                                   const std::function<double(const Vec3& place, std::size_t i)>& reduced) {
  const auto [lightest, heaviest] = std::minmax_element(
      scene_.phases.begin(), scene_.phases.end(), [](const Phase& a, const Phase& b) { return a.density < b.density; });
  const OutsideDensity outside{heaviest->density, lightest->density};
  for (std::size_t g = 0; g < points_.size(); ++g) {
    const OpeningPoint& point = points_[g];
    const Opening& opening = *layers_.gates().list[static_cast<std::size_t>(point.gate)].opening;
    if (opening.inflow) continue;
    const bool wet = stencils_.pressure_sign[g] != 0;
    const auto axis = static_cast<std::size_t>(opening.axis);
    const double inwards = stencils_.normal[axis][g] * (wet ? stencils_.mirrored(g, velocity[axis]) : 0.0);
    const double head = inwards > 0 ? 0.5 * scene_.phases[point.phase].density * inwards * inwards : 0;
    const double q = pressure_outside(scene_, opening, point.foot, outside, t) - head +
                     reduced(wet ? point.foot : point.place, static_cast<std::size_t>((*members_)[g]));
    stencils_.given_pressure[g] = wet ? (1 + behind(point)) * q : q;
  }
}

double LayerStencils::bytes() const {
  return static_cast<double>(points_.capacity() * sizeof(OpeningPoint)) + stencils_.bytes() + point_of_.bytes() +
         masked_.bytes();
}

}  // namespace spume
