// SPDX-License-Identifier: MIT
#include "spume/particles/thin_bodies.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "wall_shells.hpp"

namespace spume {
namespace {

// Spacings: around an edge, where its faces are looked for.
constexpr double around_edge = 0.3;
// Of the cosine of two normals: those of one face.
constexpr double same_face = 0.94;
// Spacings: of the distance of a surface from itself.
constexpr double on_surface = 1e-3;
// Spacings: what closes a corner lies on the surface, by no more than this.
constexpr double closed = 0.1;
// Spacings: a place nearer to the second face of a corner is its own image there, and what looks through that face
// takes it for free.
constexpr double before_second_face = 0.1;
// Of the sine of the angle between two faces, those that make a corner.
constexpr double upright = 0.7;
// Of the curvature of a flat surface, times a spacing, at most.
constexpr double flat = 0.2;
// Length over thickness of a plate, along the principal axes of the solid. What is shorter and hides liquid by its
// thickness alone, such as a square pillar, stays as thick bodies are: four spacings wide on the floor of a tank it
// left layers of wcsph with accelerations of 1.6 g.
constexpr double slender = 2;

struct Window {
  Vec3 lower{}, upper{};
};

// Moments of places within a solid.
struct Moments {
  double count = 0;
  Vec3 sum{};
  std::array<Vec3, 3> product{};

  void add(const Vec3& place) {
    ++count;
    for (std::size_t a = 0; a < 3; ++a) {
      sum[a] += place[a];
      for (std::size_t b = 0; b < 3; ++b) product[a][b] += place[a] * place[b];
    }
  }
  void add(const Moments& other) {
    count += other.count;
    for (std::size_t a = 0; a < 3; ++a) {
      sum[a] += other.sum[a];
      for (std::size_t b = 0; b < 3; ++b) product[a][b] += other.product[a][b];
    }
  }
  // Of the box that has the same second moments, which a box is however it is turned.
  double longest_edge() const {
    if (!(count > 0)) return 0;
    Eigen::Matrix3d covariance;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        covariance(a, b) = product[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] / count -
                           sum[static_cast<std::size_t>(a)] / count * (sum[static_cast<std::size_t>(b)] / count);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
    return std::sqrt(12 * std::max(axes.eigenvalues()[2], 0.0));
  }
};

// Where a body can be met: all of one that moves, else its part in the domain and a support radius around it.
Window window_of(const Scene& scene, const Body& body, double reach) {
  const Bounds bounds = body.shape->bounds();
  Window window{scene.domain.lower, scene.domain.upper};
  for (int axis = 0; axis < scene.domain.dimensions; ++axis) {
    window.lower[axis] -= reach;
    window.upper[axis] += reach;
    if (body.motion && std::isfinite(bounds.lower[axis])) window.lower[axis] = bounds.lower[axis] - reach;
    if (body.motion && std::isfinite(bounds.upper[axis])) window.upper[axis] = bounds.upper[axis] + reach;
    if (!body.inside) continue;
    window.lower[axis] = std::max(window.lower[axis], bounds.lower[axis] - reach);
    window.upper[axis] = std::min(window.upper[axis], bounds.upper[axis] + reach);
  }
  return window;
}

bool is_thin(const Scene& scene, const Body& body, double spacing, double reach) {
  const int d = scene.domain.dimensions;
  const ShapePointer& solid = body.motion ? body.alone : body.solid;
  const Combination alone({{solid, false}});
  const Window window = window_of(scene, body, reach);
  const double step = spacing / 2;
  std::array<std::size_t, 3> count{1, 1, 1};
  for (int axis = 0; axis < d; ++axis) {
    if (!(window.upper[axis] > window.lower[axis])) return false;
    count[axis] = static_cast<std::size_t>(std::ceil((window.upper[axis] - window.lower[axis]) / step)) + 1;
  }
  const std::size_t rows = count[1] * count[2];
  struct Found {
    bool deep = false;
    std::size_t flat = 0, curved = 0;
    double depth = 0;  // of the deepest place
    Moments inside;    // about the lower corner of the window
  };
  const Found all = parallel_reduce(
      rows, Found{},
      [&](std::size_t first, std::size_t last) {
        Found found;
        for (std::size_t row = first; row < last && !found.deep; ++row) {
          Vec3 place{window.lower[0], window.lower[1] + step * static_cast<double>(row % count[1]),
                     d == 3 ? window.lower[2] + step * static_cast<double>(row / count[1]) : 0.0};
          while (place[0] <= window.upper[0] + step) {
            const double distance = solid->distance(place);
            found.depth = std::max(found.depth, -distance);
            if (distance < -reach) {
              found.deep = true;
              break;
            }
            if (distance < 0) found.inside.add(subtract(place, window.lower));
            if (distance > 0.25 * spacing && distance < 0.75 * spacing) {
              const NearestPoint near = solid->nearest(place);
              const MirroredShare share = mirrored_share(alone, near, place, spacing, d);
              if (!share.edge)
                ++(std::abs(share.share - 1) < 2 * flat * distance / spacing ? found.flat : found.curved);
            }
            place[0] += std::max(step, distance - 0.75 * spacing);  // the surface is not nearer
          }
        }
        return found;
      },
      [](const Found& a, const Found& b) {
        Found both{a.deep || b.deep, a.flat + b.flat, a.curved + b.curved, std::max(a.depth, b.depth), a.inside};
        both.inside.add(b.inside);
        return both;
      });
  return !all.deep && all.flat > all.curved &&
         (2 * all.depth < reach || all.inside.longest_edge() > slender * 2 * all.depth);
}

// Normals of the faces that meet at an edge.
std::vector<Vec3> faces_at(const Shape& solid, const Vec3& edge, double spacing, int dimensions) {
  const double radius = around_edge * spacing;
  std::vector<Vec3> faces;
  const auto look = [&](const Vec3& way) {
    const NearestPoint near = solid.nearest(add(edge, multiply(radius, way)));
    if (length(subtract(near.point, edge)) < 0.3 * radius) return;
    if (std::none_of(faces.begin(), faces.end(), [&](const Vec3& n) { return dot(n, near.normal) > same_face; }))
      faces.push_back(near.normal);
  };
  constexpr int ways = 48, rings = 12;
  for (int k = 0; k < ways; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / ways;
    if (dimensions == 2) {
      look({std::cos(angle), std::sin(angle), 0});
      continue;
    }
    for (int ring = 0; ring < rings; ++ring) {
      const double z = (2 * ring + 1.0) / rings - 1, across = std::sqrt(1 - z * z);
      look({across * std::cos(angle), across * std::sin(angle), z});
    }
  }
  return faces;
}

Vec3 reflected(const Vec3& place, const Vec3& foot, const Vec3& normal) {
  return subtract(place, multiply(2 * dot(subtract(place, foot), normal), normal));
}

class Sheets {
 public:
  Sheets(const std::vector<StandingBody>& bodies, const Combination& walls, const Domain& domain,
         const Resolution& resolution)
      : bodies_(bodies),
        walls_(walls),
        domain_(domain),
        spacing_(resolution.spacing),
        reach_(resolution.support_radius) {}

