// SPDX-License-Identifier: MIT
#include "polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spume {

double area_of(const std::vector<Point2>& points) {
  double twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point2 &p = points[i], &q = points[(i + 1) % points.size()];
    // From the first point, which keeps the digits of a small polygon far from the origin.
    const Point2& o = points[0];
    twice += (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
  }
  return 0.5 * twice;
}

Polygon::Polygon(std::vector<Point2> points) : points_(std::move(points)) {
  for (const Point2& p : points_) size_ = std::max({size_, std::abs(p[0]), std::abs(p[1])});
}

double Polygon::area() const {
  return area_of(points_);
}

Point2 Polygon::normal_of(std::size_t side) const {
  const Point2 &p = points_[side], &q = points_[(side + 1) % points_.size()];
  const double size = std::hypot(q[0] - p[0], q[1] - p[1]);
  return {(q[1] - p[1]) / size, (p[0] - q[0]) / size};
}

// A ray from the point to the right crosses the sides an odd number of times when the point lies inside.
NearestPoint2 Polygon::nearest(const Point2& point) const {
  double best = std::numeric_limits<double>::infinity(), best_along = 0;
  std::size_t side = 0;
  bool inside = false;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point2 &p = points_[i], &q = points_[(i + 1) % points_.size()];
    const double ex = q[0] - p[0], ey = q[1] - p[1], rx = point[0] - p[0], ry = point[1] - p[1];
    const double along = std::clamp((rx * ex + ry * ey) / (ex * ex + ey * ey), 0.0, 1.0);
    const double dx = rx - along * ex, dy = ry - along * ey, squared = dx * dx + dy * dy;
    if (squared < best) {
      best = squared;
      best_along = along;
      side = i;
    }
    if ((p[1] > point[1]) != (q[1] > point[1]) && (rx * ey - ry * ex) * (ey > 0 ? 1 : -1) < 0) inside = !inside;
  }
  const Point2 &p = points_[side], &q = points_[(side + 1) % points_.size()];
  NearestPoint2 found;
  found.point = {p[0] + best_along * (q[0] - p[0]), p[1] + best_along * (q[1] - p[1])};
  if (best_along == 1) found.point = q;
  const double distance = std::sqrt(best), sign = inside ? -1 : 1;
  found.distance = sign * distance;
  // Next to a side the direction to the point is rounding.
  constexpr double next_to = 1e-9;
  if (distance > next_to * size_) {
    found.normal = {(point[0] - found.point[0]) / found.distance, (point[1] - found.point[1]) / found.distance};
    return found;
  }
  found.normal = normal_of(side);
  const std::size_t n = points_.size();
  if (best_along == 0 || best_along == 1) {
    const Point2 other = normal_of(best_along == 0 ? (side + n - 1) % n : (side + 1) % n);
    const Point2 sum = {found.normal[0] + other[0], found.normal[1] + other[1]};
    if (const double size = std::hypot(sum[0], sum[1]); size > 0) found.normal = {sum[0] / size, sum[1] / size};
  }
  return found;
}

}  // namespace spume
