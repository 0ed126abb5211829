// SPDX-License-Identifier: MIT
// What probes ask of the present state of a method. A method has the parts that its equations give a meaning to.
#pragma once

#include "spume/core/vec3.hpp"
#include "spume/io/samples.hpp"

namespace spume {

// Probes of kind "point", "line" and "plane".
class FieldProbes {
 public:
  virtual PointSample sample(const Vec3& position) = 0;
  // Over the plane where the coordinate along `axis` is `position`.
  virtual PlaneSample plane_average(int axis, double position) = 0;
  // Where bodies of a motion of the scene have taken a place that moves with them; of methods with moving bodies.
  virtual Vec3 carried(std::size_t /*motion*/, const Vec3& start) const { return start; }

 protected:
  ~FieldProbes() = default;
};

// Probes of kind "elevation", "wetted" and "front", of methods with a free surface.
class SurfaceProbes {
 public:
  // Height of the free surface above the bottom wall along the last axis through `position`: the highest point where
  // the kernel sum reaches 1/2; the bottom when the column is empty.
  virtual double elevation(const Vec3& position) = 0;
  // Length of that column that lies in liquid, in all its pieces.
  virtual double wetted_length(const Vec3& position) = 0;
  // Largest coordinate along `axis` where liquid of kernel sum 1/2 is found below `height` (the last axis).
  virtual double front(int axis, double height) = 0;

 protected:
  ~SurfaceProbes() = default;
};

}  // namespace spume
