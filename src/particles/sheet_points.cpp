// SPDX-License-Identifier: MIT
// Wall points of thin bodies.
#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/thin_bodies.hpp"
#include "thin_faces.hpp"
#include "wall_shells.hpp"

namespace spume {
namespace {

// Spacings: of the distance of a surface from itself.
constexpr double on_surface = 1e-3;
// Spacings: what closes a corner lies on the surface, by no more than this.
constexpr double closed = 0.1;
// Spacings: a place nearer to the second face of a corner is its own image there, and what looks through that face
// takes it for free.
constexpr double before_second_face = 0.1;
// Of the sine of the angle between the face of a thin body and a thick one, those that make a corner.
constexpr double upright = 0.7;
// Spacings by which a face reaches out before another where they make a corner and not an edge.
constexpr double reaches_out = 0.2;
// Of the cosine of the angle between the normals of two faces that make one: narrower than 30 degrees, or the walls of
// a channel.
constexpr double opposite = 0.87;
// Spacings: of two images of a place, one.
constexpr double same_place = 1e-3;
// Images in turns of a place in a corner of 30 degrees.
constexpr int most_images = 6;

Vec3 reflected(const Vec3& place, const Vec3& foot, const Vec3& normal) {
  return subtract(place, multiply(2 * dot(subtract(place, foot), normal), normal));
}

class Sheets {
 public:
  using Face = ThinFaces::Face;

  Sheets(const std::vector<StandingBody>& bodies, const Combination& walls, const Domain& domain,
         const Resolution& resolution, const ThinFaces& faces)
      : bodies_(bodies),
        walls_(walls),
        domain_(domain),
        spacing_(resolution.spacing),
        reach_(resolution.support_radius),
        faces_(faces) {}

  // The images of a place beside a body.
  void add(std::size_t body, const Vec3& place, std::vector<SheetPoint>& points) const {
    if (walls_.distance(place) < 0) return;  // in another body
    const NearestPoint near = bodies_[body].solid->nearest(place);
    if (walls_.distance(near.point) < -on_surface * spacing_) return;
    const std::vector<Face> faces = faces_.around(body, place, near);
    for (const Face& face : faces)
      if (face.body == body) add_behind(place, face, points);
    std::vector<std::array<std::size_t, 2>> right;
    for (std::size_t a = 0; a < faces.size(); ++a)
      for (std::size_t b = a + 1; b < faces.size(); ++b) {
        // Of two bodies the first has the points of their corners.
        const std::size_t first = std::min(faces[a].body, faces[b].body);
        if (first == body && make_corner(place, faces[a], faces[b]) && add_corner(place, faces[a], faces[b], points))
          right.push_back({a, b});
      }
    add_corner_of_three(place, faces, right, points);
    if (faces.size() > 1 && !is_on(near.point, faces.front())) return;
    for (std::size_t other = 0; other < bodies_.size(); ++other)
      if (!bodies_[other].thin) add_thick_corner(place, body, near, other, points);
  }

  // The planes of the faces that make corners with others before a place.
  std::vector<CornerPlane> corner_around(std::size_t body, const Vec3& place) const {
    const std::vector<Face> faces = faces_.around(body, place, bodies_[body].solid->nearest(place));
    std::vector<CornerPlane> planes;
    for (std::size_t a = 0; a < faces.size(); ++a)
      for (std::size_t b = 0; b < faces.size(); ++b)
        if (a != b && make_corner(place, faces[a], faces[b])) {
          planes.push_back({faces[a].point, faces[a].normal});
          break;
        }
    return planes;
  }

 private:
  bool is_on(const Vec3& place, const Face& face) const {
    return std::abs(dot(subtract(place, face.point), face.normal)) < on_surface * spacing_;
  }

