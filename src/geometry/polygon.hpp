// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "surfaces.hpp"

namespace spume {

struct NearestPoint2 {
  double distance = 0;
  Point2 normal{}, point{};
};

// A polygon of three points or more whose sides do not cross, counter-clockwise.
class Polygon {
 public:
  explicit Polygon(std::vector<Point2> points);
  const std::vector<Point2>& points() const { return points_; }
  NearestPoint2 nearest(const Point2& point) const;
  double area() const;

 private:
  Point2 normal_of(std::size_t side) const;
  std::vector<Point2> points_;
  double size_ = 0;
};

double area_of(const std::vector<Point2>& points);  // positive when they go counter-clockwise

}  // namespace spume
