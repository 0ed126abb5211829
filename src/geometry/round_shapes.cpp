// SPDX-License-Identifier: MIT
// Ball, ellipsoid, capsule, cylinder and cone.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "polygon.hpp"
#include "spume/core/vectors.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume {
namespace {

constexpr double pi = std::numbers::pi;

// Facets from pole to pole.
int facets_down(int around) {
  return around / 2;
}

TriangleSurface from_profile(const std::vector<Point2>& profile, int facets, int dimensions) {
  return dimensions == 3 ? revolve(profile, facets) : fill_profile(profile);
}

NearestPoint from_centre(const Vec3& centre, double radius, const Vec3& point, int dimensions) {
  const Vec3 away = subtract(point, centre);
  const Vec3 normal = unit(away, dimensions);
  return {length(away) - radius, normal, add(centre, multiply(radius, normal))};
}

class Ball final : public Shape {
 public:
  Ball(double radius, int dimensions) : radius_(radius), dimensions_(dimensions) {}
  NearestPoint nearest(const Vec3& p) const override { return from_centre({}, radius_, p, dimensions_); }
  double distance(const Vec3& p) const override { return length(p) - radius_; }
  Bounds bounds() const override {
    const double z = dimensions_ == 3 ? radius_ : 0;
    return {{-radius_, -radius_, -z}, {radius_, radius_, z}};
  }
  double volume() const override {
    return dimensions_ == 3 ? 4 * pi / 3 * radius_ * radius_ * radius_ : pi * radius_ * radius_;
  }
  TriangleSurface surface(const Bounds&, double step) const override {
    const int facets = facets_around(radius_, step);
    std::vector<Point2> profile;
    add_arc(profile, radius_, 0, 0, pi, facets_down(facets));
    return from_profile(profile, facets, dimensions_);
  }

 private:
  double radius_;
  int dimensions_;
};

// All within a radius of a piece of the last axis.
class Capsule final : public Shape {
 public:
  Capsule(double radius, double length, int dimensions)
      : radius_(radius), half_(0.5 * length), up_(static_cast<std::size_t>(dimensions) - 1) {}
  NearestPoint nearest(const Vec3& p) const override {
    Vec3 centre{};
    centre[up_] = std::clamp(p[up_], -half_, half_);
    NearestPoint found = from_centre(centre, radius_, p, 3);
    // On the axis between the caps every direction across it is as good.
    if (p == centre && std::abs(p[up_]) < half_) {
      found.normal = {1, 0, 0};
      found.point = add(centre, {radius_, 0, 0});
    } else if (p == centre) {
      found.normal = {};
      found.normal[up_] = p[up_] < 0 ? -1 : 1;
      found.point = add(centre, multiply(radius_, found.normal));
    }
    return found;
  }
  Bounds bounds() const override {
    Vec3 upper{radius_, up_ == 2 ? radius_ : 0, 0};
    upper[up_] = half_ + radius_;
    return {multiply(-1, upper), upper};
  }
  double volume() const override {
    const double circle = pi * radius_ * radius_;
    return up_ == 2 ? circle * (2 * half_ + 4.0 / 3 * radius_) : circle + 4 * half_ * radius_;
  }
  TriangleSurface surface(const Bounds&, double step) const override {
    const int facets = facets_around(radius_, step);
    std::vector<Point2> profile;
    add_arc(profile, radius_, half_, 0, 0.5 * pi, facets_down(facets) / 2);
    add_arc(profile, radius_, -half_, 0.5 * pi, pi, facets_down(facets) / 2);
    return from_profile(profile, facets, up_ == 2 ? 3 : 2);
  }

