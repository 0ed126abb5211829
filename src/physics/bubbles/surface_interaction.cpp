// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/surface_interaction.hpp"

#include <algorithm>
#include <cmath>

#include "spume/physics/bubbles/population.hpp"

namespace spume::bubbles {
namespace {
constexpr double near = 0.1;  // proximity from which a bubble interacts, below King (3.30)
}

double persistence_unit(double tension, double viscosity, double gravity, double schmidt) {
  if (!(tension > 0) || !(gravity > 0)) return 0;
  return schmidt * viscosity * std::pow(tension, -0.75) * std::pow(gravity, -0.25);
}

SurfaceContact approach_surface(const SurfaceModel& model, double proximity, const Vec3& normal,
                                const Vec3& relative_velocity, double radius, double age, double merge_time, double t,
                                double dt) {
  SurfaceContact contact;
  contact.merge_time = not_merging;
  if (!(proximity > near)) return contact;
  if (merge_time == not_merging) {
    double speed = 0;
    for (std::size_t a = 0; a < 3; ++a) speed += relative_velocity[a] * normal[a];
    speed = std::abs(speed);
    // T_c = dr / speed, written without division: a bubble at rest in the liquid is never old enough.
    if (!(age * speed > model.spacing)) return contact;
    merge_time = t + model.spacing / speed;
  }
  contact.merge_time = merge_time;
  contact.bursts = t >= merge_time + model.persistence_unit * std::sqrt(radius);
  contact.braking.share = 0.5 * (1 + std::erf(2 * std::log(5 * proximity)));
  contact.braking.normal = normal;
  contact.braking.time_left = std::max(merge_time - t, dt);
  return contact;
}

}  // namespace spume::bubbles
