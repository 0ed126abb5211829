// SPDX-License-Identifier: MIT
// The end of a step: what refuses it, and the state that it leaves. Particles are taken a block at a time, in passes
// over one axis that the compiler takes several of at once; only what walls, bodies and the surface do goes one by one.
#include <algorithm>
#include <cmath>

#include "full_tanks.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/methods/les_sph/flow.hpp"
#include "spume/particles/blocks.hpp"

namespace spume::les_sph {
namespace {

// Of a spacing a step: faster than this the pressure at a surface or a void does not draw a particle into the wall of a
// body.
// At wall points a pressure that one particle has alone is lower than its own.
constexpr double least_approach = 0.05;

Vec3 vector_of(const VectorBlock& block, std::size_t k) {
  return {block[0][k], block[1][k], block[2][k]};
}

void set(VectorBlock& block, std::size_t k, const Vec3& value) {
  for (std::size_t axis = 0; axis < 3; ++axis) block[axis][k] = value[axis];
}

// sum += weight * of[first ..]
void add_weighted(const ParticleBlock& weight, const float* of, std::size_t n, ParticleBlock& sum) {
  for (std::size_t k = 0; k < n; ++k) sum[k] += weight[k] * of[k];
}

}  // namespace

void Flow::accept(double dt) {
  refuse_runaway_bodies(*this);
  refuse_long_strides(particles, intermediate_position, next_velocity, arrangement.grid.support_radius(), dt);
  const EnergyBalance balance = energy_balance(dt);
  energy.supply =
      energy.after_step(balance, particles, intermediate_position, next_velocity, boundary.next_wall_speed, dt);
  work += balance.work;
  parallel_blocks(size(), default_block,
                  [&](std::size_t, std::size_t first, std::size_t last) { accept_block(dt, first, last); });
  particles.scratch().release(next_velocity);
  particles.scratch().release(shift_velocity);
  if (closure != nullptr) closure->accept(particles.scratch());
  if (floating != nullptr) floating->accept(dt);
  boundary.accept();
  if (features.openings) boundary.follow(read(particles.velocity));
  max_divergence = next_max_divergence;
  largest_body_force = next_largest_body_force;
  time += dt;
  last_steps = {dt, last_steps[0]};
  ++steps;
  find_extremes();
  if (!features.velocity_gradient) return;
  const float* const rate = strain->data();
  const float* const eddy = closure == nullptr ? nullptr : closure->viscosity().data();
  const double nu = viscosity();
  dissipation = density() * particles.volume * parallel_sum(size(), [=](std::size_t i) {
                  const double size = rate[i];
                  return (nu + (eddy == nullptr ? 0.0 : double{eddy[i]})) * size * size;
                });
}

void Flow::accept_block(double dt, std::size_t first, std::size_t last) {
  const std::size_t n = last - first;
  VectorBlock before{}, ahead{}, r{};  // zero beyond the dimensions
  for (int axis = 0; axis < dimensions; ++axis) {
    advecting_velocities(axis, dt, first, last, before[axis].data());
    std::copy_n(next_velocity[axis].data() + first, n, ahead[axis].data());
    std::copy_n(intermediate_position[axis]->data() + first, n, r[axis].data());
    if (bubbles == nullptr) continue;
    double* const rate = material_acceleration[axis]->data() + first;
    for (std::size_t k = 0; k < n; ++k) rate[k] = (ahead[axis][k] - before[axis][k]) / dt;
  }
  if (surface != nullptr || features.moves_in_full_tank) stop_free_particles(dt, first, last, before, ahead);
  if (boundary.bodies() != nullptr) limit_approach(dt, first, last, r, before, ahead);
  for (std::size_t k = 0; k < n && rest.share != nullptr; ++k)
    forget_rest(first + k, dt * length(vector_of(before, k)));
  VectorBlock& u = before;
  for (int axis = 0; axis < dimensions; ++axis) {
    if (acceleration[0] == nullptr)
      u[axis] = ahead[axis];
    else
      for (std::size_t k = 0; k < n; ++k) u[axis][k] = 0.5 * (u[axis][k] + ahead[axis][k]);
  }
  if (features.shifting) {
    ParticleBlock weight;
    for (std::size_t k = 0; k < n && features.shift_correction; ++k) weight[k] = inside(first + k);
    for (int axis = 0; axis < dimensions; ++axis) {
      const float* const by_shift = shift->displacement[axis]->data() + first;
      for (std::size_t k = 0; k < n; ++k) r[axis][k] += by_shift[k];
      if (!features.shift_correction) continue;
      // A one-sided gradient, at the surface or beside a void of a closed liquid, extrapolates: fed back through the
      // shift it accelerates particles without any force (0.5 sqrt(g lambda) in a tenth of a period at 1/50). The
      // change fades out with the interior weight.
      add_weighted(weight, shift_velocity[axis].data() + first, n, u[axis]);
      add_weighted(weight, shift_velocity[axis].data() + first, n, ahead[axis]);
    }
  }
  hold_at_end(n, r, ahead, u);
  for (int axis = 0; axis < dimensions; ++axis) {
    std::copy_n(r[axis].data(), n, particles.position[axis]->data() + first);
    std::copy_n(u[axis].data(), n, particles.velocity[axis]->data() + first);
    if (acceleration[0] == nullptr) continue;
    float* const a = acceleration[axis]->data() + first;
    const double rate = 2 / dt;
    for (std::size_t k = 0; k < n; ++k) a[k] = static_cast<float>(rate * (ahead[axis][k] - u[axis][k]));
  }
  double* const p = pressure->data();
  const double* const q = reduced_pressure->data();
  const double* const of_forces = potential == nullptr ? nullptr : potential->data();
  const double rho = density();
  for (std::size_t i = first; i < last; ++i) p[i] = rho * (q[i] - (of_forces == nullptr ? 0.0 : of_forces[i]));
}

// No pressure has stopped what has met a wall on its way here.
void Flow::stop_free_particles(double dt, std::size_t first, std::size_t last, VectorBlock& before,
                               VectorBlock& ahead) const {
  for (std::size_t i = first; i < last; ++i) {
    if (surface != nullptr && surface->pressure_fixed[i] == 0) continue;
    const Vec3 from = vector_at(particles.position, dimensions, i), u = vector_of(before, i - first);
    Vec3 straight{}, stopped = u, next = vector_of(ahead, i - first);
    for (int axis = 0; axis < dimensions; ++axis) straight[axis] = from[axis] + dt * u[axis];
    boundary.hold_liquid(boundary.next_walls, straight, &stopped, &from);
    for (std::size_t axis = 0; axis < 3; ++axis) next[axis] += stopped[axis] - u[axis];
    set(before, i - first, stopped);
    set(ahead, i - first, next);
  }
}

void Flow::limit_approach(double dt, std::size_t first, std::size_t last, const VectorBlock& r,
                          const VectorBlock& before, VectorBlock& ahead) const {
  for (std::size_t i = first; i < last; ++i) {
    const bool sparse = surface != nullptr ? surface->at_surface[i] != 0 : inside(i) < 1;
    if (!sparse) continue;
    Vec3 next = vector_of(ahead, i - first);
    boundary.bodies()->limit_approach(vector_of(r, i - first), resolution.spacing,
                                      least_approach * resolution.spacing / dt, vector_of(before, i - first), next);
    set(ahead, i - first, next);
  }
}

void Flow::hold_at_end(std::size_t n, VectorBlock& r, VectorBlock& ahead, VectorBlock& u) const {
  if (boundary.clear_of_sides(boundary.next_walls, {r[0].data(), r[1].data(), r[2].data()}, 0, n)) {
    boundary.go_round(boundary.next_walls, {r[0].data(), r[1].data(), r[2].data()}, 0, n);
    return;
  }
  for (std::size_t k = 0; k < n; ++k) {
    Vec3 place = vector_of(r, k), held = place, next = vector_of(ahead, k), velocity = vector_of(u, k);
    boundary.hold_liquid(boundary.next_walls, place, &next);
    boundary.hold_liquid(boundary.next_walls, held, &velocity);
    set(r, k, held);
    set(ahead, k, next);
    set(u, k, velocity);
  }
}

}  // namespace spume::les_sph
