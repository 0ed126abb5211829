// SPDX-License-Identifier: MIT
// Shapes of closed form, centred on the origin of their own coordinates; `dimensions` is 2 or 3, lengths are positive.
// Their distances are exact: to rounding for all but the ellipsoid, whose nearest point is the root of an equation,
// iterated until it does not change (D. Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid,
// Geometric Tools 2013).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "spume/geometry/shape.hpp"

namespace spume {

ShapePointer make_ball(double radius, int dimensions);

// `size` holds the lengths of the edges.
ShapePointer make_box(const Vec3& size, int dimensions);

// Along z, from -length/2 to length/2 or without end; a disc in two dimensions, where the length is not looked at.
ShapePointer make_cylinder(double radius, std::optional<double> length, int dimensions);

// About the last axis, from the base at -length/2 to the top at length/2, where it has the radius `top_radius` (0: a
// tip); in two dimensions a triangle or trapezium.
ShapePointer make_cone(double radius, double top_radius, double length, int dimensions);

// All within `radius` of the piece of the last axis from -length/2 to length/2.
ShapePointer make_capsule(double radius, double length, int dimensions);

ShapePointer make_ellipsoid(const Vec3& semi_axes, int dimensions);

// Below the plane through the origin that `normal`, of any length but 0, points away from.
ShapePointer make_half_space(const Vec3& normal, int dimensions);

// Throws InputError when the points, in either direction around, bound no area: fewer than three, two of them the same,
// or sides that touch or cross. In two dimensions x and y; in three x and z, extruded along y from -length/2 to
// length/2 or without end.
ShapePointer make_outline(const std::vector<std::array<double, 2>>& points, std::optional<double> length,
                          int dimensions);

// Where a shape stands: a point x of its own coordinates is at position + scale * rotation x.
struct Pose {
  Vec3 position{};
  std::array<Vec3, 3> rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // rows of an orthogonal matrix
  double scale = 1;
};

// The rotation by angles in degrees about the fixed axes x, y and z, in this order.
std::array<Vec3, 3> rotation_by(const Vec3& degrees);

// The point of the shape's own coordinates that is placed at `point`.
Vec3 to_own_coordinates(const Pose& pose, const Vec3& point);

// With `inside` false the solid is what lies outside the shape.
ShapePointer place(ShapePointer shape, const Pose& pose, bool inside, int dimensions);

// The shape and its copies one period away along axes whose periods are not 0, those that reach into `window`: the
// domain and how far liquid sees beyond its sides. Bounds, volume and surface are those of the shape itself. Returns
// the shape where no copy does.
ShapePointer repeat(ShapePointer shape, const Bounds& window, const Vec3& periods);

// What a shape is in one period from `lower` on, along axes whose periods are not 0, without end: of any other point
// what the same place of that period says. Distances are those of the shape, which has seen its copies itself.
ShapePointer continue_periodically(ShapePointer shape, const Vec3& lower, const Vec3& periods);

// The union of shapes, each of which is added to what those before it make, or taken away from it. Outside a union and
// inside a difference the distance is exact; else its size is a lower bound of the distance.
struct CombinedPart {
  ShapePointer shape;
  bool subtract = false;
};
class Combination {
 public:
  Combination() = default;
  explicit Combination(std::vector<CombinedPart> parts);
  bool empty() const { return parts_.empty(); }
  // Of no solid at all: infinitely far.
  NearestPoint nearest(const Vec3& point) const;
  double distance(const Vec3& point) const;
  bool inside(const Vec3& point) const { return distance(point) < 0; }

 private:
  void make_cells();
  // Those that can be the nearest ones of a point, in their order.
  std::span<const std::int32_t> candidates(const Vec3& point) const;
  // Whether a part can make the distance of a point another than `distance`, that of the parts before it.
  bool may_change(std::size_t part, const Vec3& point, double distance) const;
  double distance_of(std::span<const std::int32_t> parts, const Vec3& point) const;

  std::vector<CombinedPart> parts_;
  std::vector<Bounds> extents_;
  std::vector<std::int32_t> all_;
  // Cells around many parts of exact distance, none of which is subtracted: what may be nearest in each.
  Vec3 lower_{}, width_{};
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::vector<std::int32_t> begin_, candidates_;  // begin_ is empty without cells
};

}  // namespace spume
