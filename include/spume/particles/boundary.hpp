// SPDX-License-Identifier: MIT
// The sides of the domain and the solid boxes in it: where they are, how images of particles mirror values in them, and
// what keeps points inside.
//
// Flat walls are mirrors: a particle within a support radius has an image behind the wall. Its velocity follows the
// kind of the wall (free-slip: the normal component is reversed; no-slip: all are) and the motion of the wall. Boxes
// and walls are one solid, whose faces are those that liquid wets (scene/solid_union.hpp).
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "spume/core/saved_state.hpp"
#include "spume/neighbours/images.hpp"
#include "spume/operators/image_values.hpp"
#include "spume/particles/absorbing_walls.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/body_walls.hpp"
#include "spume/particles/open_gates.hpp"
#include "spume/particles/open_sides.hpp"
#include "spume/scene/scene.hpp"
#include "spume/scene/solid_union.hpp"

namespace spume {

inline bool is_wall(BoundaryKind kind) {
  return kind == BoundaryKind::free_slip || kind == BoundaryKind::no_slip;
}

// What the boundaries of a domain ask for.
struct BoundaryFeatures {
  explicit BoundaryFeatures(const Domain& domain, const std::vector<Body>& bodies = {},
                            const std::vector<Opening>& openings = {});
  bool images = false;            // some side is periodic or a wall, or there are solid boxes
  bool bodies = false;            // some body is a wall
  bool openings = false;          // liquid enters or leaves
  bool outflow = false;           // where the pressure is given
  bool moving_bodies = false;     // the surface of some of them moves
  bool displaced_bodies = false;  // some body does
  bool no_slip = false;           // some wall or solid holds the liquid
  bool moving_walls = false;      // some wall has a velocity
  bool displaced_walls = false;   // some wall velocity has a normal component
  bool absorbing_walls = false;   // some of these take up waves
};

// Times of a step at which walls are asked for their velocities.
struct WallTimes {
  double place = 0;     // of the images, and of what openings give
  double velocity = 0;  // of the velocities that the liquid has
  double ahead = 0;     // of those that the pressure of the step makes; the same: walls are not accelerated
};

class Boundary {
 public:
  // `domain` outlives the boundary.
  // `bodies`: null without walls of bodies.
  // `openings`: null without. `gates`: of openings behind which particles stand instead, outlive it; null without.
  Boundary(const Domain& domain, double spacing, std::unique_ptr<BodyWalls> bodies = nullptr,
           std::unique_ptr<OpenSides> openings = nullptr, const OpenGates* gates = nullptr);

  const Domain& domain() const { return domain_; }
  const BoundaryFeatures features;
  WallPositions walls{};       // at the start of the step; state between steps
  WallPositions next_walls{};  // at its end
  // Largest speed of the moving walls where images see them: of the accepted step (state), and of this one.
  bool find_nearest_images = false;  // ImagePath::nearest, which bubbles ask for
  double wall_speed = 0, next_wall_speed = 0;

  // Before the step moves them: walls and boxes as they are at its start.
  void return_walls();

  // Wall planes at t + dt from the time integral of the walls' normal velocities: `next_walls`.
  void advance(double t, double dt);
  void accept() {
    walls = next_walls;
    wall_speed = next_wall_speed;
    if (bodies_ != nullptr) bodies_->accept();
    if (openings_ != nullptr) openings_->accept();
    if (absorbing_ != nullptr) absorbing_->accept();
  }

  // Velocity of a wall of the domain that moves, at a time of the step: as given, and what takes up waves.
  Vec3 wall_velocity(int axis, int side, const Vec3& at, double t) const {
    return with_correction((*domain_.sides[axis][side].velocity)(at, t), axis, side, t);
  }

  // The velocity that a wall is given, with what it takes up waves by.
  Vec3 with_correction(Vec3 velocity, int axis, int side, double t) const {
    if (axis == 0 && domain_.sides[axis][side].absorption) velocity[0] += absorbing_->velocity(side, t);
    return velocity;
  }

  // What the left and the right wall have of it to take up waves.
  std::array<double, 2> absorption_at(double t) const {
    if (absorbing_ == nullptr) return {};
    return {absorbing_->velocity(0, t), absorbing_->velocity(1, t)};
  }

  // Images at `at` for walls at `next_walls`, and how they mirror values. Throws StepFailure for a wall
  // velocity that is not finite. `find_wet` false keeps the wet wall points of bodies as they are, for arrangements
  // that hardly differ and images that stand for places alone.
  void make_images(Arrangement& arrangement, ParticleStore& particles, const VectorField& at,
                   double largest_length_ratio, const WallTimes& times, bool find_wet = true);
  // The images that there are, of particles that have moved to `at`, for walls at `next_walls`; then the arrangement
  // there. Precondition: as of Images::move().
  void move_images(Arrangement& arrangement, const std::array<const double*, 3>& at, const WallTimes& times);
  ImageRules image_rules(double support_radius) const;

  // How images change velocities: under friction, and with walls holding the liquid back along their normals alone,
  // which is what mass and volume depend on. Rates of volume under the rule of friction are not adjoint to the pressure
  // gradient, which sees mirror images: liquid in the edge of two no-slip walls below a surface gained speed without
  // bound, and that in a cavity left its lid (by an eighth of its density, which took 4 % off the circulation at
  // 40 x 40, against 0.4 %).
  const VelocityImageRule& velocity_rule() const { return velocity_rule_; }
  const VelocityImageRule& volume_rule() const { return features.no_slip ? mirror_rule_ : velocity_rule_; }
  // Beside those of their sources; empty where no wall is accelerated.
  std::span<double> image_pressure() { return {image_pressure_.data(), image_pressure_.size()}; }
  BodyWalls* bodies() { return bodies_.get(); }
  // Of geometric vectors, per path of the images.
  const std::vector<std::array<float, 3>>& reflection() const { return reflection_; }
  ImageMap image_map(const Images& images) const { return {images, velocity_rule_, reflection_}; }

