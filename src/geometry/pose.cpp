// SPDX-License-Identifier: MIT
// Where shapes stand, turned inside out or not, and their copies.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "spume/core/vectors.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume {
namespace {

Vec3 turned(const std::array<Vec3, 3>& rotation, const Vec3& p) {
  return {dot(rotation[0], p), dot(rotation[1], p), dot(rotation[2], p)};
}

std::array<Vec3, 3> transposed(const std::array<Vec3, 3>& m) {
  return {Vec3{m[0][0], m[1][0], m[2][0]}, Vec3{m[0][1], m[1][1], m[2][1]}, Vec3{m[0][2], m[1][2], m[2][2]}};
}

// The box around a turned box; entries of a rotation below 1e-15 are rounding and turn no infinite side.
Bounds turned(const std::array<Vec3, 3>& rotation, const Bounds& bounds, double scale) {
  Bounds result;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t a = 0; a < 3; ++a) {
      const double entry = rotation[i][a];
      if (std::abs(entry) < 1e-15) continue;
      const auto part = [&](double side) { return side == 0 ? 0 : scale * entry * side; };
      result.lower[i] += std::min(part(bounds.lower[a]), part(bounds.upper[a]));
      result.upper[i] += std::max(part(bounds.lower[a]), part(bounds.upper[a]));
    }
  return result;
}

class Placed final : public Shape {
 public:
  Placed(ShapePointer shape, const Pose& pose, bool inside, int dimensions)
      : shape_(std::move(shape)),
        pose_(pose),
        back_(transposed(pose.rotation)),
        inside_(inside),
        dimensions_(dimensions) {}

  NearestPoint nearest(const Vec3& p) const override {
    const NearestPoint own = shape_->nearest(own_point(p));
    const double sign = inside_ ? 1 : -1;
    return {sign * pose_.scale * own.distance, multiply(sign, turned(pose_.rotation, own.normal)), placed(own.point)};
  }
  double distance(const Vec3& p) const override {
    return (inside_ ? 1 : -1) * pose_.scale * shape_->distance(own_point(p));
  }
  Bounds bounds() const override { return placed(shape_->bounds()); }
  Bounds extent() const override { return placed(shape_->extent()); }
  double volume() const override { return inside_ ? shape_->volume() * std::pow(pose_.scale, dimensions_) : infinite; }
  double error() const override { return pose_.scale * shape_->error(); }
  TriangleSurface surface(const Bounds& window, double step) const override {
    const Bounds moved{subtract(window.lower, pose_.position), subtract(window.upper, pose_.position)};
    TriangleSurface surface = shape_->surface(turned(back_, moved, 1 / pose_.scale), step / pose_.scale);
    for (Vec3& p : surface.points) p = placed(p);
    if (!inside_ && dimensions_ == 3)
      for (auto& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
    return surface;
  }

 private:
  Vec3 own_point(const Vec3& p) const { return multiply(1 / pose_.scale, turned(back_, subtract(p, pose_.position))); }
  Bounds placed(const Bounds& own) const {
    if (!inside_) {
      const double z = dimensions_ == 3 ? infinite : 0;
      return {{-infinite, -infinite, -z}, {infinite, infinite, z}};
    }
    Bounds bounds = turned(pose_.rotation, own, pose_.scale);
    bounds.lower = add(bounds.lower, pose_.position);
    bounds.upper = add(bounds.upper, pose_.position);
    return bounds;
  }
  Vec3 placed(const Vec3& p) const { return add(pose_.position, multiply(pose_.scale, turned(pose_.rotation, p))); }

  ShapePointer shape_;
  Pose pose_;
  std::array<Vec3, 3> back_;
  bool inside_;
  int dimensions_;
};

class Repeated final : public Shape {
 public:
  Repeated(ShapePointer shape, std::vector<Vec3> shifts) : shape_(std::move(shape)), shifts_(std::move(shifts)) {}

  NearestPoint nearest(const Vec3& p) const override {
    NearestPoint best = shape_->nearest(p);
    for (const Vec3& shift : shifts_) {
      NearestPoint other = shape_->nearest(subtract(p, shift));
      if (other.distance >= best.distance) continue;
      best = other;
      best.point = add(best.point, shift);
    }
    return best;
  }
  double distance(const Vec3& p) const override {
    double least = shape_->distance(p);
    for (const Vec3& shift : shifts_) least = std::min(least, shape_->distance(subtract(p, shift)));
    return least;
  }
  Bounds bounds() const override { return shape_->bounds(); }
  Bounds extent() const override {
    const Bounds own = shape_->extent();
    Bounds all = own;
    for (const Vec3& shift : shifts_)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        all.lower[axis] = std::min(all.lower[axis], own.lower[axis] + shift[axis]);
        all.upper[axis] = std::max(all.upper[axis], own.upper[axis] + shift[axis]);
      }
    return all;
  }
  double volume() const override { return shape_->volume(); }
  double error() const override { return shape_->error(); }
  TriangleSurface surface(const Bounds& window, double step) const override { return shape_->surface(window, step); }

 private:
  ShapePointer shape_;
  std::vector<Vec3> shifts_;
};

}  // namespace

std::array<Vec3, 3> rotation_by(const Vec3& degrees) {
  std::array<Vec3, 3> total{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Multiples of 90 degrees turn axes into axes exactly.
    const double quarter = degrees[axis] / 90;
    const double angle = degrees[axis] * std::numbers::pi / 180;
    double c = std::cos(angle), s = std::sin(angle);
    if (quarter == std::round(quarter)) {
      c = std::round(c);
      s = std::round(s);
    }
    const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
    std::array<Vec3, 3> next = total;
    next[i] = subtract(multiply(c, total[i]), multiply(s, total[j]));
    next[j] = add(multiply(s, total[i]), multiply(c, total[j]));
    total = next;
  }
  return total;
}

Vec3 to_own_coordinates(const Pose& pose, const Vec3& point) {
  return multiply(1 / pose.scale, turned(transposed(pose.rotation), subtract(point, pose.position)));
}

ShapePointer place(ShapePointer shape, const Pose& pose, bool inside, int dimensions) {
  return std::make_shared<Placed>(std::move(shape), pose, inside, dimensions);
}

ShapePointer repeat(ShapePointer shape, const Bounds& window, const Vec3& periods) {
  const Bounds bounds = shape->bounds();
  std::vector<Vec3> shifts{{}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // A shape without end along an axis is its own copy there.
    if (periods[axis] == 0 || !std::isfinite(bounds.upper[axis] - bounds.lower[axis])) continue;
    const std::size_t before = shifts.size();
    for (const double period : {-periods[axis], periods[axis]}) {
      if (bounds.lower[axis] + period >= window.upper[axis] || bounds.upper[axis] + period <= window.lower[axis])
        continue;
      for (std::size_t k = 0; k < before; ++k) {
        Vec3 shift = shifts[k];
        shift[axis] += period;
        shifts.push_back(shift);
      }
    }
  }
  if (shifts.size() == 1) return shape;
  shifts.erase(shifts.begin());
  return std::make_shared<Repeated>(std::move(shape), std::move(shifts));
}

}  // namespace spume