  void add(std::size_t body, const Vec3& place, std::vector<WallPoint>& points) const {
    if (walls_.distance(place) < 0) return;  // in another body
    const Shape& solid = *bodies_[body].solid;
    const Combination alone({{bodies_[body].solid, false}});
    const NearestPoint near = solid.nearest(place);
    if (walls_.distance(near.point) < -on_surface * spacing_) return;
    if (mirrored_share(alone, near, place, spacing_, domain_.dimensions).edge) {
      for (const Vec3& normal : faces_at(solid, near.point, spacing_, domain_.dimensions))
        add_behind(place, near.point, normal, true, points);
      return;
    }
    add_behind(place, near.point, near.normal, false, points);
    for (std::size_t other = 0; other < bodies_.size(); ++other)
      if (other != body && !(bodies_[other].thin && other < body)) add_corner(place, near, other, points);
  }

 private:
  // The image in the plane of a face.
  void add_behind(const Vec3& place, const Vec3& on_face, const Vec3& normal, bool past_edge,
                  std::vector<WallPoint>& points) const {
    const double before = dot(subtract(place, on_face), normal);
    if (!(before > 0) || before >= reach_) return;
    WallPoint point;
    point.foot = subtract(place, multiply(before, normal));
    point.normal = normal;
    point.mirror = place;
    point.position = subtract(place, multiply(2 * before, normal));
    point.one_sided = true;
    point.past_edge = past_edge;
    points.push_back(point);
  }

  // The image in two faces that make a corner.
  void add_corner(const Vec3& place, const NearestPoint& near, std::size_t other,
                  std::vector<WallPoint>& points) const {
    const NearestPoint second = bodies_[other].solid->nearest(place);
    if (!(second.distance > before_second_face * spacing_) || second.distance >= reach_ ||
        std::abs(dot(near.normal, second.normal)) > upright)
      return;
    Vec3 corner = place;
    for (int round = 0; round < 8; ++round)
      for (const NearestPoint* face : {&near, &second})
        corner = subtract(corner, multiply(dot(subtract(corner, face->point), face->normal), face->normal));
    if (std::abs(bodies_[other].solid->distance(corner)) > closed * spacing_) return;
    if (std::abs(walls_.distance(corner)) > closed * spacing_) return;
    WallPoint point;
    point.position = reflected(reflected(place, near.point, near.normal), second.point, second.normal);
    point.mirror = place;
    point.foot = multiply(0.5, spume::add(point.position, place));
    point.normal = unit(subtract(place, point.position), domain_.dimensions);
    point.in_corner = true;
    points.push_back(point);
  }

  const std::vector<StandingBody>& bodies_;
  const Combination& walls_;
  const Domain& domain_;
  double spacing_, reach_;
};

// Into the period that the domain is.
void wrap(const Domain& domain, WallPoint& point) {
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    if (!domain.periodic(axis)) continue;
    const double period = domain.upper[axis] - domain.lower[axis];
    const double shift = -period * std::floor((point.position[axis] - domain.lower[axis]) / period);
    for (Vec3* place : {&point.position, &point.foot, &point.mirror}) (*place)[axis] += shift;
  }
}

}  // namespace

std::vector<std::uint8_t> find_thin_bodies(const Scene& scene, const Resolution& resolution) {
  std::vector<std::uint8_t> thin(scene.bodies.size(), 0);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.wall == BoundaryKind::open || (body.motion && scene.motions[*body.motion].release)) continue;
    const bool cut = std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& other) {
      return other.subtract && other.wall != BoundaryKind::open && other.motion == body.motion;
    });
    thin[b] = !cut && is_thin(scene, body, resolution.spacing, resolution.support_radius) ? 1 : 0;
  }
  return thin;
}

std::vector<WallPoint> make_sheet_points(const std::vector<StandingBody>& bodies, const Combination& walls,
                                         const Domain& domain, const Resolution& resolution, double particle_volume) {
  const Sheets sheets(bodies, walls, domain, resolution);
  std::vector<WallPoint> points;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].thin) continue;
    const Combination alone({{bodies[b].solid, false}});
    for (const ShellPoint& shell : make_shells(alone, domain, resolution, particle_volume, true))
      sheets.add(b, shell.place, points);
  }
  for (WallPoint& point : points) wrap(domain, point);
  return points;
}

}  // namespace spume
