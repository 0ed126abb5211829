// SPDX-License-Identifier: MIT
#include "surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "spume/core/vectors.hpp"

namespace spume {

int facets_around(double radius, double step) {
  // 512 facets around differ from the circle by 2e-5 of its radius.
  const double facets = std::ceil(2 * std::numbers::pi * radius / step);
  return static_cast<int>(std::clamp(facets, 24.0, 512.0));
}

void add_arc(std::vector<Point2>& profile, double radius, double height, double from, double to, int facets) {
  for (int k = 0; k <= facets; ++k) {
    const double angle = from + (to - from) * k / facets;
    // Ends on the axis are there exactly.
    const bool on_axis = (k == 0 && from == 0) || (k == facets && to == std::numbers::pi);
    profile.push_back({on_axis ? 0 : radius * std::sin(angle), height + radius * std::cos(angle)});
  }
}

TriangleSurface revolve(const std::vector<Point2>& profile, int facets) {
  TriangleSurface surface;
  std::vector<std::int32_t> start;
  for (const Point2& p : profile) {
    start.push_back(static_cast<std::int32_t>(surface.points.size()));
    for (int k = 0; k < (p[0] > 0 ? facets : 1); ++k) {
      const double angle = 2 * std::numbers::pi * k / facets;
      surface.points.push_back({p[0] * std::cos(angle), p[0] * std::sin(angle), p[1]});
    }
  }
  for (std::size_t i = 0; i + 1 < profile.size(); ++i)
    for (int k = 0; k < facets; ++k) {
      const auto at = [&](std::size_t ring, int side) {
        return start[ring] + (profile[ring][0] > 0 ? side % facets : 0);
      };
      const std::int32_t a = at(i, k), b = at(i + 1, k), c = at(i + 1, k + 1), d = at(i, k + 1);
      if (b != c) surface.triangles.push_back({a, b, c});
      if (a != d) surface.triangles.push_back({a, c, d});
    }
  return surface;
}

// Ears are cut off one by one: corners whose triangle holds no other point.
TriangleSurface fill_polygon(const std::vector<Point2>& points) {
  TriangleSurface surface;
  for (const Point2& p : points) surface.points.push_back({p[0], p[1], 0});
  std::vector<std::int32_t> left(points.size());
  std::iota(left.begin(), left.end(), 0);
  const auto at = [&](std::size_t i) { return points[static_cast<std::size_t>(left[i % left.size()])]; };
  const auto is_ear = [&](std::size_t i) {
    const Point2 a = at(i + left.size() - 1), b = at(i), c = at(i + 1);
    if (turn(a, b, c) <= 0) return false;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const Point2 p = at(k);
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  };
  for (std::size_t i = 0, refused = 0; left.size() > 3 && refused < left.size();) {
    i %= left.size();
    // A corner on a straight side has no ear, and its removal no effect.
    const bool flat = turn(at(i + left.size() - 1), at(i), at(i + 1)) == 0;
    if (!flat && !is_ear(i)) {
      ++i;
      ++refused;
      continue;
    }
    if (!flat)
      surface.triangles.push_back({left[(i + left.size() - 1) % left.size()], left[i], left[(i + 1) % left.size()]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    refused = 0;
  }
  if (left.size() == 3) surface.triangles.push_back({left[0], left[1], left[2]});
  return surface;
}

TriangleSurface fill_profile(const std::vector<Point2>& profile) {
  std::vector<Point2> points;
  points.reserve(2 * profile.size());
  for (const Point2& p : profile) points.push_back({-p[0], p[1]});
  for (auto p = profile.rbegin(); p != profile.rend(); ++p)
    if ((*p)[0] > 0) points.push_back(*p);
  return fill_polygon(points);
}

std::vector<Vec3> clip(std::vector<Vec3> polygon, const Bounds& box) {
  for (std::size_t a = 0; a < 3; ++a)
    for (const bool upper : {false, true}) {
      const double plane = upper ? box.upper[a] : box.lower[a];
      const auto depth = [&](const Vec3& p) { return upper ? plane - p[a] : p[a] - plane; };
      std::vector<Vec3> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double from = depth(p), to = depth(q);
        if (from >= 0) kept.push_back(p);
        if ((from < 0 && to > 0) || (from > 0 && to < 0))
          kept.push_back(add(p, multiply(from / (from - to), subtract(q, p))));
      }
      polygon = std::move(kept);
    }
  return polygon;
}

TriangleSurface fan(const std::vector<Vec3>& polygon) {
  TriangleSurface surface{polygon, {}};
  for (std::int32_t i = 1; i + 1 < static_cast<std::int32_t>(polygon.size()); ++i)
    surface.triangles.push_back({0, i, i + 1});
  return surface;
}

// Turned from x and z, in this order, y points away: the polygon is clockwise seen from its upper end.
TriangleSurface extrude(const std::vector<Point2>& points, double from, double to) {
  const TriangleSurface cap = fill_polygon(points);
  TriangleSurface surface;
  const auto n = static_cast<std::int32_t>(points.size());
  for (const double y : {from, to})
    for (const Point2& p : points) surface.points.push_back({p[0], y, p[1]});
  for (const auto& [a, b, c] : cap.triangles) {
    surface.triangles.push_back({a, b, c});
    surface.triangles.push_back({a + n, c + n, b + n});
  }
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t j = (i + 1) % n;
    surface.triangles.push_back({i, j + n, j});
    surface.triangles.push_back({i, i + n, j + n});
  }
  return surface;
}

}  // namespace spume
