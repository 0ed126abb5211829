// SPDX-License-Identifier: MIT
// Box, half-space and extruded outline.
#include <algorithm>
#include <cmath>
#include <string>

#include "polygon.hpp"
#include "spume/core/error.hpp"
#include "spume/core/vectors.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume {
namespace {

class Box final : public Shape {
 public:
  Box(const Vec3& size, int dimensions) : half_(multiply(0.5, size)), count_(static_cast<std::size_t>(dimensions)) {}
  NearestPoint nearest(const Vec3& p) const override {
    NearestPoint found;
    double squared = 0, deepest = -infinite;
    std::size_t axis = 0;
    for (std::size_t a = 0; a < count_; ++a) {
      const double beyond = std::abs(p[a]) - half_[a];
      found.point[a] = std::clamp(p[a], -half_[a], half_[a]);
      if (beyond > deepest) {
        deepest = beyond;
        axis = a;
      }
      if (beyond > 0) {
        squared += beyond * beyond;
        found.normal[a] = std::copysign(beyond, p[a]);
      }
    }
    if (squared > 0) {
      found.distance = std::sqrt(squared);
      found.normal = unit(found.normal);
      return found;
    }
    found.distance = deepest;
    found.normal[axis] = std::copysign(1.0, p[axis]);
    found.point[axis] = std::copysign(half_[axis], p[axis]);
    return found;
  }
  Bounds bounds() const override {
    const Vec3 upper{half_[0], half_[1], count_ == 3 ? half_[2] : 0};
    return {multiply(-1, upper), upper};
  }
  double volume() const override {
    double volume = 1;
    for (std::size_t a = 0; a < count_; ++a) volume *= 2 * half_[a];
    return volume;
  }
  TriangleSurface surface(const Bounds&, double) const override {
    if (count_ == 2)
      return fill_polygon({{-half_[0], -half_[1]}, {half_[0], -half_[1]}, {half_[0], half_[1]}, {-half_[0], half_[1]}});
    return extrude({{-half_[0], -half_[2]}, {half_[0], -half_[2]}, {half_[0], half_[2]}, {-half_[0], half_[2]}},
                   -half_[1], half_[1]);
  }

 private:
  Vec3 half_;
  std::size_t count_;
};

class HalfSpace final : public Shape {
 public:
  HalfSpace(const Vec3& normal, int dimensions) : normal_(unit(normal, dimensions)), dimensions_(dimensions) {}
  NearestPoint nearest(const Vec3& p) const override {
    const double distance = dot(normal_, p);
    return {distance, normal_, subtract(p, multiply(distance, normal_))};
  }
  double distance(const Vec3& p) const override { return dot(normal_, p); }
  Bounds bounds() const override {
    Bounds bounds{{-infinite, -infinite, -infinite}, {infinite, infinite, infinite}};
    if (dimensions_ == 2) bounds.lower[2] = bounds.upper[2] = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions_); ++a) {
      if (normal_[a] == 1) bounds.upper[a] = 0;
      if (normal_[a] == -1) bounds.lower[a] = 0;
    }
    return bounds;
  }
  double volume() const override { return infinite; }
  // The face as far as the window; in two dimensions what of the window lies behind it.
  TriangleSurface surface(const Bounds& window, double) const override {
    const double far = 2 * (length(subtract(window.upper, window.lower)) + length(window.lower));
    Vec3 across{};
    across[std::abs(normal_[0]) < 0.5 ? 0 : 1] = 1;
    if (dimensions_ == 2) across = {-normal_[1], normal_[0], 0};
    const Vec3 u = multiply(far, unit(subtract(across, multiply(dot(across, normal_), normal_))));
    if (dimensions_ == 2) {
      const Vec3 down = multiply(-2 * far, normal_);
      return fan(clip({u, add(u, down), subtract(down, u), multiply(-1, u)}, window));
    }
    const Vec3 v = cross(normal_, u);
    return fan(clip({add(u, v), subtract(v, u), multiply(-1, add(u, v)), subtract(u, v)}, window));
  }

 private:
  Vec3 normal_;
  int dimensions_;
};