  // The image in the plane of a face.
  void add_behind(const Vec3& place, const Face& face, std::vector<SheetPoint>& points) const {
    const double before = dot(subtract(place, face.point), face.normal);
    if (!(before > 0) || before >= reach_) return;
    SheetPoint point = seen_through(face, reflected(place, face.point, face.normal), place);
    point.past_edge = face.beside_edge && std::abs(bodies_[face.body].solid->distance(point.foot)) > closed * spacing_;
    points.push_back(point);
  }

  SheetPoint seen_through(const Face& face, const Vec3& position, const Vec3& mirror) const {
    SheetPoint point;
    point.body = face.body;
    point.position = position;
    point.mirror = mirror;
    point.normal = face.normal;
    point.foot = subtract(position, multiply(dot(subtract(position, face.point), face.normal), face.normal));
    point.one_sided = true;
    point.beside_edge = face.beside_edge;
    point.flat = face.flat;
    point.least_cosine = static_cast<float>(face.least_cosine);
    return point;
  }

  // Each reaches out before the other, to where they meet.
  bool make_corner(const Vec3& place, const Face& a, const Face& b) const {
    const double cosine = dot(a.normal, b.normal);
    if (cosine < -opposite) return false;
    const auto reaches = [&](const Face& face, const Face& before) {
      return std::any_of(face.samples.begin(), face.samples.end(), [&](const Vec3& sample) {
        return dot(subtract(sample, before.point), before.normal) > reaches_out * spacing_;
      });
    };
    if (!reaches(a, b) || !reaches(b, a)) return false;
    // Onto both planes.
    const double from_a = dot(subtract(place, a.point), a.normal), from_b = dot(subtract(place, b.point), b.normal),
                 sine2 = 1 - cosine * cosine;
    const Vec3 corner = subtract(place, spume::add(multiply((from_a - cosine * from_b) / sine2, a.normal),
                                                   multiply((from_b - cosine * from_a) / sine2, b.normal)));
    return std::abs(bodies_[a.body].solid->distance(corner)) < closed * spacing_ &&
           std::abs(bodies_[b.body].solid->distance(corner)) < closed * spacing_ &&
           std::abs(walls_.distance(corner)) < closed * spacing_;
  }

  // The images in two faces in turns, as long as each is before the next; the face that is last is that which it is
  // seen through. Those that both orders have are seen where the place is. Returns whether it is one, as where the
  // faces are at right angles.
  bool add_corner(const Vec3& place, const Face& a, const Face& b, std::vector<SheetPoint>& points) const {
    const std::array<const Face*, 2> face{&a, &b};
    std::array<Vec3, 2> at{reflected(place, a.point, a.normal), reflected(place, b.point, b.normal)};
    std::array<bool, 2> goes_on{true, true};
    for (int image = 0; image < most_images && (goes_on[0] || goes_on[1]); ++image) {
      std::array<const Face*, 2> next{};
      for (std::size_t order = 0; order < 2; ++order) {
        next[order] = face[(order + static_cast<std::size_t>(image) + 1) % 2];
        goes_on[order] = goes_on[order] && dot(subtract(at[order], next[order]->point), next[order]->normal) > 0;
        if (goes_on[order]) at[order] = reflected(at[order], next[order]->point, next[order]->normal);
      }
      if (goes_on[0] && goes_on[1] && length(subtract(at[0], at[1])) < same_place * spacing_) {
        add_turned(place, at[0], std::max(a.body, b.body), points);
        return image == 0;
      }
      for (std::size_t order = 0; order < 2; ++order) {
        if (!goes_on[order] || !is_near(at[order], *next[order])) continue;
        SheetPoint point = seen_through(*next[order], at[order], place);
        point.in_corner = point.past_edge = true;
        points.push_back(point);
      }
    }
    return false;
  }

  bool is_near(const Vec3& position, const Face& face) const {
    return std::any_of(face.samples.begin(), face.samples.end(),
                       [&](const Vec3& sample) { return length(subtract(sample, position)) < reach_ + spacing_; });
  }

