// SPDX-License-Identifier: MIT
// Slow, obvious twin of what thin bodies hide: straight ways are looked along at places a hundredth of a spacing apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "spume/core/vectors.hpp"
#include "spume/particles/wall_points.hpp"

namespace spume::reference {

// In an open domain, of bodies with flat faces.
struct ThinSight {
  const Combination& solids;
  double spacing;

  // Unclear is what a tenth of a spacing decides: ways so deep in a body may pass, and a way that enters so near to an
  // edge may enter by either face.
  enum class Answer { no, yes, unclear };
  static constexpr double shallow = 0.11, beside_edge = 0.15;

  Answer between(const Vec3& from, const Vec3& to) const {
    double least = infinite;
    along(from, to, [&](const Vec3& place) {
      least = std::min(least, solids.distance(place));
      return false;
    });
    return least >= 0 ? Answer::yes : least < -shallow * spacing ? Answer::no : Answer::unclear;
  }

  // A wall point of a face is seen by ways that enter the bodies through that face, others when what they mirror is; of
  // these what a corner turns by ways that enter through one of its faces, which leads through the foot and turns the
  // point from the mirror.
  Answer point(const Vec3& eye, const WallPoint& point) const {
    if (!point.one_sided) {
      const Answer mirror = between(eye, point.mirror);
      if (mirror == Answer::no || !point.turned) return mirror;
      const Answer entered = enters(eye, point.position, [&](const Vec3& entry, const Vec3& normal) {
        return std::abs(dot(subtract(point.foot, entry), normal)) < shallow * spacing &&
               dot(subtract(point.mirror, point.position), normal) > shallow * spacing;
      });
      return entered == Answer::no ? entered : mirror == Answer::unclear ? mirror : entered;
    }
    return enters(eye, point.position,
                  [&](const Vec3&, const Vec3& normal) { return dot(normal, point.normal) > 0.99; });
  }

 private:
  // Whether a way enters the bodies through a face that is_of(place, normal) says.
  template <class IsOf>
  Answer enters(const Vec3& eye, const Vec3& position, IsOf&& is_of) const {
    Vec3 entry{};
    double least = infinite;
    std::vector<Vec3> passed;  // normals where the way is about to enter
    const bool is_entered = along(eye, position, [&](const Vec3& place) {
      entry = place;
      const NearestPoint near = solids.nearest(place);
      least = std::min(least, near.distance);
      if (near.distance < shallow * spacing) passed.push_back(near.normal);
      return near.distance < 0;
    });
    if (!is_entered) return least > shallow * spacing ? Answer::no : Answer::unclear;
    const Vec3 normal = solids.nearest(entry).normal;
    if (std::any_of(passed.begin(), passed.end(), [&](const Vec3& other) { return dot(other, normal) < 0.99; }))
      return Answer::unclear;
    const auto is_edge = [&](const Vec3& way) {
      const Vec3 within = subtract(add(entry, multiply(beside_edge * spacing, way)), multiply(0.02 * spacing, normal));
      return dot(solids.nearest(within).normal, normal) < 0.99;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        Vec3 way{};
        way[axis] = sign;
        way = subtract(way, multiply(dot(way, normal), normal));
        if (length(way) > 0.1 && is_edge(unit(way))) return Answer::unclear;
      }
    return is_of(entry, normal) ? Answer::yes : Answer::no;
  }

  // Calls visit(place) until it returns true.
  template <class Visit>
  bool along(const Vec3& from, const Vec3& to, Visit&& visit) const {
    const double steps = std::ceil(length(subtract(to, from)) / (0.01 * spacing));
    for (double k = 0; k <= steps; ++k)
      if (visit(add(multiply(1 - k / steps, from), multiply(k / steps, to)))) return true;
    return false;
  }
};

}  // namespace spume::reference