  // Walls of bodies; null without.
  const BodyWalls* bodies() const { return bodies_.get(); }
  AbsorbingWalls* absorbing() const { return absorbing_.get(); }  // null without
  // Null without.
  OpenSides* openings() const { return openings_.get(); }
  // Whether a place on a side of the domain is in an opening.
  bool open_at(int axis, int side, const Vec3& place) const {
    return gates_ != nullptr && gates_->open_at(axis, side, place);
  }
  // Behind openings, for the images as they are: pressure gradients by OpenSides::give_gradients(), of a predicted
  // velocity whose images then follow predicted_rule().
  void give_gradients(const std::array<const double*, 3>& before, const std::array<const double*, 3>& after,
                      double dt) {
    openings_->give_gradients(before, after, dt, stencils_);
  }
  VelocityImageRule predicted_rule() const;
  // Pressures behind openings, for the images as they are: OpenSides::give_pressures().
  void give_pressures(const std::function<double(const Vec3&)>& potential, double t) {
    openings_->give_pressures(potential, t, stencils_);
  }
  // `walls` in a checkpoint at time t. load_walls() throws FileError for another number of them.
  void save_walls(StateWriter& writer) const;
  void load_walls(StateReader& reader, double t);
  // The points behind outflows move on with this velocity.
  void follow(const std::array<const double*, 3>& velocity) { openings_->follow(stencils_, velocity); }
  // Whether a side ends the multigrid as a wall does: inflows have no pressure gradient either.
  bool holds(int axis, int side) const;

  // Walls and boxes as one solid; null without boxes.
  const SolidUnion* solids() const { return solids_.get(); }

  double spacing() const { return spacing_; }
  // Boxes and bodies in the domain, and whether one of them is nearer than `reach` to a point.
  bool has_obstacles() const { return solids_ != nullptr || bodies_ != nullptr; }
  bool obstacle_near(const Vec3& point, double reach) const {
    return (solids_ != nullptr && !solids_->clear_around(point, reach)) ||
           (bodies_ != nullptr && bodies_->distance(point) < reach);
  }

  // Periodic wrap; a point beyond a wall or inside a solid is reflected back, its velocity too when given. `from`:
  // where it was in the last state, or since; it has passed no thin body then.
  void apply_walls(const WallPositions& at, Vec3& position, Vec3* velocity, const Vec3* from = nullptr) const;
  // The same for a particle of liquid, which is also led out of wedges between bodies and walls (pockets.hpp).
  // `wedge_from`: where it was as far as wedges are concerned; null: `from`.
  void hold_liquid(const WallPositions& at, Vec3& position, Vec3* velocity, const Vec3* from = nullptr,
                   const Vec3* wedge_from = nullptr) const;

  // How near to a wall points may come.
  double gap() const;
  // Whether apply_walls() and hold_liquid() would leave a place as it is: before all sides and far from bodies, in
  // scenes without thin bodies, solids and openings; false where that is not seen at once.
  bool clear_of_sides(const Vec3& place) const;
  // Of places first .. last - 1, which may be beyond periodic sides, for walls at `at`.
  bool clear_of_sides(const WallPositions& at, const std::array<const double*, 3>& places, std::size_t first,
                      std::size_t last) const;
  // Of places that are clear of sides what apply_walls() and hold_liquid() leave to do: they go round periodic sides.
  void go_round(const WallPositions& at, const std::array<double*, 3>& places, std::size_t first,
                std::size_t last) const;

  double bytes() const;

 private:
  bool has_no_quick_bound() const;
  bool clear_of_bodies(const Vec3& place) const;
  void keep_before_sides(const WallPositions& at, int axis, Vec3& position, Vec3* velocity) const;
  void unite_solids(const WallPositions& at);
  // Boxes and wall points of bodies as they are behind sides that are there.
  void take_walls(const WallPositions& at);
  void move_walls(double t, double dt);
  bool displaces() const { return features.displaced_walls || features.displaced_bodies; }
  void find_rules(const Images& images, double support_radius, const WallTimes& times);
  void find_offsets(const Images& images, double t, bool friction, VelocityImageRule& rule) const;
  void find_image_pressure(Arrangement& arrangement, const VectorField& at, const WallTimes& times);
  double point_place(std::size_t g, int axis) const;

  const Domain& domain_;
  double spacing_;
  std::unique_ptr<BodyWalls> bodies_;
  std::unique_ptr<OpenSides> openings_;
  const OpenGates* gates_;
  std::unique_ptr<AbsorbingWalls> absorbing_;
  // With openings: all points behind walls of bodies and openings.
  WallStencils stencils_;
  std::array<Array<double>, 3> point_position_;
  std::shared_ptr<const SolidUnion> solids_;
  VelocityImageRule velocity_rule_, mirror_rule_;  // the second in a scene with no-slip walls alone
  std::vector<std::array<float, 3>> reflection_;
  Array<double> image_pressure_;  // behind walls and bodies that are displaced
};

// The kind of a face by its code (SolidUnion::face_near).
BoundaryKind kind_of_face(const Domain& domain, int axis, int face);

// Lies strictly within a solid box: the liquid is mirrored there.
bool inside_solid(const Domain& domain, const Vec3& point);

}  // namespace spume
