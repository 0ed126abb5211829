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
  ImagePath path;
};

struct Candidates {
  std::set<std::int32_t> certain;   // nearer than support_radius - tolerance
  std::set<std::int32_t> possible;  // nearer than support_radius + tolerance
};

// The boxes and their copies beyond periodic sides; copy k is of box k % boxes.size().
inline std::vector<SolidBox> with_periodic_copies(const ImageRules& rules, const std::vector<SolidBox>& boxes) {
  std::vector<SolidBox> all = boxes;
  for (int axis = 0; axis < rules.dimensions; ++axis) {
    if (rules.sides[axis][0] != ImageKind::periodic) continue;
    const std::vector<SolidBox> before = all;
    for (const int shift : {-1, 1})
      for (SolidBox box : before) {
        box.lower[axis] += shift * (rules.upper[axis] - rules.lower[axis]);
        box.upper[axis] += shift * (rules.upper[axis] - rules.lower[axis]);
        all.push_back(box);
      }
  }
  return all;
}

// Whether the ray from `start` towards `end`, reflected at boxes and at the walls of the rules, ends at `at`: the first
// hit among all slabs, one after the other.
inline bool sees(const ImageRules& rules, const std::vector<SolidBox>& in_domain, Point start, Point end,
                 const Point& at) {
  const std::vector<SolidBox> boxes = with_periodic_copies(rules, in_domain);
  // Walls and boxes are convex: one just left is not hit again at once, nor in the edge where the ray met two.
  std::size_t last = boxes.size() + 6;
  std::set<std::size_t> left;
  for (int hits = 0; hits < 12; ++hits) {
    double first = 2, plane = 0;
    int axis_hit = -1;
    std::size_t solid_hit = 0;
    const auto meet = [&](int axis, double at_plane, bool outwards, std::size_t solid, auto&& wetted) {
      if (solid == last) return;
      const double d = end[axis] - start[axis];
      if (d == 0 || (d > 0) != outwards) return;
      const double t = (at_plane - start[axis]) / d;
      if (t < (left.count(solid) > 0 ? 1e-9 : -1e-9) || t >= 1 || t >= first) return;
      Point hit{};
      for (int a = 0; a < rules.dimensions; ++a) hit[a] = start[a] + t * (end[a] - start[a]);
      if (!wetted(hit)) return;
      first = t;
      plane = at_plane;
      axis_hit = axis;
      solid_hit = solid;
    };
    for (int axis = 0; axis < rules.dimensions; ++axis) {
      for (int side = 0; side < 2; ++side)
        if (rules.sides[axis][side] == ImageKind::mirror)
          meet(axis, side == 0 ? rules.lower[axis] : rules.upper[axis], side == 1,
               boxes.size() + static_cast<std::size_t>(2 * axis + side), [](const Point&) { return true; });
      for (std::size_t b = 0; b < boxes.size(); ++b)
        for (int side = 0; side < 2; ++side)
          meet(axis, side == 0 ? boxes[b].lower[axis] : boxes[b].upper[axis], side == 0, b, [&](const Point& hit) {
            for (int a = 0; a < rules.dimensions; ++a)
              if (a != axis && (hit[a] < boxes[b].lower[a] || hit[a] > boxes[b].upper[a])) return false;
            return true;
          });
    }
    if (axis_hit < 0) {
      double distance2 = 0;
      for (int a = 0; a < rules.dimensions; ++a) distance2 += (end[a] - at[a]) * (end[a] - at[a]);
      return distance2 < 1e-18;
    }
    for (int a = 0; a < rules.dimensions; ++a) start[a] += first * (end[a] - start[a]);
    end[axis_hit] = 2 * plane - end[axis_hit];
    left.insert(solid_hit);
    last = solid_hit;
  }
  return false;
}

