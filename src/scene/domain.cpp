// SPDX-License-Identifier: MIT
#include "spume/core/periodic_grid.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

double Domain::inside(int axis, double x) const {
  return periodic(axis) ? wrap_periodic(x, lower[axis], upper[axis] - lower[axis]) : x;
}

Vec3 Domain::inside(Vec3 place) const {
  for (int axis = 0; axis < dimensions; ++axis) place[axis] = inside(axis, place[axis]);
  return place;
}

Vec3 Domain::shortest(Vec3 way) const {
  for (int axis = 0; axis < dimensions; ++axis)
    if (periodic(axis)) way[axis] = nearest_image(way[axis], upper[axis] - lower[axis]);
  return way;
}

}  // namespace spume
