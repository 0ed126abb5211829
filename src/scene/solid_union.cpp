// SPDX-License-Identifier: MIT
#include "spume/scene/solid_union.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace spume {
namespace {

bool is_wall(BoundaryKind kind) {
  return kind == BoundaryKind::free_slip || kind == BoundaryKind::no_slip;
}

struct NumberedBox {
  SolidBox box;
  std::int32_t number;
};

// The boxes of a domain, clipped at its periodic sides, and their copies beyond these.
std::vector<NumberedBox> with_periodic_copies(const Domain& domain) {
  std::vector<NumberedBox> boxes;
  for (const SolidBox& box : domain.boxes) boxes.push_back({box, static_cast<std::int32_t>(boxes.size())});
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    if (!domain.periodic(axis)) continue;
    const double lower = domain.lower[axis], upper = domain.upper[axis];
    const std::size_t before = boxes.size();
    for (std::size_t b = 0; b < before; ++b) {
      boxes[b].box.lower[axis] = std::max(boxes[b].box.lower[axis], lower);
      boxes[b].box.upper[axis] = std::min(boxes[b].box.upper[axis], upper);
      for (const double shift : {lower - upper, upper - lower}) {
        boxes.push_back(boxes[b]);
        boxes.back().box.lower[axis] += shift;
        boxes.back().box.upper[axis] += shift;
      }
    }
  }
  return boxes;
}

}  // namespace

double SolidUnion::cells_needed(const Domain& domain) {
  double cells = 1;
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    std::vector<double> planes{domain.lower[axis], domain.upper[axis]};
    for (const SolidBox& box : domain.boxes) {
      const double length = domain.upper[axis] - domain.lower[axis];
      for (const double shift : {-length, 0.0, length})
        if (shift == 0 || domain.periodic(axis))
          planes.insert(planes.end(), {box.lower[axis] + shift, box.upper[axis] + shift});
    }
    std::sort(planes.begin(), planes.end());
    cells *= static_cast<double>(std::unique(planes.begin(), planes.end()) - planes.begin()) + 1;
  }
  return cells;
}

SolidUnion::SolidUnion(const Domain& domain, const Planes& sides, double spacing)
    : dimensions_(domain.dimensions), tolerance_(1e-6 * spacing) {
  // A box that lies on or beyond a side that is not periodic continues there without end.
  std::vector<NumberedBox> boxes = with_periodic_copies(domain);
  for (int axis = 0; axis < dimensions_; ++axis) {
    std::vector<double> all;
    for (int side = 0; side < 2; ++side)
      if (is_wall(domain.sides[axis][side].kind)) all.push_back(sides[axis][side]);
    for (auto& [box, number] : boxes) {
      if (!domain.periodic(axis) && box.lower[axis] <= sides[axis][0] + tolerance_) box.lower[axis] = -far;
      if (!domain.periodic(axis) && box.upper[axis] >= sides[axis][1] - tolerance_) box.upper[axis] = far;
      for (const double plane : {box.lower[axis], box.upper[axis]})
        if (std::abs(plane) < far) all.push_back(plane);
    }
    std::sort(all.begin(), all.end());
    for (const double plane : all)
      if (planes_[axis].empty() || plane > planes_[axis].back() + tolerance_) planes_[axis].push_back(plane);
    count_[axis] = static_cast<int>(planes_[axis].size()) + 1;
  }
  owner_.assign(
      static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) * static_cast<std::size_t>(count_[2]),
      free_cell);
  // Cells between two coordinates that are planes, up to the tolerance, or infinite.
  const auto fill = [&](const Vec3& lower, const Vec3& upper, std::int32_t value) {
    Cell first{}, last{};
    for (int axis = 0; axis < dimensions_; ++axis) {
      first[axis] = cell_along(axis, lower[axis] + 2 * tolerance_);
      last[axis] = cell_along(axis, upper[axis] - 2 * tolerance_);
    }
    Cell cell;
    for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2])
      for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
        for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0])
          if (std::int32_t& entry = owner_[number(cell)]; entry == free_cell) entry = value;
  };
  for (const auto& [box, number] : boxes) fill(box.lower, box.upper, number);
  for (int axis = 0; axis < dimensions_; ++axis)
    for (int side = 0; side < 2; ++side) {
      if (!is_wall(domain.sides[axis][side].kind)) continue;
      Vec3 lower{-far, -far, -far}, upper{far, far, far};
      (side == 0 ? upper : lower)[axis] = sides[axis][side];
      fill(lower, upper, side == 0 ? outside_lower : outside_upper);
    }
}

