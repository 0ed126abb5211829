// SPDX-License-Identifier: MIT
// Small spheres suspended in a periodic flow: what is carried between steps. An array exists only when the coupling
// or the diameters ask for it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/field_set.hpp"

namespace spume {

struct ParticleArrays {
  bool force = false;         // two-way: the force of the last step is kept to extrapolate from
  bool polydisperse = false;  // every particle has its own diameter
  int disturbances = 0;       // velocities that make up what a particle sees of its own force
};

struct Particles {
  Particles() = default;
  explicit Particles(const ParticleArrays& wanted) {
    constexpr const char* axis_name[3] = {"x", "y", "z"};
    const auto add = [&](const char* name, std::array<Array<double>*, 3>& vector) {
      for (int axis = 0; axis < 3; ++axis)
        vector[axis] = &fields.add<double>(std::string(name) + "_" + axis_name[axis], Lifetime::state);
    };
    add("position", position);
    add("velocity", velocity);
    if (wanted.force) add("force", force);
    disturbance.resize(static_cast<std::size_t>(wanted.disturbances));
    for (std::size_t b = 0; b < disturbance.size(); ++b)
      add(("disturbance_" + std::to_string(b)).c_str(), disturbance[b]);
    if (wanted.polydisperse) diameter = &fields.add<double>("diameter", Lifetime::state);
    identifier = &fields.add<std::int64_t>("identifier", Lifetime::state);
  }

  FieldSet fields;
  std::array<Array<double>*, 3> position{}, velocity{};
  std::array<Array<double>*, 3> force{};  // on the fluid, per density of the fluid: mean over the last step
  std::vector<std::array<Array<double>*, 3>> disturbance;  // see SelfDisturbance
  Array<double>* diameter = nullptr;
  Array<std::int64_t>* identifier = nullptr;
  double common_diameter = 0;  // of every particle without arrays of their own; else the reference diameter

  std::size_t size() const { return fields.size(); }
  double diameter_of(std::size_t i) const { return diameter == nullptr ? common_diameter : (*diameter)[i]; }
  std::array<const double*, 3> positions() const {
    return {position[0]->data(), position[1]->data(), position[2]->data()};
  }
  std::array<const double*, 3> velocities() const {
    return {velocity[0]->data(), velocity[1]->data(), velocity[2]->data()};
  }
};

inline double sphere_volume(double diameter) {
  return M_PI / 6 * diameter * diameter * diameter;
}

}  // namespace spume
