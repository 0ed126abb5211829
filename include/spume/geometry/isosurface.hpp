// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <vector>

#include "spume/geometry/shape.hpp"

namespace spume {

// Nodes lower + spacing (i, j, k), of an axis that does not exist one.
struct NodeGrid {
  Vec3 lower{};
  double spacing = 0;
  std::array<std::size_t, 3> count{1, 1, 1};
  std::size_t size() const { return count[0] * count[1] * count[2]; }
  std::size_t number(std::size_t i, std::size_t j, std::size_t k) const { return (k * count[1] + j) * count[0] + i; }
  Vec3 node(std::size_t number) const {
    const std::size_t i = number % count[0], j = number / count[0] % count[1], k = number / count[0] / count[1];
    return {lower[0] + spacing * static_cast<double>(i), lower[1] + spacing * static_cast<double>(j),
            lower[2] + spacing * static_cast<double>(k)};
  }
};

// Covers the box with whole cells, which it is made wider for where it takes more than `most` nodes.
NodeGrid cover(const Bounds& box, double spacing, int dimensions, std::size_t most);

// Where a function changes its sign. `boundary` are the facets; in two dimensions each segment is a pair of triangles
// that stand upright on it, as high as the grid is wide, so that its distance in the plane is theirs. `body` is what is
// drawn: the facets, or in two dimensions the positive area.
struct Isosurface {
  TriangleSurface boundary, body;
};
// `nodes` are the values at the nodes of the grid, every cell of which is cut into simplices along its diagonal.
Isosurface find_isosurface(const std::function<double(const Vec3&)>& value, const NodeGrid& grid,
                           const std::vector<double>& nodes, int dimensions);

// Where values that are linear on each simplex change their sign, in cells whose nodes all have a finite one:
// triangles, counter-clockwise seen from where they are not positive, in two dimensions segments with the positive side
// to the left. Cells share the points on their edges.
struct Contour {
  std::vector<Vec3> points;
  std::vector<std::int32_t> corners;  // `dimensions` of each triangle or segment
};
Contour find_contour(const NodeGrid& grid, const std::vector<double>& nodes, int dimensions);

}  // namespace spume
