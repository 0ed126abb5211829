// SPDX-License-Identifier: MIT
// Walls of bodies: surfaces of any shape that hold liquid back, by wall points behind them (particles/wall_points.hpp)
// whose values are fits to the liquid before them (operators/wall_stencils.hpp).
//
// Wall points without liquid at the place that they mirror are dry and take no part in a step. Wet are those where the
// liquid and its reflection in the tangent plane make up half of a full kernel sum, so that points end where the
// surface of the liquid does.
#pragma once

#include <vector>

#include "spume/operators/wall_stencils.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/wall_points.hpp"

namespace spume {

class BodyWalls {
 public:
  // `scene` outlives the walls.
  BodyWalls(const Scene& scene, const Resolution& resolution, double particle_volume);

  // Stencils of the wet wall points for particles in cell order at `at`, with walls as they move at time t. Throws
  // StepFailure for a wall velocity that is not finite.
  void find_stencils(const Arrangement& arrangement, const VectorField& at, double particle_volume, double t);
  const WallStencils& stencils() const { return stencils_; }
  WallPointView wet() const;
  double largest_speed() const { return largest_speed_; }  // of the surfaces at wet points

  const std::vector<Body>& bodies() const { return scene_.bodies; }
  std::size_t points() const { return points_.size(); }
  const std::vector<WallPoint>& all_points() const { return points_; }
  bool is_wet(std::size_t point) const;
  // Distance from the walls, negative inside them; farther than four support radii from a surface a bound of it.
  double distance(const Vec3& point) const;
  Vec3 normal(const Vec3& point) const { return scene_.walls.nearest(point).normal; }
  bool nearer_than(const Vec3& point, double gap) const { return !surely_farther(point, gap) && distance(point) < gap; }
  bool surely_farther(const Vec3& point, double gap) const;  // false where the cells do not tell
  // A point nearer than `gap` to a wall, or inside it, is reflected back; of its velocity what goes into the wall is
  // lost.
  // Surfaces move along themselves alone.
  void keep_outside(Vec3& position, Vec3* velocity, double gap) const;
  // Nearer than `gap` a velocity that leads to the wall faster than `speed` is no faster than it was before.
  void limit_approach(const Vec3& position, double gap, double speed, const Vec3& before, Vec3& velocity) const;

  double bytes() const;

 private:
  struct Block;
  template <int dimensions>
  void fit_block(const Arrangement& arrangement, const VectorField& at, double particle_volume, std::size_t first,
                 std::size_t last, Block& block) const;
  void set_surfaces(double t);
  std::size_t body_at(const Vec3& foot) const;

  const Scene& scene_;
  const Resolution resolution_;
  std::vector<WallPoint> points_;
  std::vector<std::uint8_t> body_;  // of each point, among the bodies of the scene
  bool moving_ = false;             // some surface has a velocity

  // Cells of two support radii, with the distance of their middle.
  std::array<double, 3> cell_lower_{};
  std::array<std::size_t, 3> cells_{1, 1, 1};
  double cell_ = 0;
  std::vector<float> middle_;
  // Cells of a spacing, with what every point in them is farther from the walls than; negative where that is unknown.
  // Around a torus of 2304 triangles the stages that keep particles outside take 14 to 31 times as long without it.
  std::array<double, 3> fine_lower_{};
  std::array<std::size_t, 3> fine_cells_{1, 1, 1};
  double fine_ = 0;
  std::vector<float> least_;

  std::vector<std::int32_t> wet_points_;
  std::array<Array<double>, 3> wet_position_;
  WallStencils stencils_;
  double largest_speed_ = 0;
};

}  // namespace spume