  // The image that turns a place about a corner.
  void add_turned(const Vec3& place, const Vec3& position, std::size_t body, std::vector<SheetPoint>& points) const {
    SheetPoint point;
    point.body = body;
    point.position = position;
    point.mirror = place;
    point.foot = multiply(0.5, spume::add(position, place));
    point.normal = unit(subtract(place, position), domain_.dimensions);
    point.in_corner = true;
    point.turned = true;
    points.push_back(point);
  }

  // Behind three faces at right angles to each other.
  void add_corner_of_three(const Vec3& place, const std::vector<Face>& faces,
                           const std::vector<std::array<std::size_t, 2>>& right,
                           std::vector<SheetPoint>& points) const {
    const auto are_right = [&](std::size_t a, std::size_t b) {
      return std::find(right.begin(), right.end(), std::array{a, b}) != right.end();
    };
    for (std::size_t a = 0; a < faces.size(); ++a)
      for (std::size_t b = a + 1; b < faces.size(); ++b)
        for (std::size_t c = b + 1; c < faces.size(); ++c) {
          if (!are_right(a, b) || !are_right(a, c) || !are_right(b, c)) continue;
          Vec3 position = place;
          for (const std::size_t f : {a, b, c}) position = reflected(position, faces[f].point, faces[f].normal);
          add_turned(place, position, std::max({faces[a].body, faces[b].body, faces[c].body}), points);
        }
  }

  // In the corner with a body that has points of its own.
  void add_thick_corner(const Vec3& place, std::size_t body, const NearestPoint& near, std::size_t other,
                        std::vector<SheetPoint>& points) const {
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
    add_turned(place, reflected(reflected(place, near.point, near.normal), second.point, second.normal),
               std::max(body, other), points);
    points.back().turned = false;  // what enters the thick body is not looked for
  }

  const std::vector<StandingBody>& bodies_;
  const Combination& walls_;
  const Domain& domain_;
  double spacing_, reach_;
  const ThinFaces& faces_;
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

std::vector<SheetPoint> make_sheet_points(const std::vector<StandingBody>& bodies, const Combination& walls,
                                          const Domain& domain, const Resolution& resolution, double particle_volume) {
  std::vector<std::vector<ShellPoint>> shells(bodies.size());
  ThinFaces faces(bodies, walls, domain, resolution.spacing, resolution.support_radius);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].thin) continue;
    shells[b] = make_shells(Combination({{bodies[b].solid, false}}), domain, resolution, particle_volume, true);
    std::vector<Vec3> first;
    for (const ShellPoint& shell : shells[b])
      if (shell.distance < resolution.spacing) first.push_back(shell.place);
    faces.sample(b, first);
  }
  faces.sort();
  const Sheets sheets(bodies, walls, domain, resolution, faces);
  std::vector<SheetPoint> points;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].thin) continue;
    std::erase_if(shells[b], [&](const ShellPoint& shell) { return walls.distance(shell.place) < 0; });  // in another
    std::vector<std::vector<CornerPlane>> corners(shells[b].size());
    parallel_for(corners.size(), [&](std::size_t i) {
      corners[i] = sheets.corner_around(b, shells[b][i].place);
      if (!corners[i].empty()) shells[b][i].corner = static_cast<std::int32_t>(i);
    });
    if (std::any_of(corners.begin(), corners.end(), [](const auto& planes) { return !planes.empty(); }))
      even_out_in_corners(Combination({{bodies[b].solid, false}}), domain, resolution, particle_volume, corners,
                          shells[b]);
    std::vector<std::vector<SheetPoint>> of_place(shells[b].size());
    parallel_for(shells[b].size(), [&](std::size_t i) { sheets.add(b, shells[b][i].place, of_place[i]); });
    for (const auto& some : of_place) points.insert(points.end(), some.begin(), some.end());
  }
  for (SheetPoint& point : points) wrap(domain, point);
  return points;
}

}  // namespace spume
