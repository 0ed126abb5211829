// SPDX-License-Identifier: MIT
// The search for overlaps around one particle or point.
#pragma once

#include <algorithm>
#include <cmath>

#include "spume/core/periodic_grid.hpp"
#include "spume/physics/particles/exclusion.hpp"

namespace spume {

// More particles in one cell than spheres of comparable size could fill it with mean that they lie on top of each
// other. Each then looks only at those near it in the order of the cell: the cost stays proportional to the number of
// particles, and which overlaps go unseen in that step depends on the pair alone, so that both partners agree.
inline constexpr std::int32_t crowd = 256;
inline constexpr std::int32_t crowd_window = 64;

template <bool own_images, class Visit>
void Exclusion::visit_cells(const Record& here, std::int32_t rank, Visit&& visit) const {
  const double own_radius = 0.5 * static_cast<double>(here.diameter);
  const double reach = own_radius + 0.5 * largest_diameter_;
  const double place[3] = {here.x, here.y, here.z};
  int from[3], to[3], own[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double scale = inverse_side_[axis];
    const double cell = (place[axis] - lower_[axis]) * scale;
    own[axis] = std::clamp(static_cast<int>(cell), 0, cells_.count[axis] - 1);
    if (cells_.count[axis] < 3) {
      from[axis] = 0;
      to[axis] = cells_.count[axis] - 1;
    } else {
      // Never past the direct neighbours, also when rounding says so.
      from[axis] = std::max(static_cast<int>(std::floor(cell - reach * scale)), own[axis] - 1);
      to[axis] = std::min(static_cast<int>(std::floor(cell + reach * scale)), own[axis] + 1);
    }
  }
  const std::int32_t* first = order_.first();
  const auto number = [&](int i, int j, int l) {
    return (static_cast<std::size_t>(i) * cells_.count[1] + j) * static_cast<std::size_t>(cells_.count[2]) + l;
  };
  const std::size_t own_cell = number(own[0], own[1], own[2]);
  const bool own_crowded = rank >= 0 && first[own_cell + 1] - first[own_cell] > crowd;

  // Overlaps are rare and unforeseeable: found ones are put down without a branch and visited together.
  constexpr int room = 64;
  std::int32_t found[room];
  double found_distance_2[room];
  int count = 0;
  const auto visit_found = [&] {
    for (int f = 0; f < count; ++f) {
      const Record& there = records_[static_cast<std::size_t>(found[f])];
      visit(found[f], own_radius + 0.5 * static_cast<double>(there.diameter) - std::sqrt(found_distance_2[f]));
    }
    count = 0;
  };
  const Record* records = records_.data();
  const auto scan = [&](std::int32_t begin, std::int32_t end, double shift_x, double shift_y, double shift_z) {
    while (begin < end) {
      const std::int32_t stop = std::min(end, begin + room - count);
      for (std::int32_t m = begin; m < stop; ++m) {
        const Record& there = records[m];
        double dx = here.x - there.x, dy = here.y - there.y, dz = here.z - there.z;
        if constexpr (own_images) {
          dx = nearest_image(dx, length_[0]);
          dy = nearest_image(dy, length_[1]);
          dz = nearest_image(dz, length_[2]);
        } else {
          dx -= shift_x;
          dy -= shift_y;
          dz -= shift_z;
        }
        const double distance_2 = dx * dx + dy * dy + dz * dz;
        const double touching = own_radius + 0.5 * static_cast<double>(there.diameter);
        found[count] = m;
        found_distance_2[count] = distance_2;
        count += static_cast<int>(overlapping(distance_2, touching)) & static_cast<int>(m != rank);
      }
      begin = stop;
      if (count == room) visit_found();
    }
  };
  // One row of cells along z within the grid.
  const auto scan_row = [&](int i, int j, int l0, int l1, double shift_x, double shift_y, double shift_z) {
    const std::int32_t begin = first[number(i, j, l0)], end = first[number(i, j, l1) + 1];
    if (rank < 0 || (!own_crowded && end - begin <= crowd)) {
      scan(begin, end, shift_x, shift_y, shift_z);
      return;
    }
    for (int l = l0; l <= l1; ++l) {
      std::int32_t b = first[number(i, j, l)], e = first[number(i, j, l) + 1];
      if (own_crowded || e - b > crowd) {
        b = std::max(b, rank - crowd_window);
        e = std::min(e, rank + crowd_window + 1);
      }
      scan(b, e, shift_x, shift_y, shift_z);
    }
  };
  const auto wrapped = [&](int i, int axis, double& shift) {
    const int n = cells_.count[axis];
    shift = i < 0 ? -length_[axis] : (i >= n ? length_[axis] : 0.0);
    return i < 0 ? i + n : (i >= n ? i - n : i);
  };
  const int nz = cells_.count[2];
  for (int i = from[0]; i <= to[0]; ++i) {
    double shift_x, shift_y;
    const int wi = wrapped(i, 0, shift_x);
    for (int j = from[1]; j <= to[1]; ++j) {
      const int wj = wrapped(j, 1, shift_y);
      if (from[2] < 0) scan_row(wi, wj, nz + from[2], nz - 1, shift_x, shift_y, -length_[2]);
      scan_row(wi, wj, std::max(from[2], 0), std::min(to[2], nz - 1), shift_x, shift_y, 0);
      if (to[2] >= nz) scan_row(wi, wj, 0, to[2] - nz, shift_x, shift_y, length_[2]);
    }
  }
  visit_found();
}

template <class Visit>
void Exclusion::for_each_overlap(std::size_t k, Visit&& visit) const {
  visit_around(records_[k], static_cast<std::int32_t>(k), visit);
}

template <class Visit>
void Exclusion::for_each_covering(const std::array<double, 3>& point, Visit&& visit) const {
  visit_around({point[0], point[1], point[2], 0, -1}, -1, visit);
}

template <class Visit>
void Exclusion::visit_around(const Record& here, std::int32_t rank, Visit&& visit) const {
  if (own_images_)
    visit_cells<true>(here, rank, visit);
  else
    visit_cells<false>(here, rank, visit);
}

}  // namespace spume
