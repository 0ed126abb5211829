// SPDX-License-Identifier: MIT
// What shapes make together. Of many parts those are asked that the extents do not rule out: found for each cell of a
// grid at the start, and while a point asks.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "spume/core/vectors.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume {
namespace {

// Fewer parts are asked as fast one by one.
constexpr std::size_t least_for_cells = 8;
// Of an even bed each part has eight: what may be nearest in a cell are then a few. Each cell is rounded up along
// three axes at most, so that there are less than eight times as many as asked for.
constexpr double cells_per_part = 8, most_cells = 32768;

double squared_outside(const Bounds& extent, const Vec3& point) {
  double outside2 = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double outside = std::max({extent.lower[axis] - point[axis], point[axis] - extent.upper[axis], 0.0});
    outside2 += outside * outside;
  }
  return outside2;
}

}  // namespace

Combination::Combination(std::vector<CombinedPart> parts) : parts_(std::move(parts)) {
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    extents_.push_back(parts_[k].shape->extent());
    all_.push_back(static_cast<std::int32_t>(k));
  }
  const bool exact = std::all_of(parts_.begin(), parts_.end(),
                                 [](const CombinedPart& part) { return !part.subtract && part.shape->error() == 0; });
  if (exact && parts_.size() >= least_for_cells) make_cells();
}

// A point of a cell is as far from a part as the middle of the cell, within half a diagonal: what is farther from the
// middle than the nearest part by a whole one is not the nearest.
void Combination::make_cells() {
  Bounds around{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
  for (const Bounds& extent : extents_)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (std::isfinite(extent.upper[axis] - extent.lower[axis])) {
        around.lower[axis] = std::min(around.lower[axis], extent.lower[axis]);
        around.upper[axis] = std::max(around.upper[axis], extent.upper[axis]);
      }
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(around.upper[axis] >= around.lower[axis])) return;  // all parts are endless along it
  const double cells = std::min(most_cells, cells_per_part * static_cast<double>(parts_.size()));
  // An axis along which they are shorter than a cell is one cell long and leaves all to the others.
  double size = 0;
  for (int axes = 3; axes > 0 && size == 0; --axes) {
    std::array<double, 3> length{};
    for (std::size_t axis = 0; axis < 3; ++axis) length[axis] = around.upper[axis] - around.lower[axis];
    std::sort(length.begin(), length.end(), std::greater<>());
    double volume = 1;
    for (int axis = 0; axis < axes; ++axis) volume *= length[static_cast<std::size_t>(axis)];
    const double edge = std::pow(volume / cells, 1.0 / axes);
    if (edge > 0 && length[static_cast<std::size_t>(axes) - 1] >= edge) size = edge;
  }
  if (size == 0) return;
  double diagonal2 = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = around.upper[axis] - around.lower[axis];
    count_[axis] = static_cast<std::size_t>(std::max(1.0, std::ceil(length / size)));
    width_[axis] = length / static_cast<double>(count_[axis]);
    diagonal2 += width_[axis] * width_[axis];
  }
  lower_ = around.lower;
  begin_.push_back(0);
  for (std::size_t cell = 0; cell < count_[0] * count_[1] * count_[2]; ++cell) {
    const std::array<std::size_t, 3> at{cell % count_[0], cell / count_[0] % count_[1], cell / count_[0] / count_[1]};
    Vec3 middle{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      middle[axis] = lower_[axis] + width_[axis] * (static_cast<double>(at[axis]) + 0.5);
    const double nearest = distance_of(all_, middle), far = std::max(nearest, 0.0) + 1.001 * std::sqrt(diagonal2);
    for (const std::int32_t k : all_)
      if (squared_outside(extents_[static_cast<std::size_t>(k)], middle) <= far * far) candidates_.push_back(k);
    begin_.push_back(static_cast<std::int32_t>(candidates_.size()));
  }
}

std::span<const std::int32_t> Combination::candidates(const Vec3& point) const {
  if (begin_.empty()) return all_;
  std::array<std::size_t, 3> at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (width_[axis] == 0 && point[axis] == lower_[axis]) continue;
    const double along = (point[axis] - lower_[axis]) / width_[axis];
    if (!(along >= 0 && along < static_cast<double>(count_[axis]))) return all_;
    at[axis] = static_cast<std::size_t>(along);
  }
  const std::size_t cell = at[0] + count_[0] * (at[1] + count_[1] * at[2]);
  const auto first = static_cast<std::size_t>(begin_[cell]), last = static_cast<std::size_t>(begin_[cell + 1]);
  return std::span(candidates_).subspan(first, last - first);
}

bool Combination::may_change(std::size_t part, const Vec3& point, double distance) const {
  const double outside2 = squared_outside(extents_[part], point);
  const bool settled = parts_[part].subtract ? distance >= 0 : distance <= 0;
  return outside2 == 0 || !(settled || outside2 >= distance * distance);
}

NearestPoint Combination::nearest(const Vec3& point) const {
  NearestPoint best{infinite, {0, 0, 0}, point};
  for (const std::int32_t number : candidates(point)) {
    const auto k = static_cast<std::size_t>(number);
    if (!may_change(k, point, best.distance)) continue;
    const CombinedPart& part = parts_[k];
    NearestPoint next = part.shape->nearest(point);
    if (part.subtract) {
      next.distance = -next.distance;
      next.normal = multiply(-1, next.normal);
    }
    if (part.subtract ? next.distance > best.distance : next.distance < best.distance) best = next;
  }
  return best;
}

double Combination::distance(const Vec3& point) const {
  return distance_of(candidates(point), point);
}

double Combination::distance_of(std::span<const std::int32_t> parts, const Vec3& point) const {
  double best = infinite;
  for (const std::int32_t number : parts) {
    const auto k = static_cast<std::size_t>(number);
    if (!may_change(k, point, best)) continue;
    const double next = parts_[k].shape->distance(point);
    best = parts_[k].subtract ? std::max(best, -next) : std::min(best, next);
  }
  return best;
}

}  // namespace spume
