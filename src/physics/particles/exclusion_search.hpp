// SPDX-License-Identifier: MIT
// The search for overlaps around one particle or point.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>

#include "spume/core/periodic_grid.hpp"
#include "spume/core/simd.hpp"
#include "spume/physics/particles/exclusion.hpp"

namespace spume {

// More particles in one cell than spheres of comparable size could fill it with mean that they lie on top of each
// other. Each then looks only at those near it in the order of the cell: the cost stays proportional to the number of
// particles, and which overlaps go unseen in that step depends on the pair alone, so that both partners agree.
inline constexpr std::int32_t crowd = 256;
inline constexpr std::int32_t crowd_window = 64;

// What may overlap is put down first, up to this many, and then looked at together: it is rare and unforeseeable.
inline constexpr int found_room = 64;
// Particles of a row that are compared at once; places may be read as far past the last.
inline constexpr int search_group = 16;

// With the sphere of that rank; 0: none.
[[gnu::always_inline]] inline double Exclusion::overlap_with(const Centre& here, std::int32_t rank) const {
  double distance_2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double d = here.place[axis] - position_[axis][static_cast<std::size_t>(rank)];
    d -= length_[axis] * std::nearbyint(d * inverse_length_[axis]);
    distance_2 += d * d;
  }
  const double touching = here.radius + 0.5 * diameter_of(static_cast<std::size_t>(rank));
  const double overlap = touching - std::sqrt(distance_2);
  return overlapping(distance_2, touching) & (rank != here.rank) ? overlap : 0.0;
}

inline float Exclusion::safe_square(double reach) const {
  const double safe_reach = reach + 16 * 0x1p-24 * std::max({length_[0], length_[1], length_[2]});
  return static_cast<float>(safe_reach * safe_reach * (1 + 1e-6));
}

template <class CentreOf, class Use>
bool Exclusion::search_near(const std::array<float, 3>& place, std::int32_t rank, float limit, CentreOf&& centre,
                            Use&& use) const {
  // A sphere reaches half a cell, so that along every axis the nearer neighbour is all it can reach.
  int low[3];
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = static_cast<int>(std::floor(place[axis] * cells_per_length_[axis] - 0.5F));
    inside &= (low[axis] >= 0) & (low[axis] + 1 < cells_.count[axis]);
  }
  if (!inside) return false;

  // Four rows of two cells along z, in groups of sixteen: one word tells which of them are near, without a branch for
  // the length of a row or the number of cells that it took.
  constexpr int rows = 4, group = search_group;
  const std::int32_t* corner = order_.first() + cell_number(low[0], low[1], low[2]);
  const std::int32_t* row[rows] = {corner, corner + cells_.count[2], corner + cells_.plane(),
                                   corner + cells_.plane() + cells_.count[2]};
  std::int32_t begin[rows], end[rows], longest = 0;
  for (int r = 0; r < rows; ++r) {
    begin[r] = row[r][0];
    end[r] = row[r][2];
    longest = std::max(longest, end[r] - begin[r]);
  }
  if (longest > crowd) return false;

  using simd::f32n;
  const f32n limit_2 = simd::splat<f32n>(limit);
  const f32n cx = simd::splat<f32n>(place[0]), cy = simd::splat<f32n>(place[1]), cz = simd::splat<f32n>(place[2]);
  const float *x = place_[0].data(), *y = place_[1].data(), *z = place_[2].data();
  for (; longest > 0; longest -= group) {
    std::uint64_t near = 0;
    for (int r = 0; r < rows; ++r) {
      std::uint64_t bits = 0;
      for (int half = 0; half < group; half += simd::pair_lanes) {
        const std::int32_t m = begin[r] + half;
        const f32n dx = simd::load<f32n>(x + m) - cx, dy = simd::load<f32n>(y + m) - cy,
                   dz = simd::load<f32n>(z + m) - cz;
        bits |= std::uint64_t{simd::less_bits(dx * dx + dy * dy + dz * dz, limit_2)} << half;
      }
      bits &= 0xffffU >> (group - std::min(end[r] - begin[r], group));
      near |= bits << group * r;
    }
    if (near != 0) {
      std::int32_t found[found_room];
      double overlap[found_room];
      int count = 0;
      const Centre here = centre();
      for (; near != 0; near &= near - 1) {
        const int bit = std::countr_zero(near);
        found[count] = begin[bit / group] + bit % group;
        overlap[count] = overlap_with(here, found[count]);
        count += found[count] != rank ? 1 : 0;
      }
      use(found, overlap, count);
    }
    for (int r = 0; r < rows; ++r) begin[r] = std::min(begin[r] + group, end[r]);
  }
  return true;
}

