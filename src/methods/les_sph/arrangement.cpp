// SPDX-License-Identifier: MIT
// Where the particles of a step stand and what they see: order, images, neighbours, moments, surface; and the bubbles
// between them.
#include "spume/methods/les_sph/flow.hpp"
#include "spume/particles/number_density.hpp"
#include "spume/particles/packing.hpp"

namespace spume::les_sph {

// Between steps cells and images are those of where the particles were; the gauge makes its own.
void Flow::measure_waves() {
  boundary.return_walls();  // a step that was refused has moved them
  gauge->update({.arrangement = &arrangement,
                 .boundary = &boundary,
                 .particles = &particles,
                 .resolution = &resolution,
                 .volume_fraction = volume_fraction(),
                 .time = time});
  boundary.absorbing()->measure(boundary.walls[0], time, [this](const Vec3& at) { return gauge->elevation(at); });
}

void Flow::sort_particles() {
  arrangement.sort(particles, intermediate_position);
}

void Flow::pack() {
  if (features.bodies)
    pack_beside_bodies(arrangement, particles, boundary, resolution, intermediate_position, features.free_surface,
                       time);
  else
    pack_beside_solids(arrangement, particles, boundary, resolution, intermediate_position, features.free_surface,
                       time);
}

void Flow::make_images(double dt) {
  // u^{n+1/2} becomes u^{n+3/2}; without centring u^n becomes u^{n+1}.
  const double behind = options.get<SchemeOptions>().centred ? dt / 2 : 0;
  wall_times = {.place = time + dt, .velocity = time + behind, .ahead = time + dt + behind};
  // The start takes the acceleration right after it, over a time that is short beside any motion that a run resolves.
  if (const double soon = 1e-6 * options.time.end; dt == 0)
    wall_times = {.place = time, .velocity = time + soon, .ahead = time + 2 * soon};
  boundary.make_images(arrangement, particles, intermediate_position, sizes.largest_length_ratio, wall_times);
}

void Flow::find_neighbours(double dt) {
  arrangement.find_neighbours(particles, intermediate_position, sizes);
  if (dt > 0 && (features.shifting || features.density_relaxation))
    displacement = displacement_fraction(arrangement, particles, resolution, dt);
}

void Flow::measure_moments() {
  moments.measure(arrangement, particles, resolution.spacing);
}

void Flow::find_surface() {
  surface->find(arrangement, particles, moments, boundary, intermediate_position);
}

// Ripples of a few spacings grow in steps of the size that still liquid takes: what the projection leaves of their
// divergence is pressed back a step later, when the surface has moved on. Their pressure is that of where they will be.
void Flow::find_ripples(double dt) {
  surface->find_rise(arrangement, moments, particles.velocity, boundary.reflection(), dt);
}

// The volume fraction depends on h, which depends on the volume fraction. A round leaves at most (1 - alpha) / alpha of
// the error of alpha: after six 2e-6 at 0.9 and 2e-4 at 0.8. Particles of the start that hold more gas settle within
// the first steps, each of which is such a round.
void Flow::place_clouds() {
  constexpr int rounds = 6;
  bubbles->place_clouds();
  for (int round = 0; round < rounds && !bubbles->population().empty(); ++round) {
    move_bubbles(0);
    make_images(0);
    share_volume();
    bubbles->accept_volume_fraction();
  }
}

void Flow::move_bubbles(double dt) {
  bubbles->move(dt, sizes);
  arrangement.set_sizes(nullptr);  // until they are known
}

void Flow::share_volume() {
  bubbles->share_volume(sizes);
  arrangement.set_sizes(sizes.variable ? &sizes : nullptr);
}

void Flow::exchange_with_bubbles(double dt) {
  bubbles->exchange_momentum(dt, arrangement.packed);
}

void Flow::accept_bubbles(double dt) {
  bubbles->accept(dt);
}

}  // namespace spume::les_sph