 private:
  double radius_, half_;
  std::size_t up_;
};

class EndlessCylinder final : public Shape {
 public:
  explicit EndlessCylinder(double radius) : radius_(radius) {}
  NearestPoint nearest(const Vec3& p) const override {
    const double away = std::hypot(p[0], p[1]);
    const Vec3 normal = away > 0 ? Vec3{p[0] / away, p[1] / away, 0} : Vec3{1, 0, 0};
    return {away - radius_, normal, {radius_ * normal[0], radius_ * normal[1], p[2]}};
  }
  Bounds bounds() const override { return {{-radius_, -radius_, -infinite}, {radius_, radius_, infinite}}; }
  double volume() const override { return infinite; }
  TriangleSurface surface(const Bounds& window, double step) const override {
    return revolve({{radius_, window.upper[2]}, {radius_, window.lower[2]}}, facets_around(radius_, step));
  }

 private:
  double radius_;
};

// Cone, frustum and cylinder: a trapezium, which in three dimensions turns around its axis.
class Frustum final : public Shape {
 public:
  Frustum(double radius, double top_radius, double length, int dimensions)
      : radius_(radius),
        top_radius_(top_radius),
        length_(length),
        dimensions_(dimensions),
        section_(top_radius > 0
                     ? std::vector<Point2>{{-radius, -0.5 * length},
                                           {radius, -0.5 * length},
                                           {top_radius, 0.5 * length},
                                           {-top_radius, 0.5 * length}}
                     : std::vector<Point2>{{-radius, -0.5 * length}, {radius, -0.5 * length}, {0, 0.5 * length}}) {}

  NearestPoint nearest(const Vec3& p) const override {
    if (dimensions_ == 2) {
      const NearestPoint2 found = section_.nearest({p[0], p[1]});
      return {found.distance, {found.normal[0], found.normal[1], 0}, {found.point[0], found.point[1], 0}};
    }
    const double away = std::hypot(p[0], p[1]);
    const double x = away > 0 ? p[0] / away : 1, y = away > 0 ? p[1] / away : 0;
    const NearestPoint2 found = section_.nearest({away, p[2]});
    return {found.distance,
            {found.normal[0] * x, found.normal[0] * y, found.normal[1]},
            {found.point[0] * x, found.point[0] * y, found.point[1]}};
  }
  Bounds bounds() const override {
    const double across = std::max(radius_, top_radius_);
    if (dimensions_ == 2) return {{-across, -0.5 * length_, 0}, {across, 0.5 * length_, 0}};
    return {{-across, -across, -0.5 * length_}, {across, across, 0.5 * length_}};
  }
  double volume() const override {
    if (dimensions_ == 2) return (radius_ + top_radius_) * length_;
    return pi / 3 * length_ * (radius_ * radius_ + radius_ * top_radius_ + top_radius_ * top_radius_);
  }
  TriangleSurface surface(const Bounds&, double step) const override {
    std::vector<Point2> profile{{0, 0.5 * length_}, {radius_, -0.5 * length_}, {0, -0.5 * length_}};
    if (top_radius_ > 0) profile.insert(profile.begin() + 1, {top_radius_, 0.5 * length_});
    return from_profile(profile, facets_around(std::max(radius_, top_radius_), step), dimensions_);
  }

 private:
  double radius_, top_radius_, length_;
  int dimensions_;
  Polygon section_;
};

class Ellipsoid final : public Shape {
 public:
  Ellipsoid(const Vec3& semi_axes, int dimensions)
      : axes_(semi_axes), count_(static_cast<std::size_t>(dimensions)), shortest_(0) {
    for (std::size_t a = 0; a < count_; ++a)
      if (axes_[a] < axes_[shortest_]) shortest_ = a;
  }

