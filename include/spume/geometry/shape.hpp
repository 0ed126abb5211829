// SPDX-License-Identifier: MIT
// Shapes: signed distance, nearest point, normal, and a triangulated surface for files and pictures.
//
// Points always have three entries; a shape of two dimensions lies in the plane z = 0, is asked there only, and up is
// y. Shapes do not change once they are made, and any number of threads may ask them at once.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "spume/core/vec3.hpp"

namespace spume {

// The place of a surface that is nearest to a point.
struct NearestPoint {
  double distance = 0;  // negative inside the solid
  Vec3 normal{};        // of length 1, out of the solid: the gradient of the distance, at an edge towards the point
  Vec3 point{};         // on the surface
};

inline constexpr double infinite = std::numeric_limits<double>::infinity();

// An axis-parallel box; infinite where a shape has no end.
struct Bounds {
  Vec3 lower{}, upper{};
};

// Triangles are counter-clockwise seen from outside the solid. A shape of two dimensions is given by triangles that
// fill it, counter-clockwise in the plane.
struct TriangleSurface {
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

class Shape {
 public:
  virtual ~Shape() = default;
  virtual NearestPoint nearest(const Vec3& point) const = 0;
  // The distance of nearest(), where it costs less.
  virtual double distance(const Vec3& point) const { return nearest(point).distance; }
  bool inside(const Vec3& point) const { return distance(point) < 0; }

  virtual Bounds bounds() const = 0;
  // The same with the copies of a shape that is repeated.
  virtual Bounds extent() const { return bounds(); }
  // Area in two dimensions; infinite for a shape without end.
  virtual double volume() const = 0;
  // Upper bound of the error of distances to a smooth surface, estimated where no closed form gives them; 0 for those.
  virtual double error() const { return 0; }
  // Curved faces in facets of about the length `step`; faces without end as far as `window`, which is finite.
  virtual TriangleSurface surface(const Bounds& window, double step) const = 0;
};

using ShapePointer = std::shared_ptr<const Shape>;

}  // namespace spume
