// SPDX-License-Identifier: MIT
// Slow twins of the neighbour floor: written from the definitions, without grids, tables or blocks.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "spume/neighbours/images.hpp"

namespace spume::reference {

using Point = std::array<double, 3>;

struct Image {
  Point position{};
  std::int32_t source = 0;
  std::array<int, 4> path{-1, -1, -1, -1};  // box face, then the side of each axis
};

struct Candidates {
  std::set<std::int32_t> certain;   // nearer than support_radius - tolerance
  std::set<std::int32_t> possible;  // nearer than support_radius + tolerance
};

// Faces in the order lower x, upper x, lower y, ...: the earlier of two equally near faces owns an image.
inline std::vector<Image> box_images(const ImageRules& rules, const std::vector<Point>& points) {
  std::vector<Image> made;
  for (std::size_t b = 0; b < rules.boxes.size(); ++b) {
    const auto& box = rules.boxes[b];
    for (std::size_t k = 0; k < points.size(); ++k)
      for (int face = 0; face < 2 * rules.dimensions; ++face) {
        const int axis = face / 2;
        const bool upper = face % 2 == 1;
        if (!box.face[axis][upper]) continue;
        Image image{points[k], static_cast<std::int32_t>(k), {static_cast<int>(6 * b) + face, -1, -1, -1}};
        const double plane = upper ? box.upper[axis] : box.lower[axis];
        const double height = upper ? points[k][axis] - plane : plane - points[k][axis];
        if (height < 0 || height >= rules.support_radius) continue;
        image.position[axis] = 2 * plane - points[k][axis];
        int nearest = -1;
        double least = std::numeric_limits<double>::infinity();
        bool inside = true;
        for (int other = 0; other < 2 * rules.dimensions; ++other) {
          if (!box.face[other / 2][other % 2]) continue;
          const double x = image.position[other / 2];
          const double depth = other % 2 == 1 ? box.upper[other / 2] - x : x - box.lower[other / 2];
          inside = inside && depth >= 0;
          // Equal up to rounding counts as equal.
          if (depth < least - 1e-6 * rules.support_radius) {
            least = depth;
            nearest = other;
          }
        }
        if (inside && nearest == face) made.push_back(image);
      }
  }
  return made;
}

// All images of the points under the rules: every particle and box image under every combination of one
// operation per axis.
inline std::vector<Image> images(const ImageRules& rules, const std::vector<Point>& points) {
  std::vector<Image> bases;
  for (std::size_t k = 0; k < points.size(); ++k) bases.push_back({points[k], static_cast<std::int32_t>(k), {}});
  for (auto& base : bases) base.path = {-1, -1, -1, -1};
  const std::vector<Image> inside = box_images(rules, points);
  bases.insert(bases.end(), inside.begin(), inside.end());

  std::vector<Image> made;
  for (std::size_t k = 0; k < bases.size(); ++k) {
    // The coordinate under each operation of an axis: 0 none, 1 lower side, 2 upper side; absent ones are NaN.
    std::array<std::array<double, 3>, 3> coordinate{};
    for (int axis = 0; axis < 3; ++axis) {
      const double x = bases[k].position[axis];
      const double length = rules.upper[axis] - rules.lower[axis];
      coordinate[axis] = {x, NAN, NAN};
      if (axis >= rules.dimensions) continue;
      for (int side = 0; side < 2; ++side) {
        const double plane = side == 0 ? rules.lower[axis] : rules.upper[axis];
        const double depth = side == 0 ? x - plane : plane - x;
        if (rules.sides[axis][side] == ImageKind::mirror && depth < rules.support_radius)
          coordinate[axis][side + 1] = 2 * plane - x;
        if (rules.sides[axis][side] == ImageKind::periodic && length - depth < rules.support_radius)
          coordinate[axis][side + 1] = side == 0 ? x - length : x + length;
      }
    }
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        for (int c = 0; c < 3; ++c) {
          const Point position{coordinate[0][a], coordinate[1][b], coordinate[2][c]};
          if (std::isnan(position[0] + position[1] + position[2])) continue;
          if (a + b + c == 0 && k < points.size()) continue;
          made.push_back({position, bases[k].source, {bases[k].path[0], a - 1, b - 1, c - 1}});
        }
  }
  return made;
}

// Neighbours of point i among all points, itself excluded.
inline Candidates neighbours(const std::vector<Point>& all, std::size_t i, int dimensions, double support_radius,
                             double tolerance) {
  Candidates result;
  for (std::size_t j = 0; j < all.size(); ++j) {
    if (j == i) continue;
    double square = 0;
    for (int axis = 0; axis < dimensions; ++axis) square += std::pow(all[j][axis] - all[i][axis], 2);
    const double distance = std::sqrt(square);
    if (distance < support_radius - tolerance) result.certain.insert(static_cast<std::int32_t>(j));
    if (distance < support_radius + tolerance) result.possible.insert(static_cast<std::int32_t>(j));
  }
  return result;
}

}  // namespace spume::reference