  // The nearest point is x_i = e_i^2 y_i / (s + e_i^2 - e_min^2), where s > 0 is the root of
  // F(s) = sum (e_i y_i / (s + e_i^2 - e_min^2))^2 - 1, which falls and is convex: from the left Newton's steps only
  // rise. Without a root, for points on the middle plane near the centre, s is 0 and the shortest axis makes up the
  // rest.
  NearestPoint nearest(const Vec3& p) const override {
    const double least = axes_[shortest_];
    Vec3 y{}, gap{};
    double s = 0, level = -1;
    for (std::size_t a = 0; a < count_; ++a) {
      y[a] = std::abs(p[a]);
      gap[a] = (axes_[a] - least) * (axes_[a] + least);  // exactly 0 for the shortest
      s = std::max(s, axes_[a] * y[a] - gap[a]);
      level += (y[a] / axes_[a]) * (y[a] / axes_[a]);
    }
    const auto value_at = [&](double at, double& slope) {
      double value = -1;
      slope = 0;
      for (std::size_t a = 0; a < count_; ++a) {
        if (y[a] == 0) continue;
        const double below = at + gap[a], term = axes_[a] * y[a] / below;
        value += term * term;
        slope -= 2 * term * term / below;
      }
      return value;
    };
    Vec3 x{};
    double slope = 0;
    const bool rooted = s > 0 || value_at(0, slope) > 0;
    for (int i = 0; rooted && i < 100; ++i) {
      const double value = value_at(s, slope);
      const double next = s - value / slope;
      if (!(next > s)) break;
      s = next;
    }
    double rest = 1;
    for (std::size_t a = 0; a < count_; ++a) {
      if (y[a] == 0 || (!rooted && gap[a] == 0)) continue;
      x[a] = axes_[a] * axes_[a] * y[a] / (s + gap[a]);
      rest -= (x[a] / axes_[a]) * (x[a] / axes_[a]);
    }
    if (!rooted) x[shortest_] = axes_[shortest_] * std::sqrt(std::max(rest, 0.0));
    NearestPoint found;
    double squared = 0;
    for (std::size_t a = 0; a < count_; ++a) {
      squared += (x[a] - y[a]) * (x[a] - y[a]);
      found.point[a] = std::copysign(x[a], p[a]);
      found.normal[a] = found.point[a] / (axes_[a] * axes_[a]);
    }
    found.normal = unit(found.normal);
    found.distance = level < 0 ? -std::sqrt(squared) : std::sqrt(squared);
    return found;
  }
  Bounds bounds() const override {
    const Vec3 upper{axes_[0], axes_[1], count_ == 3 ? axes_[2] : 0};
    return {multiply(-1, upper), upper};
  }
  double volume() const override {
    return count_ == 3 ? 4 * pi / 3 * axes_[0] * axes_[1] * axes_[2] : pi * axes_[0] * axes_[1];
  }
  TriangleSurface surface(const Bounds&, double step) const override {
    const double longest = *std::max_element(axes_.begin(), axes_.begin() + static_cast<std::ptrdiff_t>(count_));
    TriangleSurface surface = Ball(1, static_cast<int>(count_)).surface({}, step / longest);
    for (Vec3& p : surface.points)
      for (std::size_t a = 0; a < count_; ++a) p[a] *= axes_[a];
    return surface;
  }

 private:
  Vec3 axes_;
  std::size_t count_, shortest_;
};

}  // namespace

ShapePointer make_ball(double radius, int dimensions) {
  return std::make_shared<Ball>(radius, dimensions);
}

ShapePointer make_cylinder(double radius, std::optional<double> length, int dimensions) {
  if (dimensions == 2) return make_ball(radius, 2);
  if (!length) return std::make_shared<EndlessCylinder>(radius);
  return std::make_shared<Frustum>(radius, radius, *length, 3);
}

ShapePointer make_cone(double radius, double top_radius, double length, int dimensions) {
  return std::make_shared<Frustum>(radius, top_radius, length, dimensions);
}

ShapePointer make_capsule(double radius, double length, int dimensions) {
  return std::make_shared<Capsule>(radius, length, dimensions);
}

ShapePointer make_ellipsoid(const Vec3& semi_axes, int dimensions) {
  return std::make_shared<Ellipsoid>(semi_axes, dimensions);
}

}  // namespace spume
