// SPDX-License-Identifier: MIT
// Triangulated surfaces of shapes of closed form.
#pragma once

#include <vector>

#include "spume/geometry/shape.hpp"

namespace spume {

using Point2 = std::array<double, 2>;

// Twice the area of a triangle: positive when its corners go counter-clockwise.
inline double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Facets around a circle: at least 24, of about the length `step`.
int facets_around(double radius, double step);

// Points of an arc of a circle around (0, height), from the angle `from` to `to` against the axis, ends included.
void add_arc(std::vector<Point2>& profile, double radius, double height, double from, double to, int facets);

// The surface swept by a profile of points (distance from the axis, height) around the z axis: it runs down from the
// highest to the lowest point; a first or last point off the axis leaves the surface open there.
TriangleSurface revolve(const std::vector<Point2>& profile, int facets);

// A polygon without crossings, counter-clockwise, cut into triangles in the plane z = 0.
TriangleSurface fill_polygon(const std::vector<Point2>& points);

// The figure of two dimensions between a profile, which runs down from the highest point, and its mirror image.
TriangleSurface fill_profile(const std::vector<Point2>& profile);

// What of a flat polygon lies in a box.
std::vector<Vec3> clip(std::vector<Vec3> polygon, const Bounds& box);
// A flat convex polygon as a fan.
TriangleSurface fan(const std::vector<Vec3>& polygon);

// A polygon without crossings of x and z, counter-clockwise for x to the right and z up, swept along y.
TriangleSurface extrude(const std::vector<Point2>& points, double from, double to);

}  // namespace spume
