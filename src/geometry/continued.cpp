// SPDX-License-Identifier: MIT
// A shape of one period that goes on without end.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "spume/core/vectors.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume {
namespace {

// What lies on one side of a plane across an axis: below it with the sign 1, above it with -1. Triangles that share an
// edge share the point where it is cut.
class SurfaceCut {
 public:
  SurfaceCut(const TriangleSurface& whole, std::size_t axis, double plane, double sign)
      : whole_(whole), axis_(axis), plane_(plane), sign_(sign), number_(whole.points.size(), -1) {
    for (const auto& triangle : whole.triangles) cut(triangle);
  }
  TriangleSurface take() { return std::move(kept_); }

 private:
  const Vec3& point(std::int32_t i) const { return whole_.points[static_cast<std::size_t>(i)]; }
  double beyond(std::int32_t i) const { return sign_ * (point(i)[axis_] - plane_); }

  void cut(const std::array<std::int32_t, 3>& triangle) {
    std::vector<std::int32_t> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t from = triangle[k], to = triangle[(k + 1) % 3];
      if (beyond(from) <= 0) corners.push_back(keep(from));
      if ((beyond(from) < 0 && beyond(to) > 0) || (beyond(from) > 0 && beyond(to) < 0))
        corners.push_back(between(std::min(from, to), std::max(from, to)));
    }
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      kept_.triangles.push_back({corners[0], corners[k], corners[k + 1]});
  }

  std::int32_t add_point(const Vec3& place) {
    kept_.points.push_back(place);
    return static_cast<std::int32_t>(kept_.points.size()) - 1;
  }

  std::int32_t keep(std::int32_t i) {
    std::int32_t& number = number_[static_cast<std::size_t>(i)];
    if (number < 0) number = add_point(point(i));
    return number;
  }

  std::int32_t between(std::int32_t a, std::int32_t b) {
    const auto [entry, fresh] = cuts_.try_emplace({a, b}, 0);
    if (fresh) {
      const double share = beyond(a) / (beyond(a) - beyond(b));
      Vec3 place = add(multiply(1 - share, point(a)), multiply(share, point(b)));
      place[axis_] = plane_;
      entry->second = add_point(place);
    }
    return entry->second;
  }

  const TriangleSurface& whole_;
  std::size_t axis_;
  double plane_, sign_;
  std::vector<std::int32_t> number_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> cuts_;
  TriangleSurface kept_;
};

class Continued final : public Shape {
 public:
  Continued(ShapePointer shape, const Vec3& lower, const Vec3& periods)
      : shape_(std::move(shape)), lower_(lower), periods_(periods) {}

  NearestPoint nearest(const Vec3& p) const override {
    const Vec3 shift = to_period(p);
    NearestPoint found = shape_->nearest(subtract(p, shift));
    found.point = add(found.point, shift);
    return found;
  }
  double distance(const Vec3& p) const override { return shape_->distance(subtract(p, to_period(p))); }
  Bounds bounds() const override { return without_end(shape_->bounds()); }
  Bounds extent() const override { return without_end(shape_->extent()); }
  double volume() const override { return infinite; }
  double error() const override { return shape_->error(); }

  TriangleSurface surface(const Bounds& window, double step) const override {
    Bounds period = window;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (periods_[axis] != 0) {
        period.lower[axis] = lower_[axis];
        period.upper[axis] = lower_[axis] + periods_[axis];
      }
    TriangleSurface surface = shape_->surface(period, step);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (periods_[axis] == 0) continue;
      surface = SurfaceCut(surface, axis, period.upper[axis], 1).take();
      surface = SurfaceCut(surface, axis, period.lower[axis], -1).take();
      surface = copied(surface, axis, window);
    }
    return surface;
  }

 private:
  Vec3 to_period(const Vec3& p) const {
    Vec3 shift{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (periods_[axis] != 0) shift[axis] = periods_[axis] * std::floor((p[axis] - lower_[axis]) / periods_[axis]);
    return shift;
  }

  Bounds without_end(Bounds bounds) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (periods_[axis] != 0) {
        bounds.lower[axis] = -infinite;
        bounds.upper[axis] = infinite;
      }
    return bounds;
  }

  // As often as periods begin in the window, but for the rounding of its ends.
  TriangleSurface copied(const TriangleSurface& one, std::size_t axis, const Bounds& window) const {
    constexpr double rounding = 1e-9;
    const auto periods_to = [&](double place) { return (place - lower_[axis]) / periods_[axis]; };
    const double first = std::floor(periods_to(window.lower[axis]) + rounding);
    const double end = std::ceil(periods_to(window.upper[axis]) - rounding);
    TriangleSurface all;
    for (double n = first; n < end; ++n) {
      const auto before = static_cast<std::int32_t>(all.points.size());
      for (Vec3 p : one.points) {
        p[axis] += n * periods_[axis];
        all.points.push_back(p);
      }
      for (const auto& [a, b, c] : one.triangles) all.triangles.push_back({before + a, before + b, before + c});
    }
    return all;
  }

  ShapePointer shape_;
  Vec3 lower_, periods_;
};

}  // namespace

ShapePointer continue_periodically(ShapePointer shape, const Vec3& lower, const Vec3& periods) {
  return std::make_shared<Continued>(std::move(shape), lower, periods);
}

}  // namespace spume
