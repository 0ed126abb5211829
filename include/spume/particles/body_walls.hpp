// SPDX-License-Identifier: MIT
// Walls of bodies: surfaces of any shape that hold liquid back, by wall points behind them (particles/wall_points.hpp)
// whose values are fits to the liquid before them (operators/wall_stencils.hpp).
//
// Wall points without liquid at the place that they mirror are dry and take no part in a step. Wet are those where the
// liquid and its reflection in the tangent plane make up half of a full kernel sum, so that points end where the
// surface of the liquid does.
#pragma once

#include <memory>
#include <vector>

#include "spume/operators/wall_stencils.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/moving_bounds.hpp"
#include "spume/particles/rigid_walls.hpp"
#include "spume/particles/thin_walls.hpp"

namespace spume {

class BodyWalls {
 public:
  // `scene` outlives the walls.
  BodyWalls(const Scene& scene, const Resolution& resolution, double particle_volume);

  // Where the sides of the domain are: wall points beyond them take no part. At first those of the start.
  void set_sides(const WallPositions& sides) { sides_ = sides; }
  // Bodies with a given motion stand where they are at time t; those that float where they are told to.
  void move_to(double t);
  void set_place(std::size_t motion, const RigidPlace& place, const RigidPlace& behind, const RigidPlace& ahead);
  // Of bodies that move as one.
  const RigidWalls& moving(std::size_t motion) const { return *parts_[motion + 1]; }
  // What stands still, and each motion of the scene.
  std::size_t parts() const { return parts_.size(); }
  const RigidWalls& part(std::size_t k) const { return *parts_[k]; }
  // What thin bodies hide; null without.
  ThinWalls* thin() { return thin_.get(); }
  const ThinWalls* thin() const { return thin_.get(); }
  // Of the images that were made last, whose lists follow.
  void look(Images& images);
  // Where the bodies are now is where those of the last state are.
  void accept();
  // What the surface of a body is part of.
  const RigidWalls& part_of(std::size_t body) const {
    const auto& motion = scene_.bodies[body].motion;
    return motion ? *parts_[*motion + 1] : *parts_[0];
  }

  // Of the periodic copies of a place on a body the one where it is whole: nearest to its pivot, or to the middle of
  // one that stands still.
  Vec3 whole_place(std::size_t body, const Vec3& point) const;

  // Stencils of the wet wall points for particles in cell order at `at`, with walls as they move at time t and `ahead`.
  // Throws StepFailure for a wall velocity that is not finite.
  void find_stencils(const Arrangement& arrangement, const VectorField& at, double particle_volume, double t,
                     double ahead);
  // For averages over lists of neighbours (operators/wall_averages.hpp): all points count as wet, with walls as they
  // are at time t; their stencils have no entries yet.
  void take_all_points(double t);
  // The same points where their bodies are at time t.
  void follow_points(double t);
  // The farthest that one of them goes between two times.
  double way_of_points(double from, double to) const;
  const std::array<Array<double>, 3>& acceleration() const { return acceleration_; }  // of their feet; empty: none
  std::int32_t body_of_wet(std::size_t wet_point) const {
    return body_[static_cast<std::size_t>(wet_points_[wet_point])];
  }
  WallStencils& stencils() { return stencils_; }

  // Of wet points, what the pressure behind an accelerated surface has beside that before it.
  const Array<double>& pressure_behind() const { return pressure_behind_; }
  // The same of a unit acceleration of a motion, along a direction or about it.
  double pressure_behind_unit(std::size_t wet_point, std::size_t motion, const Vec3& direction, bool turning) const;
  const WallStencils& stencils() const { return stencils_; }
  WallPointView wet() const;
  double largest_speed() const { return largest_speed_; }  // of the surfaces at wet points

