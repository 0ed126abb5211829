// SPDX-License-Identifier: MIT
// Force of the liquid on a body by pressure and by viscosity, with its torques about the origin.
#pragma once

#include "spume/core/vectors.hpp"

namespace spume {

struct SurfaceForce {
  Vec3 pressure{}, viscous{}, pressure_torque{}, viscous_torque{};

  void press(const Vec3& place, const Vec3& force) {
    pressure = spume::add(pressure, force);
    pressure_torque = spume::add(pressure_torque, cross(place, force));
  }
  void rub(const Vec3& place, const Vec3& force) {
    viscous = spume::add(viscous, force);
    viscous_torque = spume::add(viscous_torque, cross(place, force));
  }
  void add(const SurfaceForce& other) {
    pressure = spume::add(pressure, other.pressure);
    viscous = spume::add(viscous, other.viscous);
    pressure_torque = spume::add(pressure_torque, other.pressure_torque);
    viscous_torque = spume::add(viscous_torque, other.viscous_torque);
  }
};

}  // namespace spume
