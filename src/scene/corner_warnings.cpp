// SPDX-License-Identifier: MIT
// Corners of thin bodies too narrow for the images of the liquid in them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "bodies.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/scene/plates.hpp"

namespace spume {
namespace {

// Degrees: from 45 on the images in the two faces close the circle (particles/thin_bodies.hpp), less half a degree for
// rounding; narrower than this are two faces that lie side by side.
constexpr double narrowest = 44.5, side_by_side = 3;
// Spacings: across a corner, as far as it is looked for; of what closes it from the surface; how far inside the surface
// normals are those of faces.
constexpr double across_corner = 2, closes_corner = 0.1, within_surface = 0.05;
constexpr double of_same_face = 0.99;  // of the cosine of two normals

// The solid as it stands at the start.
const Shape& standing_solid(const Body& body) {
  return body.motion ? *body.alone : *body.solid;
}

struct FacePlane {
  Vec3 point{}, normal{};
};

// Of the face that a place is before; false past an edge of it.
bool face_before(const Shape& solid, const Vec3& place, double spacing, FacePlane& face) {
  const NearestPoint near = solid.nearest(place);
  face = {near.point, near.normal};
  const Vec3 within = subtract(near.point, multiply(within_surface * spacing, near.normal));
  return dot(solid.nearest(within).normal, near.normal) > of_same_face;
}

// Where a way along a normal of length one meets a solid, within a length.
bool meets(const Shape& solid, const Vec3& from, const Vec3& way, double length, double spacing, Vec3& place) {
  const double least = 1e-3 * spacing;
  for (double gone = 0; gone < length;) {
    place = add(from, multiply(gone, way));
    const double away = solid.distance(place);
    if (away < least) return true;
    gone += std::max(away, least);
  }
  return false;
}

// The angle of the liquid between the face of one solid before a place and one of another that lies across, where these
// meet; 180 if they do not.
double angle_at(const Shape& one, const Shape& other, const Vec3& place, double spacing) {
  FacePlane a, b;
  Vec3 hit{};
  if (!face_before(one, place, spacing, a) || !meets(other, place, a.normal, across_corner * spacing, spacing, hit))
    return 180;
  const Vec3 before = subtract(hit, multiply(0.1 * spacing, a.normal));
  if (!face_before(other, before, spacing, b)) return 180;
  const double cosine = dot(a.normal, b.normal);
  const double degrees = std::acos(std::clamp(-cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
  if (degrees > narrowest || degrees < side_by_side) return 180;
  const double from_a = dot(subtract(place, a.point), a.normal), from_b = dot(subtract(place, b.point), b.normal),
               sine2 = 1 - cosine * cosine;
  const Vec3 corner = subtract(place, add(multiply((from_a - cosine * from_b) / sine2, a.normal),
                                          multiply((from_b - cosine * from_a) / sine2, b.normal)));
  const bool meet = std::abs(one.distance(corner)) < closes_corner * spacing &&
                    std::abs(other.distance(corner)) < closes_corner * spacing;
  return meet ? degrees : 180;
}

// The narrowest corner of a plate with a body, which may be the plate itself, in degrees.
double narrowest_corner(const Scene& scene, const Body& plate, const Body& other) {
  const Shape &one = standing_solid(plate), &two = standing_solid(other);
  const int d = scene.domain.dimensions;
  const double step = scene.spacing / 2;
  const Bounds window = window_around(scene, plate, scene.spacing), of_other = other.shape->bounds();
  std::array<std::size_t, 3> count{1, 1, 1};
  for (int axis = 0; axis < d; ++axis) {
    if (of_other.lower[axis] > window.upper[axis] || of_other.upper[axis] < window.lower[axis]) return 180;
    if (!(window.upper[axis] > window.lower[axis])) return 180;
    count[axis] = static_cast<std::size_t>(std::ceil((window.upper[axis] - window.lower[axis]) / step)) + 1;
  }
  return parallel_reduce(
      count[1] * count[2], 180.0,
      [&](std::size_t first, std::size_t last) {
        double least = 180;
        for (std::size_t row = first; row < last; ++row) {
          Vec3 place{window.lower[0], window.lower[1] + step * static_cast<double>(row % count[1]),
                     d == 3 ? window.lower[2] + step * static_cast<double>(row / count[1]) : 0.0};
          while (place[0] <= window.upper[0] + step) {
            const double away = one.distance(place);
            if (away > 0.25 * scene.spacing && away < 0.75 * scene.spacing && (&one == &two || two.distance(place) > 0))
              least = std::min(least, angle_at(one, two, place, scene.spacing));
            place[0] += std::max(step, away - 0.75 * scene.spacing);
          }
        }
        return least;
      },
      [](double a, double b) { return std::min(a, b); });
}

}  // namespace

std::vector<Problem> corner_warnings(const Draft& draft, const Scene& scene, const std::string& file) {
  const auto stands = [&](const Body& body) {
    return body.wall != BoundaryKind::open && !body.subtract && !(body.motion && scene.motions[*body.motion].release);
  };
  std::vector<bool> plate;
  for (const Body& body : scene.bodies)
    plate.push_back(stands(body) && is_plate(scene, body, scene.spacing, standard_support * scene.spacing));
  std::vector<Problem> warnings;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    for (std::size_t m = k; m < scene.bodies.size(); ++m) {
      const Body &one = scene.bodies[k], &two = scene.bodies[m];
      const Node* node = node_of_body(draft, scene, m);
      if ((!plate[k] && !plate[m]) || !stands(one) || !stands(two) || one.motion != two.motion || node == nullptr)
        continue;
      const double degrees = plate[k] ? narrowest_corner(scene, one, two) : narrowest_corner(scene, two, one);
      if (degrees > narrowest) continue;
      const std::string who = k == m ? "two faces of the body '" + one.name + "' meet"
                                     : "the bodies '" + one.name + "' and '" + two.name + "' meet";
      warnings.push_back({file, node->place.line, node->place.column,
                          who + " at " + brief(std::round(degrees)) +
                              " degrees: beside bodies thinner than five spacings, " + brief(5 * scene.spacing) +
                              ", water in a corner of less than 45 degrees does not stay still, and the run may fail; "
                              "turn or part them, fill the corner, or make them thicker"});
    }
  return warnings;
}

}  // namespace spume
