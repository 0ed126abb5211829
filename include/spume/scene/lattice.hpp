// SPDX-License-Identifier: MIT
// The lattice that places the liquid particles of the start.
//
// Cell centres lower + (k + 1/2) d per axis. Where both sides of an axis are walls or the axis is periodic, d is the
// length over the nearest integer count; otherwise d is the spacing, measured from the wall if there is one. Every
// particle has the volume of a cell.
#pragma once

#include <array>

#include "spume/scene/scene.hpp"

namespace spume {

struct Lattice {
  int dimensions = 3;
  Vec3 origin{};                         // lower corner of the first cell
  Vec3 spacing{};                        // 1 in directions that do not exist
  std::array<double, 3> count{1, 1, 1};  // whole numbers, as double because a foolish case may overflow
  double volume() const { return spacing[0] * spacing[1] * spacing[2]; }
  double sites() const { return count[0] * count[1] * count[2]; }
};

Lattice make_lattice(const Domain& domain, double spacing);

}  // namespace spume
