// SPDX-License-Identifier: MIT
#include "spume/particles/start_at_rest.hpp"

#include <algorithm>

#include "spume/core/vectors.hpp"
#include "spume/particles/column_pressure.hpp"

namespace spume {

bool starts_moving(const Scene& scene) {
  const auto& velocity = scene.particles.velocity;
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    if (std::any_of(velocity[axis].begin(), velocity[axis].end(), [](double u) { return u != 0; })) return true;
  return false;
}

StartAtRest::StartAtRest(const Scene& scene, const Circumstances& circumstances) {
  const bool several = scene.phases.size() > 1;
  reason = "the liquid does not start level, at rest";
  if (gravity_across_sides(scene) == Vec3{})
    reason = "no gravity across sides";
  else if (!scene.openings.empty())
    reason = "inflow or outflow";
  else if (circumstances.moving_bodies)
    reason = "bodies move";
  else if (scene.body_force)
    reason = "a body force drives the liquid";
  else if (circumstances.oxygen)
    reason = "oxygen passes the surface";
  else if (several && scene.free_surface)
    reason = "several phases below a free surface";
  else if (several && !circumstances.mean_pressures.empty())
    reason = circumstances.mean_pressures;
  else if (several)
    settles = circumstances.in_layers && !starts_moving(scene);
  else if (!scene.free_surface)
    reason = "one phase fills the tank";
  else
    settles = !(chosen = particles_at_rest(scene)).empty();
  if (settles && circumstances.unasked) {
    settles = false;
    chosen = {};
    reason = "compressibility.settling_rounds = 0";
  }
  if (settles) reason = "to where the liquid is at rest";
}

}  // namespace spume