int SolidUnion::cell_along(int axis, double x) const {
  const std::vector<double>& planes = planes_[axis];
  return static_cast<int>(std::upper_bound(planes.begin(), planes.end(), x) - planes.begin());
}

SolidUnion::Cell SolidUnion::cells_of(const Vec3& point) const {
  Cell cell{};
  for (int axis = 0; axis < dimensions_; ++axis) cell[axis] = cell_along(axis, point[axis]);
  return cell;
}

template <class Visit>
bool SolidUnion::each_around(const Vec3& point, double reach, Visit&& visit) const {
  Cell first{}, last{};
  for (int axis = 0; axis < dimensions_; ++axis) {
    first[axis] = cell_along(axis, point[axis] - reach);
    last[axis] = cell_along(axis, point[axis] + reach);
  }
  Cell cell;
  for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2])
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
      for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0])
        if (!visit(cell)) return false;
  return true;
}

Vec3 SolidUnion::nearest_free(const Vec3& point, double tie) const {
  if (!inside(point)) return point;
  // The search widens until it holds a free point nearer than its reach.
  for (double reach = std::max(tie, tolerance_) * 1e6;; reach *= 4) {
    double least2 = far;
    Vec3 nearest = point;
    each_around(point, reach, [&](const Cell& cell) {
      if (owner(cell) != free_cell) return true;
      Vec3 candidate = point;
      double distance2 = 0;
      for (int axis = 0; axis < dimensions_; ++axis) {
        candidate[axis] = std::clamp(point[axis], lower_of(axis, cell[axis]), upper_of(axis, cell[axis]));
        distance2 += (candidate[axis] - point[axis]) * (candidate[axis] - point[axis]);
      }
      if (std::sqrt(distance2) < std::sqrt(least2) - tie) {
        least2 = distance2;
        nearest = candidate;
      }
      return true;
    });
    if (least2 <= reach * reach || reach > 1e100) return nearest;
  }
}

bool SolidUnion::open_around(const Vec3& point, double reach) const {
  Cell lower{count_}, upper{-1, -1, -1};
  int free_cells = 0;
  each_around(point, reach, [&](const Cell& cell) {
    if (owner(cell) != free_cell) return true;
    ++free_cells;
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], cell[axis]);
      upper[axis] = std::max(upper[axis], cell[axis]);
    }
    return true;
  });
  return free_cells == (upper[0] - lower[0] + 1) * (upper[1] - lower[1] + 1) * (upper[2] - lower[2] + 1);
}

