// SPDX-License-Identifier: MIT
// The solid boxes of a domain and its walls as one solid: where liquid may be, which faces it wets, and what a point
// sees of it by reflection.
//
// The planes of all faces cut space into cells, each of which is solid or free as a whole. Faces between solids do not
// exist, and boxes may touch, overlap or repeat. A box that lies on or beyond a side of the domain has no face there.
// Outside walls everything is solid, outside open sides nothing but boxes that reach them, outside periodic sides what
// is inside the opposite ones.
//
// A wall is a mirror. What a point i sees at a place P in a solid is the liquid that a straight ray of the length
// |P - i| towards P ends at when faces reflect it: every P is seen once, through one face or, in a corner of the
// liquid, through several. If i sees j in this way then j sees i in the same. Rays around an edge of a solid see past
// it, and nothing is seen through a solid, however thin.
//
// A ray through an edge or a corner, to 1e-6 spacings, meets several planes at once. It passes where it could cross
// them one after the other, and else is reflected as it is in every order of the planes, seen from either end. Where
// orders differ, which is where it meets the edge of a convex solid head-on, it sees nothing. So points of a lattice
// see each other too: without that the matrix of the pressure is not symmetric, and in a closed liquid it has no
// solution.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "spume/core/vec3.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

class SolidUnion {
 public:
  using Planes = std::array<std::array<double, 2>, 3>;  // of the sides: [axis][0 lower, 1 upper]

  // `spacing`: faces nearer to each other than 1e-6 of it are one.
  SolidUnion(const Domain& domain, const Planes& sides, double spacing);

  // The number of cells that boxes in a domain would need, before they are made.
  static double cells_needed(const Domain& domain);

  // In a solid or outside a wall; not on a face that liquid wets.
  bool inside(const Vec3& point) const { return owner(cells_of(point)) != free_cell; }
  // The point nearest to `point` that lies in free space or on a face of it; the point itself outside solids. Of points
  // equally near, up to `tie`, that of the lowest cell, whatever rounding says.
  Vec3 nearest_free(const Vec3& point, double tie) const;
  // Whether the free space nearer to `point` than `reach` along every axis is one box, bounded by whole faces or by
  // nothing: then everything in it sees everything.
  bool open_around(const Vec3& point, double reach) const;
  // The largest box of free space around a point within `reach` of it along every axis; sides farther than that are
  // infinite. Empty in a solid.
  std::array<Vec3, 2> free_box(const Vec3& point, double reach) const;
  // No solid in the box of half the width `reach`.
  bool clear_around(const Vec3& point, double reach) const;
  // The ray from i towards `to`, reflected at faces, ends at `at`, to 1e-6 spacings.
  bool sees(const Vec3& i, const Vec3& to, const Vec3& at) const;

  // Planes of faces along an axis, ascending.
  const std::vector<double>& planes(int axis) const { return planes_[axis]; }
  // Of those, the ones with a wetted face in the box.
  std::vector<double> wetted_planes(int axis, const Vec3& lower, const Vec3& upper) const;
  // What the box holds outside solids.
  double free_volume(const Vec3& lower, const Vec3& upper) const;
  // The face code of the wetted part of a plane nearest to a point, within `reach` of it and turned towards it: 0 and 1
  // the lower and upper side of the domain, 2 + 2 box + side a face of a box, where boxes share it of the first.
  // -1: there is none.
  int face_near(const Vec3& point, int axis, std::size_t plane, double reach) const;

 private:
  using Cell = std::array<int, 3>;
  static constexpr std::int32_t free_cell = -1, outside_lower = -2, outside_upper = -3;

  int cell_along(int axis, double x) const;
  Cell cells_of(const Vec3& point) const;
  std::size_t number(const Cell& cell) const {
    return (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(count_[1]) +
            static_cast<std::size_t>(cell[1])) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(cell[0]);
  }
  std::int32_t owner(const Cell& cell) const { return owner_[number(cell)]; }
  // Bits of the axes along which a ray is reflected that leaves a cell through planes that it meets at once; nothing
  // where it ends. `step`: to the next cell along each of these axes, 0 along the others.
  std::optional<unsigned> reflected_axes(const Cell& from, const Cell& step) const;
  // 0 where the planes can be crossed one after the other, what all their orders agree on, nothing where they differ.
  std::optional<unsigned> reflected_in_any_order(const Cell& from, const Cell& step) const;
  double lower_of(int axis, int cell) const {
    return cell == 0 ? -far : planes_[axis][static_cast<std::size_t>(cell) - 1];
  }
  double upper_of(int axis, int cell) const {
    return cell == count_[axis] - 1 ? far : planes_[axis][static_cast<std::size_t>(cell)];
  }
  // visit(cell) of all cells that the box around a point touches, until it returns false.
  template <class Visit>
  bool each_around(const Vec3& point, double reach, Visit&& visit) const;

  static constexpr double far = 1e300;
  int dimensions_;
  double tolerance_;
  std::array<std::vector<double>, 3> planes_;
  std::array<int, 3> count_{1, 1, 1};  // cells along an axis: one more than planes
  // free_cell, the first box that holds the cell, or outside_lower/upper - 2 axis... of the wall that it lies beyond.
  std::vector<std::int32_t> owner_;
};

}  // namespace spume