template <bool own_images, class Use>
void Exclusion::search_cells(const Centre& here, Use&& use) const {
  const double reach = here.radius + 0.5 * largest_diameter_;
  const std::int32_t rank = here.rank;
  int from[3], to[3], own[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double scale = inverse_side_[axis];
    const double cell = (here.place[axis] - lower_[axis]) * scale;
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
  const std::size_t own_cell = cell_number(own[0], own[1], own[2]);
  const bool own_crowded = rank >= 0 && first[own_cell + 1] - first[own_cell] > crowd;

  // What to look at, cell rows along z: ranks, and the image of the box that they lie in.
  struct Row {
    std::int32_t begin, end;
    float shift[3];
  };
  Row rows[96];  // at most 9 rows, of 3 cells each where there is a crowd, twice at the ends of the box
  int row_count = 0;
  const auto add_row = [&](int i, int j, int l0, int l1, float shift_x, float shift_y, float shift_z) {
    const std::int32_t begin = first[cell_number(i, j, l0)], end = first[cell_number(i, j, l1) + 1];
    if (rank < 0 || (!own_crowded && end - begin <= crowd)) {
      rows[row_count++] = {begin, end, {shift_x, shift_y, shift_z}};
      return;
    }
    for (int l = l0; l <= l1; ++l) {
      std::int32_t b = first[cell_number(i, j, l)], e = first[cell_number(i, j, l) + 1];
      if (own_crowded || e - b > crowd) {
        b = std::max(b, rank - crowd_window);
        e = std::min(e, rank + crowd_window + 1);
      }
      rows[row_count++] = {b, e, {shift_x, shift_y, shift_z}};
    }
  };
  const auto wrapped = [&](int i, int axis, float& shift) {
    const int n = cells_.count[axis];
    shift = static_cast<float>(i < 0 ? -length_[axis] : (i >= n ? length_[axis] : 0.0));
    return i < 0 ? i + n : (i >= n ? i - n : i);
  };
  const int nz = cells_.count[2];
  const auto length_z = static_cast<float>(length_[2]);
  for (int i = from[0]; i <= to[0]; ++i) {
    float shift_x, shift_y;
    const int wi = wrapped(i, 0, shift_x);
    for (int j = from[1]; j <= to[1]; ++j) {
      const int wj = wrapped(j, 1, shift_y);
      if (from[2] < 0) add_row(wi, wj, nz + from[2], nz - 1, shift_x, shift_y, -length_z);
      add_row(wi, wj, std::max(from[2], 0), std::min(to[2], nz - 1), shift_x, shift_y, 0);
      if (to[2] >= nz) add_row(wi, wj, 0, to[2] - nz, shift_x, shift_y, length_z);
    }
  }

  const simd::f32x8 limit_2 = simd::splat(safe_square(reach));
  const float centre[3] = {static_cast<float>(here.place[0] - lower_[0]), static_cast<float>(here.place[1] - lower_[1]),
                           static_cast<float>(here.place[2] - lower_[2])};
  const float *x = place_[0].data(), *y = place_[1].data(), *z = place_[2].data();

  std::int32_t found[found_room + simd::lanes];
  double overlap[found_room + simd::lanes];
  const auto use_found = [&](int n) {
    for (int f = 0; f < n; ++f) overlap[f] = overlap_with(here, found[f]);
    use(found, overlap, n);
    return 0;
  };
  int count = 0;
  for (int r = 0; r < row_count; ++r) {
    const std::int32_t end = rows[r].end;
    const simd::f32x8 cx = simd::splat(centre[0] - rows[r].shift[0]), cy = simd::splat(centre[1] - rows[r].shift[1]),
                      cz = simd::splat(centre[2] - rows[r].shift[2]);
    for (std::int32_t m = rows[r].begin; m < end; m += simd::lanes) {
      unsigned near = 0xffU;
      if constexpr (!own_images) {
        const simd::f32x8 dx = simd::load(x + m) - cx, dy = simd::load(y + m) - cy, dz = simd::load(z + m) - cz;
        near = simd::less_bits(dx * dx + dy * dy + dz * dz, limit_2);
      }
      near &= 0xffU >> (simd::lanes - std::min(end - m, simd::lanes));
      count += simd::store_lanes(found + count, m, near);
      if (count > found_room) count = use_found(count);
    }
  }
  use_found(count);
}

inline Exclusion::Centre Exclusion::centre_of(std::size_t k) const {
  return {{position_[0][k], position_[1][k], position_[2][k]}, 0.5 * diameter_of(k), static_cast<std::int32_t>(k)};
}

template <class Use>
void Exclusion::search_around(std::size_t k, Use&& use) const {
  const auto centre = [&] { return centre_of(k); };
  const float limit = common_limit_ > 0 ? common_limit_ : safe_square(0.5 * (diameter_of(k) + largest_diameter_));
  if (own_images_)
    search_cells<true>(centre(), use);
  else if (!reaches_half_a_cell_ ||
           !search_near({place_[0][k], place_[1][k], place_[2][k]}, static_cast<std::int32_t>(k), limit, centre, use))
    search_cells<false>(centre(), use);
}

template <class Visit>
void Exclusion::for_each_overlap(std::size_t k, Visit&& visit) const {
  search_around(k, [&](const std::int32_t* rank, const double* overlap, int count) {
    for (int f = 0; f < count; ++f)
      if (overlap[f] > 0) visit(rank[f], overlap[f]);
  });
}

template <class Visit>
void Exclusion::for_each_covering(const std::array<double, 3>& point, Visit&& visit) const {
  const Centre here{point, 0, -1};
  const auto use = [&](const std::int32_t* rank, const double* overlap, int count) {
    for (int f = 0; f < count; ++f)
      if (overlap[f] > 0) visit(rank[f], overlap[f]);
  };
  if (own_images_)
    search_cells<true>(here, use);
  else
    search_cells<false>(here, use);
}

}  // namespace spume