  const std::vector<Body>& bodies() const { return scene_.bodies; }
  const std::vector<BodyMotion>& motions() const { return scene_.motions; }
  std::size_t points() const { return points_.size(); }
  const std::vector<WallPoint>& all_points() const { return points_; }
  bool is_wet(std::size_t point) const;
  // Distance from the walls, negative inside them; farther than four support radii from a surface a bound of it.
  double distance(const Vec3& point) const;
  bool moves_at(const Vec3& point) const { return nearest_walls(point).motion() != nullptr; }  // the nearest wall
  Vec3 normal(const Vec3& point) const { return nearest_walls(point).nearest(point).normal; }
  struct NearestWall : NearestPoint {
    std::size_t body = 0;          // among those of the scene
    double half_width = infinite;  // of a body that grows, from its middle to its farthest face, now
  };
  NearestWall nearest_wall(const Vec3& point) const;
  // The wall at most `gap` from a point, if there is one, and its velocity there.
  struct NearWall : NearestPoint {
    Vec3 velocity{};
  };
  std::optional<NearWall> wall_within(const Vec3& point, double gap) const;
  bool nearer_than(const Vec3& point, double gap) const { return !surely_farther(point, gap) && distance(point) < gap; }
  bool surely_farther(const Vec3& point, double gap) const;  // false where the cells do not tell
  // A point nearer than `gap` to a wall, or inside it, is reflected back; of its velocity what goes into the wall, as
  // that moves, is lost.
  void keep_outside(Vec3& position, Vec3* velocity, double gap) const;
  // A way from where a point was, when the bodies were where the last state has them, that leads through a thin body is
  // reflected where it enters it.
  void keep_before_thin(const Vec3& from, Vec3& position, Vec3* velocity, double gap) const;
  // Nearer than `gap` a velocity that leads to the wall faster than `speed` is no faster than it was before.
  void limit_approach(const Vec3& position, double gap, double speed, const Vec3& before, Vec3& velocity) const;

  // Along the normal at a place of a surface, the way to another wall or a side of the domain that is nearer than two
  // spacings, where one layer of particles fits between them at most; 0 where they touch, to 0.05 spacings.
  static constexpr double widest_gap = 2;
  std::optional<double> gap_before(const Vec3& foot, const Vec3& normal, const WallPositions& sides) const;

  double bytes() const;

 private:
  struct Block;
  template <int dimensions>
  void fit_block(const Arrangement& arrangement, const VectorField& at, double particle_volume, std::size_t first,
                 std::size_t last, Block& block) const;
  bool sees_mirror(const WallPoint& point, double mirror_distance) const;
  void set_surfaces(double t, double ahead);
  void place_wet_points(std::size_t from);
  void set_acceleration(double t);
  void set_pressure_behind(double duration);
  void gather_points();
  void mark_bounds();
  // Calls visit(part) for all parts that may be within the margin of the cells and are not empty; false: for all.
  template <class Visit>
  bool ask_near(const Vec3& point, Visit&& visit) const;
  struct Nearest {
    const RigidWalls* part = nullptr;
    double distance = infinite;
  };
  Nearest nearest_part(const Vec3& point) const;
  const RigidWalls& nearest_walls(const Vec3& point) const;

  const Scene& scene_;
  WallPositions sides_{};
  const Resolution resolution_;
  std::vector<std::unique_ptr<RigidWalls>> parts_;   // what stands still, and each motion of the scene
  const RigidWalls* only_ = nullptr;                 // the one of them that has walls, if there is one
  std::unique_ptr<ThinWalls> thin_;                  // null without thin bodies
  std::optional<MovingBounds> bounds_;               // of many moving parts
  std::vector<WallPoint> points_;                    // of all parts, as they are
  std::vector<std::uint16_t> body_;                  // of each point, among the bodies of the scene
  std::vector<std::array<std::int32_t, 2>> origin_;  // of the moving ones, those behind: part, and number in it
  std::size_t standing_ = 0;                         // points of what stands still, the first
  bool surfaces_move_ = false;                       // some surface has a velocity

  std::vector<std::int32_t> wet_points_;
  std::array<Array<double>, 3> wet_position_;
  WallStencils stencils_;
  Array<double> pressure_behind_;
  std::array<Array<double>, 3> acceleration_;
  double largest_speed_ = 0;
};

// Null where no body is a wall.
std::unique_ptr<BodyWalls> make_body_walls(const Scene& scene, const Resolution& resolution);

}  // namespace spume
