// SPDX-License-Identifier: MIT
#include "spume/particles/layer_stencils.hpp"

#include <algorithm>

namespace spume {

void LayerStencils::find(const Arrangement& arrangement, const ParticleStore& particles,
                         std::span<const std::uint8_t> phase) {
  const int d = particles.dimensions;
  const std::vector<OpenGate>& gates = layers_.gates().list;
  members_ = &layers_.find_members();
  points_.resize(members_->size());
  masked_.resize(particles.size());
  point_of_.resize(particles.size());
  masked_.fill(0);
  point_of_.fill(-1);
  parallel_for(points_.size(), [&](std::size_t k) {
    const std::int32_t member = (*members_)[k];
    const auto i = static_cast<std::size_t>(member);
    const BufferLayers::Column& column = layers_.column_of(i);
    const OpenGate& gate = gates[static_cast<std::size_t>(column.gate)];
    const bool inflow = gate.opening->inflow;
    OpeningPoint& point = points_[k];
    point = opening_point(gate, column.gate, gate.wrapped(vector_at(particles.position, d, i)),
                          vector_at(particles.velocity, d, i), inflow ? -1 : member);
    if (inflow) point.acceleration[gate.opening->axis] = column.acceleration;
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
                         .phase = scene_.phases.size() > 1 ? phase.data() : nullptr},
                        points_, stencils_);
  tied_ = {{members_->data(), members_->size()}, {point_of_.data(), point_of_.size()}, &stencils_};
}

void LayerStencils::predict(const std::array<const double*, 3>& before, const std::array<double*, 3>& after, double dt,
                            std::span<const float> density) {
  const int d = scene_.domain.dimensions;
  give_opening_gradients(layers_.gates().list, points_, 0, before, {after[0], after[1], after[2]}, dt, d, stencils_);
  parallel_for(points_.size(), [&](std::size_t g) {
    const auto i = static_cast<std::size_t>((*members_)[g]);
    const auto u = stencils_.velocity(g, d, {after[0], after[1], after[2]}, false, true, true);
    for (int axis = 0; axis < d; ++axis) after[axis][i] = u[axis];
    stencils_.given_pressure[g] *= density[i];
  });
}

void LayerStencils::follow(const std::array<double*, 3>& velocity) const {
  const int d = scene_.domain.dimensions;
  parallel_for(points_.size(), [&](std::size_t g) {
    const auto i = static_cast<std::size_t>((*members_)[g]);
    const auto u = stencils_.velocity(g, d, {velocity[0], velocity[1], velocity[2]}, false, true, false);
    for (int axis = 0; axis < d; ++axis) velocity[axis][i] = u[axis];
  });
}

// Expressions are not for several threads at a time.
void LayerStencils::give_pressures(double t,
                                   const std::function<double(const Vec3& place, std::size_t i)>& reduced) {
  double heaviest = 0;
  for (const Phase& phase : scene_.phases) heaviest = std::max(heaviest, phase.density);
  for (std::size_t g = 0; g < points_.size(); ++g) {
    const OpeningPoint& point = points_[g];
    const Opening& opening = *layers_.gates().list[static_cast<std::size_t>(point.gate)].opening;
    if (opening.inflow) continue;
    const bool wet = stencils_.pressure_sign[g] != 0;
    const double q = pressure_outside(scene_, opening, point.foot, heaviest, t) +
                     reduced(wet ? point.foot : point.place, static_cast<std::size_t>((*members_)[g]));
    stencils_.given_pressure[g] = wet ? 2 * q : q;
  }
}

double LayerStencils::bytes() const {
  return static_cast<double>(points_.capacity() * sizeof(OpeningPoint)) + stencils_.bytes() + point_of_.bytes() +
         masked_.bytes();
}

}  // namespace spume