class Outline final : public Shape {
 public:
  Outline(std::vector<Point2> points, std::optional<double> length, int dimensions)
      : polygon_(std::move(points)), half_(length ? 0.5 * *length : infinite), dimensions_(dimensions) {}
  NearestPoint nearest(const Vec3& p) const override {
    const std::size_t up = dimensions_ == 3 ? 2 : 1;
    const NearestPoint2 flat = polygon_.nearest({p[0], p[up]});
    NearestPoint found{flat.distance, {}, p};
    const auto take = [&](const Point2& values, Vec3& target) {
      target[0] = values[0];
      target[up] = values[1];
    };
    const double beyond = dimensions_ == 3 ? std::abs(p[1]) - half_ : -infinite;
    if (beyond <= 0 && beyond <= flat.distance) {
      take(flat.normal, found.normal);
      take(flat.point, found.point);
    } else if (beyond > 0 && flat.distance > 0) {
      take(flat.point, found.point);
      found.point[1] = std::copysign(half_, p[1]);
      found.distance = std::hypot(flat.distance, beyond);
      take({flat.normal[0] * flat.distance, flat.normal[1] * flat.distance}, found.normal);
      found.normal[1] = std::copysign(beyond, p[1]);
      found.normal = unit(found.normal);
    } else {
      found.point[1] = std::copysign(half_, p[1]);
      found.distance = beyond;
      found.normal[1] = std::copysign(1.0, p[1]);
    }
    return found;
  }
  Bounds bounds() const override {
    Point2 lower = polygon_.points()[0], upper = lower;
    for (const Point2& p : polygon_.points())
      for (std::size_t a = 0; a < 2; ++a) {
        lower[a] = std::min(lower[a], p[a]);
        upper[a] = std::max(upper[a], p[a]);
      }
    if (dimensions_ == 2) return {{lower[0], lower[1], 0}, {upper[0], upper[1], 0}};
    return {{lower[0], -half_, lower[1]}, {upper[0], half_, upper[1]}};
  }
  double volume() const override { return polygon_.area() * (dimensions_ == 3 ? 2 * half_ : 1); }
  TriangleSurface surface(const Bounds& window, double) const override {
    if (dimensions_ == 2) return fill_polygon(polygon_.points());
    return extrude(polygon_.points(), std::isfinite(half_) ? -half_ : window.lower[1],
                   std::isfinite(half_) ? half_ : window.upper[1]);
  }

 private:
  Polygon polygon_;
  double half_;
  int dimensions_;
};

std::string text_of(const Point2& p) {
  char text[64];
  std::snprintf(text, sizeof text, "[%.6g, %.6g]", p[0], p[1]);
  return text;
}

bool on_side(const Point2& a, const Point2& b, const Point2& p) {
  return turn(a, b, p) == 0 && (p[0] - a[0]) * (p[0] - b[0]) + (p[1] - a[1]) * (p[1] - b[1]) <= 0;
}

bool sides_meet(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const auto sign = [](double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; };
  const int abc = sign(turn(a, b, c)), abd = sign(turn(a, b, d)), cda = sign(turn(c, d, a)), cdb = sign(turn(c, d, b));
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return on_side(a, b, c) || on_side(a, b, d) || on_side(c, d, a) || on_side(c, d, b);
}

void check_outline(const std::vector<Point2>& points) {
  const std::size_t n = points.size();
  if (n < 3) throw InputError("an outline needs at least 3 points, found " + std::to_string(n));
  // Every pair of sides is looked at.
  constexpr std::size_t most = 20000;
  if (n > most)
    throw InputError("an outline has at most 20000 points, found " + std::to_string(n) + "; use a mesh for more");
  const auto side = [&](std::size_t i) {
    return "the side from point " + std::to_string(i + 1) + ", " + text_of(points[i]) + ", to " +
           text_of(points[(i + 1) % n]);
  };
  for (std::size_t i = 0; i < n; ++i)
    if (points[i] == points[(i + 1) % n])
      throw InputError("points " + std::to_string(i + 1) + " and " + std::to_string((i + 1) % n + 1) +
                       " are the same, " + text_of(points[i]) + "; the outline closes by itself: remove one");
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 &a = points[i], &b = points[(i + 1) % n], &next = points[(i + 2) % n];
    if (turn(a, b, next) == 0 && (b[0] - a[0]) * (next[0] - b[0]) + (b[1] - a[1]) * (next[1] - b[1]) < 0)
      throw InputError(side(i) + " runs back on itself; order the points around the area");
    for (std::size_t k = i + 2; k < n; ++k) {
      if (i == 0 && k == n - 1) continue;
      if (sides_meet(a, b, points[k], points[(k + 1) % n]))
        throw InputError(side(i) + " meets " + side(k) + "; order the points around the area");
    }
  }
}

}  // namespace

ShapePointer make_box(const Vec3& size, int dimensions) {
  return std::make_shared<Box>(size, dimensions);
}

ShapePointer make_half_space(const Vec3& normal, int dimensions) {
  return std::make_shared<HalfSpace>(normal, dimensions);
}

ShapePointer make_outline(const std::vector<Point2>& given, std::optional<double> length, int dimensions) {
  check_outline(given);
  std::vector<Point2> points = given;
  if (area_of(points) < 0) std::reverse(points.begin(), points.end());
  return std::make_shared<Outline>(std::move(points), length, dimensions);
}

}  // namespace spume
