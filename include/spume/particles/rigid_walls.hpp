// SPDX-License-Identifier: MIT
// The walls of bodies that move as one, or of all that stand still: distances from them and the points behind them, in
// the coordinates of the start, asked for where the bodies are now. Bodies that grow have wall points for several of
// their sizes, so that these lie a spacing apart in all of them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "spume/particles/distance_cells.hpp"
#include "spume/particles/near_distances.hpp"
#include "spume/particles/wall_points.hpp"

namespace spume {

using WallPositions = std::array<std::array<double, 2>, 3>;  // of the sides: [axis][0 lower, 1 upper]

class RigidWalls {
 public:
  // `motion` among those of the scene, or none. The scene outlives the walls. `thin`: which of its bodies are
  // (particles/thin_bodies.hpp).
  RigidWalls(const Scene& scene, std::optional<std::size_t> motion, const Resolution& resolution,
             double particle_volume, const std::vector<std::uint8_t>& thin);
  RigidWalls(const RigidWalls&) = delete;
  RigidWalls& operator=(const RigidWalls&) = delete;

  const BodyMotion* motion() const { return motion_; }  // null: they stand still
  bool empty() const { return bodies_.empty(); }
  // Not there now, or with less than half a spacing from its middle to its farthest face.
  bool absent() const { return level_of(place.scale) == 0; }
  const std::vector<std::size_t>& bodies() const { return bodies_; }
  // From the middle to the farthest face, now, of a body that grows; of others endless.
  double half_width() const { return place.scale * half_width_; }

  bool has_thin() const { return !thin_walls_.empty(); }
  // Of its thin bodies alone.
  double thin_distance(const Vec3& point) const { return thin_walls_.distance(start(point)); }
  NearestPoint thin_nearest(const Vec3& point) const;
  NearDistances::Range thin_range(const Vec3& point) const;  // of the distance

  RigidPlace place;          // in use; without a motion it stays
  RigidPlace accepted;       // of the last state, with thin bodies
  RigidPlace behind, ahead;  // at the times of the velocities that the liquid has, and that it is to have

  // A box that the solid is in now; of endless solids it is endless.
  Bounds bounds_now() const;

  double error() const;  // a bound of that of distances from it
  double error_near(const Vec3& start,
                    double reach) const;  // the same of its bodies within reach of a place at the start
  // Negative inside; farther than four support radii from a surface a bound of it.
  double distance(const Vec3& point) const;
  double exact_distance(const Vec3& point) const {
    return absent() ? infinite : place.scale * walls_.distance(start(point));
  }
  bool surely_farther(const Vec3& point, double gap) const;
  NearestPoint nearest(const Vec3& point) const;
  // Whose surface the point lies on.
  std::size_t body_near(const Vec3& point) const { return bodies_.size() == 1 ? bodies_[0] : body_at(start(point)); }
  // Of the surface within `about` of one of its points, which moves as the walls do, the place that reaches farthest
  // along a direction, if there is one. `size`: of the walls.
  std::optional<Vec3> foremost(const Vec3& point, const Vec3& direction, double size, double about) const;
  // Of the point of the body that is now there.
  Vec3 velocity_behind(const Vec3& point) const { return behind.velocity_at(behind.now(start(point))); }
  Vec3 velocity_ahead(const Vec3& point) const { return ahead.velocity_at(ahead.now(start(point))); }
  // From the pivot, then.
  Vec3 arm_ahead(const Vec3& point) const { return subtract(ahead.now(start(point)), ahead.position); }
  Vec3 velocity_at(const Vec3& point) const {
    return motion_ == nullptr ? Vec3{} : place.velocity_at(beside_pivot(point));
  }
  // Of its periodic copies the one that is nearest to the pivot, where arms and spin are those of the whole body: exact
  // for bodies that are shorter than half a period, their reach included.
  Vec3 beside_pivot(const Vec3& point) const;

  // At the start, and the bodies that they belong to.
  const std::vector<WallPoint>& points() const { return levels_[level_].points; }
  std::size_t body_of(std::size_t point) const { return levels_[level_].body[point]; }
  const std::vector<WallPoint>& whole() const { return levels_.back().points; }  // those of the full size
  // Takes the points of the size that is nearest to that of now; none of a body that is absent.
  void choose_points();
  // The point as it is now, with the period that brings it into the domain; false where it is beyond a wall of the
  // domain, which is now at `sides`.
  bool now(std::size_t point, const WallPositions& sides, WallPoint& found) const;

  double bytes() const;

 private:
  Vec3 start(const Vec3& now) const;
  double distance_from_bounds(const Vec3& start) const;
  double distance_at_start(const Vec3& start) const;
  // Where surfaces of moving bodies are at the start, as far as they may come into the domain.
  Bounds window(double margin) const;
  Domain domain_at_start(double reach) const;
  bool keeps(int axis) const;  // the motion does not lead along it
  bool is_endless(int axis) const;
  std::size_t body_at(const Vec3& foot) const;
  bool is_thin(std::size_t body) const;
  std::size_t level_of(double scale) const;
  bool grows() const { return motion_ != nullptr && motion_->release && motion_->release->grows(); }
  // Wall points of one size, in the coordinates of the start and the full size. Level 0 is empty.
  struct Level {
    std::vector<WallPoint> points;
    std::vector<std::uint16_t> body;  // of each point, among the bodies of the scene
  };
  Level make_level(double scale, const Resolution& resolution, double particle_volume) const;

  const Scene& scene_;
  const BodyMotion* motion_ = nullptr;
  std::vector<std::size_t> bodies_;  // that are walls
  Combination walls_, thin_walls_;
  std::vector<std::uint8_t> thin_;  // of bodies_
  Bounds bounds_{};                 // of the solid
  double reach_ = 0;
  std::optional<DistanceCells> cells_;
  std::optional<NearDistances> thin_cells_;  // with thin bodies
  double half_width_ = infinite;
  std::vector<Level> levels_{1};
  std::size_t level_ = 0;
};

}  // namespace spume