std::array<Vec3, 2> SolidUnion::free_box(const Vec3& point, double reach) const {
  const Cell centre = cells_of(point);
  if (owner(centre) != free_cell) return {point, point};
  std::array<Vec3, 2> largest{point, point};
  double most = -1;
  std::array<int, 3> order{0, 1, 2};
  // Grown along one axis after the other, in every order: a slab of cells is taken when all of it is free.
  do {
    Cell first = centre, last = centre;
    const auto free = [&](Cell from, Cell to) {
      Cell cell;
      for (cell[2] = from[2]; cell[2] <= to[2]; ++cell[2])
        for (cell[1] = from[1]; cell[1] <= to[1]; ++cell[1])
          for (cell[0] = from[0]; cell[0] <= to[0]; ++cell[0])
            if (owner(cell) != free_cell) return false;
      return true;
    };
    double volume = 1;
    std::array<Vec3, 2> box{Vec3{-far, -far, -far}, Vec3{far, far, far}};
    for (const int axis : order) {
      if (axis >= dimensions_) continue;
      Cell from = first, to = last;
      while (lower_of(axis, first[axis]) > point[axis] - reach) {
        from[axis] = to[axis] = first[axis] - 1;
        if (!free(from, to)) break;
        --first[axis];
      }
      from = first, to = last;
      while (upper_of(axis, last[axis]) < point[axis] + reach) {
        from[axis] = to[axis] = last[axis] + 1;
        if (!free(from, to)) break;
        ++last[axis];
      }
      const double lower = lower_of(axis, first[axis]), upper = upper_of(axis, last[axis]);
      if (lower > point[axis] - reach) box[0][axis] = lower;
      if (upper < point[axis] + reach) box[1][axis] = upper;
      volume *= std::min(upper, point[axis] + reach) - std::max(lower, point[axis] - reach);
    }
    if (volume > most + tolerance_ * reach * reach) {
      most = volume;
      largest = box;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return largest;
}

bool SolidUnion::clear_around(const Vec3& point, double reach) const {
  return each_around(point, reach, [&](const Cell& cell) { return owner(cell) == free_cell; });
}

bool SolidUnion::sees(const Vec3& i, const Vec3& to, const Vec3& at) const {
  Cell cell = cells_of(i);
  Vec3 start = i, end = to;  // of the ray, unfolded into the cell that it is in
  double length2 = 0;
  for (int axis = 0; axis < dimensions_; ++axis) length2 += (to[axis] - i[axis]) * (to[axis] - i[axis]);
  const double tie = tolerance_ / std::max(std::sqrt(length2), tolerance_);
  std::array<double, 3> next{2, 2, 2};  // share of the ray at which it meets the next plane along an axis
  const auto meet = [&](int axis) {
    const double d = end[axis] - start[axis];
    next[axis] = 2;
    if (d > 0 && cell[axis] < count_[axis] - 1) next[axis] = (upper_of(axis, cell[axis]) - start[axis]) / d;
    if (d < 0 && cell[axis] > 0) next[axis] = (lower_of(axis, cell[axis]) - start[axis]) / d;
  };
  for (int axis = 0; axis < dimensions_; ++axis) meet(axis);
  // Enough for four reflections in a gap of a quarter of the ray along each axis, and planes that are crossed freely.
  for (int crossed = 0; crossed < 1000; ++crossed) {
    const double first = *std::min_element(next.begin(), next.begin() + dimensions_);
    if (first >= 1) {
      double distance2 = 0;
      for (int a = 0; a < dimensions_; ++a) distance2 += (end[a] - at[a]) * (end[a] - at[a]);
      return distance2 < tolerance_ * tolerance_;
    }
    Cell step{};
    for (int axis = 0; axis < dimensions_; ++axis)
      if (next[axis] <= first + tie) step[axis] = end[axis] > start[axis] ? 1 : -1;
    const std::optional<unsigned> reflected = reflected_axes(cell, step);
    if (!reflected) return false;
    for (int axis = 0; axis < dimensions_; ++axis) {
      if (step[axis] == 0) continue;
      if ((*reflected >> axis & 1U) == 0) {
        cell[axis] += step[axis];
      } else {
        const double plane = step[axis] > 0 ? upper_of(axis, cell[axis]) : lower_of(axis, cell[axis]);
        start[axis] = 2 * plane - start[axis];
        end[axis] = 2 * plane - end[axis];
      }
      meet(axis);
    }
  }
  return false;
}

std::optional<unsigned> SolidUnion::reflected_in_any_order(const Cell& from, const Cell& step) const {
  std::array<int, 3> order{0, 1, 2};
  std::optional<unsigned> common;
  bool agree = true;
  do {
    Cell cell = from;
    unsigned reflected = 0;
    for (const int axis : order) {
      if (step[axis] == 0) continue;
      Cell beyond = cell;
      beyond[axis] += step[axis];
      if (owner(beyond) == free_cell)
        cell = beyond;
      else
        reflected |= 1U << axis;
    }
    if (reflected == 0) return reflected;
    agree = agree && reflected == common.value_or(reflected);
    common = reflected;
  } while (std::next_permutation(order.begin(), order.end()));
  return agree ? common : std::nullopt;
}

std::optional<unsigned> SolidUnion::reflected_axes(const Cell& from, const Cell& step) const {
  unsigned met = 0;
  Cell beyond = from;
  for (int axis = 0; axis < dimensions_; ++axis) {
    beyond[axis] += step[axis];
    if (step[axis] != 0) met |= 1U << axis;
  }
  if (std::has_single_bit(met)) return owner(beyond) == free_cell ? 0U : met;  // nearly every ray
  const std::optional<unsigned> reflected = reflected_in_any_order(from, step);
  if (!reflected || *reflected == 0) return reflected;
  Cell last = from, back = step;
  for (int axis = 0; axis < dimensions_; ++axis) {
    if (step[axis] == 0 || (*reflected >> axis & 1U) != 0) continue;
    last[axis] += step[axis];
    back[axis] = -step[axis];
  }
  return reflected_in_any_order(last, back) == reflected ? reflected : std::nullopt;
}

std::vector<double> SolidUnion::wetted_planes(int axis, const Vec3& lower, const Vec3& upper) const {
  std::vector<double> result;
  for (std::size_t plane = 0; plane < planes_[axis].size(); ++plane) {
    if (planes_[axis][plane] <= lower[axis] || planes_[axis][plane] >= upper[axis]) continue;
    Cell first{}, last{};
    for (int a = 0; a < dimensions_; ++a) {
      first[a] = cell_along(a, lower[a] + 2 * tolerance_);
      last[a] = cell_along(a, upper[a] - 2 * tolerance_);
    }
    first[axis] = last[axis] = static_cast<int>(plane);
    bool wetted = false;
    Cell cell;
    for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2])
      for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
        for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0]) {
          Cell beyond = cell;
          ++beyond[axis];
          wetted = wetted || (owner(cell) == free_cell) != (owner(beyond) == free_cell);
        }
    if (wetted) result.push_back(planes_[axis][plane]);
  }
  return result;
}

