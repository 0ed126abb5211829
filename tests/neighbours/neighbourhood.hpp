// SPDX-License-Identifier: MIT
// Points, their sorted order, images and lists, built together as a method does.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "reference/brute_force.hpp"
#include "spume/core/random.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/images.hpp"
#include "spume/neighbours/neighbour_list.hpp"

namespace spume::test {

using reference::Point;

inline Point uniform(std::uint64_t identifier, std::uint32_t draw = 0) {
  const auto r = random_uniform(20, RandomPurpose::test, identifier, 0, draw);
  return {r[0], r[1], r[2]};
}

// Uniform in the unit box.
inline std::vector<Point> random_points(std::size_t n, int dimensions) {
  std::vector<Point> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    points[i] = uniform(i);
    if (dimensions == 2) points[i][2] = 0;
  }
  return points;
}

// A lattice of m^dimensions cells of the unit box, each point moved by up to jitter/2 cells.
inline std::vector<Point> lattice_points(int m, int dimensions, double jitter) {
  std::vector<Point> points;
  for (int c = 0; c < (dimensions == 3 ? m : 1); ++c)
    for (int b = 0; b < m; ++b)
      for (int a = 0; a < m; ++a) {
        const Point r = uniform(points.size(), 1);
        points.push_back({(a + 0.5 + jitter * (r[0] - 0.5)) / m, (b + 0.5 + jitter * (r[1] - 0.5)) / m,
                          dimensions == 3 ? (c + 0.5 + jitter * (r[2] - 0.5)) / m : 0});
      }
  return points;
}

// Most points in a few blobs a support radius wide, the others anywhere.
inline std::vector<Point> clustered_points(std::size_t n, int dimensions, double width) {
  std::vector<Point> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Point r = uniform(i), centre = uniform(i % 5, 7);
    for (int axis = 0; axis < dimensions; ++axis)
      points[i][axis] = i % 10 == 0 ? r[axis] : centre[axis] * (1 - width) + width * r[axis];
  }
  return points;
}

inline ImageRules unit_box_rules(int dimensions, double support_radius, ImageKind x, ImageKind y, ImageKind z) {
  ImageRules rules;
  rules.dimensions = dimensions;
  rules.upper = {1, 1, 1};
  rules.sides = {{{x, x}, {y, y}, {z, z}}};
  rules.support_radius = support_radius;
  return rules;
}

// Walls of the rules and boxes as one solid.
inline std::shared_ptr<const SolidUnion> unite(const ImageRules& rules, const std::vector<SolidBox>& boxes,
                                               double spacing) {
  Domain domain;
  domain.dimensions = rules.dimensions;
  domain.lower = rules.lower;
  domain.upper = rules.upper;
  domain.boxes = boxes;
  SolidUnion::Planes sides{};
  for (int axis = 0; axis < 3; ++axis) {
    sides[axis] = {rules.lower[axis], rules.upper[axis]};
    for (int side = 0; side < 2; ++side)
      domain.sides[axis][side].kind = rules.sides[axis][side] == ImageKind::mirror     ? BoundaryKind::free_slip
                                      : rules.sides[axis][side] == ImageKind::periodic ? BoundaryKind::periodic
                                                                                       : BoundaryKind::open;
  }
  return std::make_shared<const SolidUnion>(domain, sides, spacing);
}

inline bool inside_any(const std::vector<SolidBox>& boxes, const Point& p, int dimensions) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const SolidBox& box) {
    bool inside = true;
    for (int axis = 0; axis < dimensions; ++axis)
      inside = inside && p[axis] > box.lower[axis] && p[axis] < box.upper[axis];
    return inside;
  });
}

struct Neighbourhood {
  ImageRules rules;
  CellGrid grid;
  CellOrder table;
  Images images;
  NeighbourList list;
  Array<double> x, y, z;
  std::size_t n = 0;
  std::array<double, 3> origin{0.5, 0.5, 0.5};

  Neighbourhood(const ImageRules& image_rules, const std::vector<Point>& points)
      : rules(image_rules), n(points.size()) {
    std::array<double, 3> lower = rules.lower, upper = rules.upper;
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] -= rules.support_radius;
      upper[axis] += rules.support_radius;
    }
    grid = CellGrid(rules.dimensions, lower, upper, rules.support_radius, n);
    const Array<double> px = column(points, 0), py = column(points, 1), pz = column(points, 2);
    table.build(grid, px.data(), py.data(), pz.data(), n);
    x = y = z = Array<double>(n);
    for (std::size_t k = 0; k < n; ++k) {
      const auto from = static_cast<std::size_t>(table.order()[k]);
      x[k] = px[from];
      y[k] = py[from];
      z[k] = pz[from];
    }
    build();
  }

  // Everything again, from the sorted points.
  void build() {
    table.build(grid, x.data(), y.data(), z.data(), n);
    images.build(rules, grid, x.data(), y.data(), z.data(), n);
    list.build(grid, table, x.data(), y.data(), z.data(), n, images, origin);
  }

  // Particles, then images.
  std::vector<Point> all() const {
    std::vector<Point> points(n + images.size());
    for (std::size_t i = 0; i < n; ++i) points[i] = {x[i], y[i], z[i]};
    for (std::size_t k = 0; k < images.size(); ++k)
      for (int axis = 0; axis < rules.dimensions; ++axis) points[n + k][axis] = images.position(axis)[k];
    return points;
  }

  static Array<double> column(const std::vector<Point>& points, int axis) {
    Array<double> values(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    return values;
  }
};

}  // namespace spume::test
