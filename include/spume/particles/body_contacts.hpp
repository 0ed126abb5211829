// SPDX-License-Identifier: MIT
// Where bodies that float may touch walls of the domain, other bodies or each other within a step.
//
// Points of the surface of one body are asked for their distance from another. A distance g with the normal n, out of
// the other, holds the relative velocity u of the point to
//
//   n . u >= -(g - clearance) / dt.
//
// The clearance is a spacing: no fewer than one layer of particles stands for the liquid between two bodies, and what a
// layer thinner than that would do to its particles is no flow. Bodies that start nearer to each other keep that
// distance; those that overlap at the start, as hinged ones, pass through each other.
//
// Of a round surface the point asked is the one that reaches farthest towards the other. Edges and corners are asked
// wherever they stand: a box that is stopped at one corner turns about it, and the other one, until then higher, comes
// down within the same step by as much as the box is long times the turn. Points turn on circles, which takes
//
//   dt^2 / 2 n . (omega x (omega x r))
//
// from what n . u dt leaves of g: without it a polygon that rolls were held by the corner that it rolls on to, whose
// way down dt omega is twice as long along its tangent as on its circle.
#pragma once

#include <compare>
#include <optional>
#include <vector>

#include "spume/particles/body_walls.hpp"
#include "spume/particles/convex_corners.hpp"
#include "spume/particles/fitted_spheres.hpp"
#include "spume/particles/surface_pieces.hpp"

namespace spume {

struct BodyContact {
  // A point of the surface of a part of the walls (BodyWalls), and another part or, from `parts` on, a side.
  struct Key {
    std::int64_t point = 0, other = 0;
    auto operator<=>(const Key&) const = default;
  };
  Key key;
  // Motions of both; none: given.
  std::optional<std::size_t> of_point, of_other;
  Vec3 point{}, normal{};  // now
  double clearance = 0;    // below 0 by no more than the error of the distance
  double room = 0;         // distance less the clearance
  double given_speed = 0;  // n . u of those that are given, as they move on
  double restitution = 0;  // of both
};

class BodyContacts {
 public:
  // The walls stand where they do at the start, and outlive this.
  BodyContacts(const Scene& scene, const Resolution& resolution, const BodyWalls& walls);

  using Sides = std::array<std::array<double, 2>, 3>;  // of the domain, by axis and side
  struct Surroundings {
    Sides walls{};
    double ahead = 0;                    // time of the velocities that bodies are to have
    std::array<double, 2> absorption{};  // velocities along x that the left and right walls have beside those given
  };
  // Of all points that may come as near as the clearance within `dt`, where accelerations take them no farther than a
  // spacing.
  std::vector<BodyContact> find(const Surroundings& surroundings, double dt) const;

  // A bound of the speeds of the surface of a motion.
  double largest_speed(std::size_t motion) const { return largest_speed_of(motion + 1); }
  // With anything that it then passes through.
  bool overlaps_at_start(std::size_t motion) const;

 private:
  struct Point {
    Vec3 start{};
    std::size_t part = 0;
    ConvexCorner corner;
    bool faceted = false;  // a corner of the facets that stand for its body, whose distances are interpolated
    std::optional<FittedSphere> round = {};  // what of it facets stand for, or a cylinder
    double longest_side = 0;                 // of these facets
  };
  // What of a body may touch another: beside what reaches farthest now it may be what does once the body has turned.
  struct Place {
    Vec3 at{};
    bool turning = false;
  };
  static constexpr double passes_through = -infinite;  // a clearance: they do not touch

  bool floats(std::size_t part) const { return part > 0 && scene_.motions[part - 1].floats; }
  const RigidWalls& walls_of(std::size_t part) const { return walls_.part(part); }
  void gather_points();
  // `pieces`: those of the body that the points from `first` on are corners of, with the normals there.
  void fit_spheres(const std::vector<SurfacePiece>& pieces, std::size_t first, const std::vector<Vec3>& facing);
  void set_clearances();
  Vec3 now(const Point& point) const;
  // Near a point that is now at a place.
  std::optional<Place> place_towards(const Point& point, const Vec3& at, const Vec3& towards, std::size_t other) const;
  // For a point of an edge or a corner, now at a place: what near it may become the place that reaches farthest towards
  // the other as the body turns, where another does now.
  std::optional<Vec3> may_come_foremost(const Point& point, const Vec3& at, const Vec3& towards,
                                        const std::optional<Vec3>& foremost, std::size_t other) const;
  // Of a round surface the place that a force along the normal there leads through the centre from: the normal of what
  // it meets differs between the place asked for it and the one found, by 0.01 where distances are interpolated.
  Vec3 through_centre(const Point& point, const Place& place, const Vec3& normal) const;
  // Of a point of a body that goes on turning.
  Vec3 turning_acceleration(std::size_t part, const Vec3& at) const;
  double restitution(std::size_t part) const;
  double largest_speed_of(std::size_t part) const;
  double& clearance(std::size_t part, std::size_t other) { return clearance_[part * others_ + other]; }
  double clearance(std::size_t part, std::size_t other) const { return clearance_[part * others_ + other]; }
  bool may_touch(std::size_t part, std::size_t other) const;
  // Of a point from another part or side; beyond `reach` it may be infinite.
  double distance(std::size_t other, const Sides& sides, const Vec3& at, double reach) const;
  Vec3 normal(std::size_t other, const Vec3& at) const;
  Vec3 in_domain(std::size_t other, Vec3 at) const;

  const Scene& scene_;
  const Resolution& resolution_;
  const BodyWalls& walls_;
  std::size_t parts_ = 0, others_ = 0;
  std::vector<Point> points_;
  std::vector<double> radius_;     // of each part about its pivot
  std::vector<double> clearance_;  // of each part from each other and from sides
};

}  // namespace spume