double SolidUnion::free_volume(const Vec3& lower, const Vec3& upper) const {
  Cell first{}, last{};
  for (int axis = 0; axis < dimensions_; ++axis) {
    first[axis] = cell_along(axis, lower[axis]);
    last[axis] = cell_along(axis, upper[axis]);
  }
  double sum = 0;
  Cell cell;
  for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2])
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
      for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0]) {
        if (owner(cell) != free_cell) continue;
        double volume = 1;
        for (int axis = 0; axis < dimensions_; ++axis)
          volume *= std::max(0.0, std::min(upper[axis], upper_of(axis, cell[axis])) -
                                      std::max(lower[axis], lower_of(axis, cell[axis])));
        sum += volume;
      }
  return sum;
}

int SolidUnion::face_near(const Vec3& point, int axis, std::size_t plane, double reach) const {
  const double distance = point[axis] - planes_[axis][plane];
  // A point in the plane of a face lies beside it: reflected, it would be seen where it is.
  if (std::abs(distance) >= reach || std::abs(distance) <= tolerance_) return -1;
  const bool above = distance > 0;  // the point lies above the plane: the solid below it
  Cell first{}, last{};
  for (int a = 0; a < dimensions_; ++a) {
    if (a == axis) continue;
    first[a] = cell_along(a, point[a] - reach);
    last[a] = cell_along(a, point[a] + reach);
  }
  const int below_plane = static_cast<int>(plane);
  double least2 = reach * reach;
  int code = -1;
  Cell cell;
  first[axis] = last[axis] = above ? below_plane : below_plane + 1;
  for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2])
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
      for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0]) {
        Cell before = cell;
        before[axis] += above ? 1 : -1;
        const std::int32_t solid = owner(cell);
        if (solid == free_cell || owner(before) != free_cell) continue;
        double distance2 = distance * distance;
        for (int a = 0; a < dimensions_; ++a) {
          if (a == axis) continue;
          const double outside = std::max({lower_of(a, cell[a]) - point[a], point[a] - upper_of(a, cell[a]), 0.0});
          distance2 += outside * outside;
        }
        if (distance2 >= least2) continue;
        least2 = distance2;
        code = solid == outside_lower   ? 0
               : solid == outside_upper ? 1
                                        : 2 + 2 * static_cast<int>(solid) + (above ? 1 : 0);
      }
  return code;
}

}  // namespace spume