// All images of the points under the rules: every point under every combination of one operation per axis. With boxes
// these are reflections in the planes of all faces, within the support radius, and shifts after them.
inline std::vector<Image> images(const ImageRules& rules, const std::vector<Point>& points,
                                 const std::vector<SolidBox>& in_domain = {}) {
  const std::vector<SolidBox> boxes = with_periodic_copies(rules, in_domain);
  struct Operation {
    double x = 0;
    std::array<int, 2> face{-1, -1};
    int side = -1;
  };
  const auto operations = [&](int axis, double x) {
    std::vector<Operation> made{{x, {-1, -1}, -1}};
    if (axis >= rules.dimensions) return made;
    const double length = rules.upper[axis] - rules.lower[axis];
    const auto reflect = [&](double plane, int face, int side) {
      const double depth = side == 0 ? x - plane : plane - x;
      if (depth < rules.support_radius) made.push_back({2 * plane - x, {face, -1}, face < 0 ? side : -1});
    };
    for (int side = 0; side < 2; ++side)
      if (rules.sides[axis][side] == ImageKind::mirror)
        reflect(side == 0 ? rules.lower[axis] : rules.upper[axis], boxes.empty() ? -1 : side, side);
    for (std::size_t b = 0; b < boxes.size(); ++b)
      for (int side = 0; side < 2; ++side) {
        const double plane = side == 0 ? boxes[b].lower[axis] : boxes[b].upper[axis];
        const double depth = side == 0 ? plane - x : x - plane;
        // Copies along other axes have the same plane.
        const std::array<int, 2> face{2 + 2 * static_cast<int>(b % in_domain.size()) + side, -1};
        const bool known = std::any_of(made.begin(), made.end(), [&](const Operation& o) {
          return o.face == face && std::abs(o.x - (2 * plane - x)) < 1e-12;
        });
        if (depth > 0 && depth < rules.support_radius && !known) made.push_back({2 * plane - x, face, -1});
      }
    // In a gap narrower than the support radius, one face after the other.
    for (std::size_t p = 1, single = made.size(); p < single && !boxes.empty(); ++p)
      for (std::size_t q = 1; q < single; ++q) {
        const double gap = (made[q].x - made[p].x) / 2;
        if ((made[p].x - x) * (made[q].x - x) < 0 && std::abs(gap) < rules.support_radius)
          made.push_back({x + 2 * gap, {made[p].face[0], made[q].face[0]}, -1});
      }
    for (int side = 0; side < 2; ++side) {
      if (rules.sides[axis][side] != ImageKind::periodic) continue;
      const std::size_t before = made.size();
      for (std::size_t k = 0; k < before; ++k) {
        if (made[k].side >= 0) continue;
        const double depth = side == 0 ? made[k].x - rules.lower[axis] : rules.upper[axis] - made[k].x;
        if (length - depth < rules.support_radius)
          made.push_back({side == 0 ? made[k].x - length : made[k].x + length, made[k].face, side});
      }
    }
    return made;
  };
  std::vector<Image> made;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto along_x = operations(0, points[k][0]), along_y = operations(1, points[k][1]),
               along_z = operations(2, points[k][2]);
    for (const Operation& a : along_x)
      for (const Operation& b : along_y)
        for (const Operation& c : along_z) {
          Image image{{a.x, b.x, c.x}, static_cast<std::int32_t>(k), {}};
          const std::array<Operation, 3> all{a, b, c};
          for (int axis = 0; axis < 3; ++axis) {
            for (std::size_t which = 0; which < 2; ++which)
              image.path.face[axis][which] = static_cast<std::int16_t>(all[axis].face[which]);
            image.path.side[axis] = static_cast<std::int8_t>(all[axis].side);
          }
          if (image.path != ImagePath{}) made.push_back(image);
        }
  }
  return made;
}

// Where a ray to an image ends: its source, shifted as the image is.
inline Point end_of_ray(const ImageRules& rules, const Image& image, const Point& source) {
  Point end = source;
  for (int axis = 0; axis < rules.dimensions; ++axis)
    if (rules.sides[axis][0] == ImageKind::periodic && image.path.side[axis] >= 0)
      end[axis] += (image.path.side[axis] == 0 ? -1 : 1) * (rules.upper[axis] - rules.lower[axis]);
  return end;
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
