// SPDX-License-Identifier: MIT
// Particles around a place that is none of them, with their copies beyond periodic sides.
#pragma once

#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

// Of the support radius: where quadratic fits beside a wall look for particles. Half a disc then holds 17, enough in
// two dimensions, where the support radius alone has 11.
inline constexpr double fit_reach = 1.25;

// Calls visit(k, shift) for every sorted place k of `table` whose cell comes within `reach` of the place; `shift`, of
// whole periods, is what its particle is moved by. Cells also hold particles that are farther away.
template <class Visit>
void visit_near(const Domain& domain, const CellGrid& grid, const CellOrder& table, const Vec3& place, double reach,
                Visit&& visit) {
  const int d = domain.dimensions;
  const auto visit_cells = [&](const Vec3& shift) {
    std::array<int, 3> from{}, to{};
    for (int axis = 0; axis < d; ++axis) {
      from[axis] = grid.index(axis, place[axis] - shift[axis] - reach);
      to[axis] = grid.index(axis, place[axis] - shift[axis] + reach);
    }
    for (int iz = from[2]; iz <= to[2]; ++iz)
      for (int iy = from[1]; iy <= to[1]; ++iy) {
        const std::int32_t* const row = table.first() + std::int64_t{grid.row(iy, iz)} * grid.columns();
        for (std::int32_t k = row[from[0]]; k < row[to[0] + 1]; ++k) visit(k, shift);
      }
  };
  std::array<std::array<double, 3>, 3> choice{};  // per axis: no shift, then whole periods
  std::array<std::size_t, 3> choices{1, 1, 1};
  for (int axis = 0; axis < d; ++axis) {
    if (!domain.periodic(axis)) continue;
    const double length = domain.upper[axis] - domain.lower[axis];
    if (place[axis] - reach < domain.lower[axis]) choice[axis][choices[axis]++] = -length;
    if (place[axis] + reach > domain.upper[axis]) choice[axis][choices[axis]++] = length;
  }
  for (std::size_t i = 0; i < choices[0]; ++i)
    for (std::size_t j = 0; j < choices[1]; ++j)
      for (std::size_t k = 0; k < choices[2]; ++k) visit_cells({choice[0][i], choice[1][j], choice[2][k]});
}

}  // namespace spume
