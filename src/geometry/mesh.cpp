// SPDX-License-Identifier: MIT
#include "spume/geometry/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh_tree.hpp"
#include "spume/core/vectors.hpp"
#include "triangles.hpp"

namespace spume {

namespace {

TrianglePoint nearest_on_edges(const std::array<Vec3, 3>& corners, const Vec3& p) {
  TrianglePoint best{corners[0], 4};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &from = corners[k], way = subtract(corners[(k + 1) % 3], from);
    const double square = dot(way, way);
    const double along = square > 0 ? std::clamp(dot(subtract(p, from), way) / square, 0.0, 1.0) : 0;
    const TrianglePoint found{add(from, multiply(along, way)), static_cast<int>(k) + 1};
    if (length(subtract(p, found.point)) < length(subtract(p, best.point))) best = found;
  }
  return best;
}

}  // namespace

// C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
TrianglePoint nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 ab = subtract(b, a), ac = subtract(c, a), ap = subtract(p, a);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {a, 4};
  const Vec3 bp = subtract(p, b);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {b, 5};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {add(a, multiply(d1 / (d1 - d3), ab)), 1};
  const Vec3 cp = subtract(p, c);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {c, 6};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {add(a, multiply(d2 / (d2 - d6), ac)), 3};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return {add(b, multiply((d4 - d3) / ((d4 - d3) + (d5 - d6)), subtract(c, b))), 2};
  const double whole = va + vb + vc;
  // A needle, whose plane rounding hides.
  if (!(whole > 0)) return nearest_on_edges({a, b, c}, p);
  return {add(a, add(multiply(vb / whole, ab), multiply(vc / whole, ac))), 0};
}

double enclosed_volume(const TriangleSurface& surface) {
  double volume = 0;
  const Vec3& origin = surface.points.front();
  const auto corner = [&](std::int32_t i) { return subtract(surface.points[static_cast<std::size_t>(i)], origin); };
  for (const auto& [a, b, c] : surface.triangles) volume += dot(corner(a), cross(corner(b), corner(c))) / 6;
  return volume;
}

namespace {

class Mesh final : public Shape {
 public:
  explicit Mesh(TriangleSurface surface) : surface_(std::move(surface)), tree_(surface_) {
    normals_.resize(surface_.triangles.size());
    corner_normals_.resize(surface_.points.size());
    std::map<std::pair<std::int32_t, std::int32_t>, Vec3> edges;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      const auto& corners = surface_.triangles[t];
      const Vec3 normal =
          unit(cross(subtract(point(corners[1]), point(corners[0])), subtract(point(corners[2]), point(corners[0]))));
      normals_[t][0] = normal;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t from = corners[k], to = corners[(k + 1) % 3];
        Vec3& edge = edges[std::minmax(from, to)];
        edge = add(edge, normal);
        const Vec3 u = subtract(point(to), point(from)), v = subtract(point(corners[(k + 2) % 3]), point(from));
        Vec3& corner = corner_normals_[static_cast<std::size_t>(from)];
        corner = add(corner, multiply(std::atan2(length(cross(u, v)), dot(u, v)), normal));
      }
    }
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        normals_[t][k + 1] = unit(edges[std::minmax(surface_.triangles[t][k], surface_.triangles[t][(k + 1) % 3])]);
    for (Vec3& normal : corner_normals_) normal = unit(normal);
    for (const Vec3& p : surface_.points)
      for (std::size_t a = 0; a < 3; ++a) {
        bounds_.lower[a] = &p == surface_.points.data() ? p[a] : std::min(bounds_.lower[a], p[a]);
        bounds_.upper[a] = &p == surface_.points.data() ? p[a] : std::max(bounds_.upper[a], p[a]);
      }
    size_ = length(subtract(bounds_.upper, bounds_.lower));
    volume_ = enclosed_volume(surface_);
  }

  NearestPoint nearest(const Vec3& p) const override {
    const std::size_t t = tree_.nearest_triangle(p);
    const auto& corners = surface_.triangles[t];
    const TrianglePoint found = nearest_on_triangle(point(corners[0]), point(corners[1]), point(corners[2]), p);
    const Vec3& pseudonormal =
        found.feature < 4
            ? normals_[t][static_cast<std::size_t>(found.feature)]
            : corner_normals_[static_cast<std::size_t>(corners[static_cast<std::size_t>(found.feature) - 4])];
    const Vec3 away = subtract(p, found.point);
    const double distance = length(away), sign = dot(away, pseudonormal) < 0 ? -1 : 1;
    // Next to the surface the direction to the point is rounding.
    constexpr double next_to = 1e-9;
    const Vec3 normal = distance > next_to * size_ ? multiply(sign / distance, away) : pseudonormal;
    return {sign * distance, normal, found.point};
  }
  Bounds bounds() const override { return bounds_; }
  double volume() const override { return volume_; }
  TriangleSurface surface(const Bounds&, double) const override { return surface_; }

 private:
  const Vec3& point(std::int32_t i) const { return surface_.points[static_cast<std::size_t>(i)]; }

  TriangleSurface surface_;
  MeshTree tree_;
  std::vector<std::array<Vec3, 4>> normals_;  // of the face and its three edges
  std::vector<Vec3> corner_normals_;
  Bounds bounds_;
  double size_ = 0, volume_ = 0;
};

}  // namespace

ShapePointer make_mesh(TriangleSurface surface) {
  return std::make_shared<Mesh>(std::move(surface));
}

}  // namespace spume
