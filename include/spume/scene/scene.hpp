// SPDX-License-Identifier: MIT
// The scene: what a method needs to know of a case, in numbers. One unit system throughout: a case in
// non-dimensional groups arrives as density 1, viscosity 1/Re, gravity 1/Fr^2, sound speed 1/Ma.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/vec3.hpp"
#include "spume/geometry/rigid_place.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume {

// A compiled expression of x, y, z and t. Copies share nothing, so each thread may own one.
class Expression {
 public:
  virtual ~Expression() = default;
  virtual double operator()(double x, double y, double z, double t) const = 0;
  virtual std::unique_ptr<Expression> clone() const = 0;
};

// One expression per dimension; a null component is zero.
struct VectorExpression {
  std::array<std::shared_ptr<const Expression>, 3> component;
  Vec3 operator()(const Vec3& position, double t) const;  // not thread-safe: clone per thread
  VectorExpression clone() const;
};

enum class BoundaryKind { periodic, free_slip, no_slip, open };

// scene/wave_absorption.hpp
struct AbsorptionLaw {
  double gain = 0, smoothing = 0, drift = 0;  // 1/time, time, time
};

// A moving wall that takes up the waves that come to it.
struct WaveAbsorption {
  AbsorptionLaw law;
  double still = 0;                             // height of the still surface
  std::shared_ptr<const Expression> elevation;  // above it, of the waves that the wall makes; null: it makes none
};

// One side of the domain. `velocity` (walls only) may have a normal component: the wall then moves, and its
// displacement is the time integral of that component.
struct Side {
  BoundaryKind kind = BoundaryKind::open;
  std::optional<VectorExpression> velocity;
  std::optional<WaveAbsorption> absorption;  // along x, of walls that move
  bool opening = false;  // an opening covers all of it: the kind is open, and the liquid goes on behind it
  bool bounds_liquid() const { return kind != BoundaryKind::open || opening; }
};

// An [[inflow]] or [[outflow]]: a part of a side that liquid passes.
struct Opening {
  std::string name;                         // "inflow.0"
  bool inflow = true;                       // else an outflow
  int axis = 0, side = 0;                   // sides[axis][side] of the domain
  Vec3 lower{}, upper{};                    // box on the side that it lies in
  std::shared_ptr<const Expression> where;  // positive in it; null: in the whole box
  // Inflow: the velocity, or the volume per time.
  std::optional<VectorExpression> velocity;
  std::shared_ptr<const Expression> flow_rate;
  std::size_t phase = 0;                       // of what enters
  std::shared_ptr<const Expression> pressure;  // outflow, at the level where there is one; null: zero
  // Height of the surface: liquid enters below it; the pressure out is hydrostatic from it on. Null: none.
  std::shared_ptr<const Expression> level;
};

// A solid box inside the domain. Faces that lie on or beyond a wall of the domain bound no liquid.
struct SolidBox {
  Vec3 lower{}, upper{};
  BoundaryKind kind = BoundaryKind::free_slip;
};

// A [[body]]: a shape, and what it is for.
struct Body {
  std::string name;
  std::string kind;    // "box", ..., "expression", "mesh"
  ShapePointer shape;  // where it stands; what `[[liquid]] body` fills
  ShapePointer solid;  // the shape, or with inside = false what lies outside
  bool inside = true;
  bool subtract = false;                          // taken away from the walls of the bodies before it
  BoundaryKind wall = BoundaryKind::free_slip;    // open: it is no wall
  std::optional<VectorExpression> velocity = {};  // of its surface, which slides along itself
  std::optional<std::size_t> motion = {};         // among the motions of the scene; none: it stands still
  ShapePointer alone = {};  // of a moving body: its solid at the start without copies beyond periodic sides
};

// A body that comes back: it sets out at `first` and every `cycle` after it, and is taken away after `duration`; in
// between it is not there. The copies of an entry of the case set out one after another.
struct Release {
  double first = 0, cycle = 0, duration = 0;  // cycle >= duration
  double growth = 0;                          // its lengths are s (2 - s) of their last in this time, s the share of it
  double shrinkage = 0;                       // the same backwards, before it is taken away
  bool grows() const { return growth > 0 || shrinkage > 0; }
  std::size_t copy = 0, copies = 1;
};

// Bodies that move as one: as is given, or floating.
struct BodyMotion {
  std::vector<std::size_t> bodies;  // in their order
  Vec3 pivot{};                     // at the start
  // Given: way from the start and angle in degrees about an axis of length 1.
  VectorExpression displacement;
  std::shared_ptr<const Expression> angle;
  Vec3 axis{0, 0, 1};
  double time_scale = 1;                // that differences in time are short against
  std::optional<Release> release = {};  // displacement and angle are then of the time since the body set out
  // Floating about its centre of mass, the pivot.
  bool floats = false;
  double mass = 0;
  RotationMatrix inertia{};         // about the pivot, at the start
  Vec3 free_along{}, free_about{};  // 1 or 0 per axis
  double restitution = 0;           // of an impact: speed apart over speed of approach
  bool turns() const { return floats ? free_about != Vec3{} : angle != nullptr; }
};

// Where bodies with a given motion are at time t, with the start as reference. Their velocities are differences over
// 1e-7 time scales of fourth order. A body that waits for its release has none, and no size.
RigidPlace given_place(const BodyMotion& motion, double t);

// The parts of the way between two times, from one place to another; where a released body is not there it has none.
std::vector<std::array<RigidPlace, 2>> ways_between(const BodyMotion& motion, double from, double to);

// A layer beside a side of the domain in which the velocity is damped, d being the distance from that side:
// du/dt = -strength (1 - d / length)^2 (u - velocity).
struct Sponge {
  int axis = 0, side = 0;  // sides[axis][side] of the domain
  double length = 0;
  double strength = 0;  // 1/time
  Vec3 velocity{};
};

struct Domain {
  int dimensions = 3;
  Vec3 lower{}, upper{};                     // the third entry is 0 in two dimensions
  std::array<std::array<Side, 2>, 3> sides;  // sides[axis][0] at lower, [1] at upper
  std::vector<SolidBox> boxes;
  bool periodic(int axis) const { return sides[axis][0].kind == BoundaryKind::periodic; }
  // x along an axis, of places beyond periodic sides that between them. Expressions are asked there.
  double inside(int axis, double x) const;
  Vec3 inside(Vec3 place) const;
  Vec3 shortest(Vec3 way) const;  // of a way and its images
};

// What methods of one fluid solve for, gravity included; its viscosity is kinematic, as groups and equations give it.
struct Fluid {
  double density = 1;
  double kinematic_viscosity = 0;
  double sound_speed = 0;  // 0: incompressible
  Vec3 gravity{};          // uniform acceleration, points along minus the last axis; zero without gravity
};

// One of the fluids of a scene with several, as [[phase]] gives it. Not a Fluid: stresses at an interface need dynamic
// viscosities, gravity belongs to the scene, and a density that is not given is an error.
struct Phase {
  std::string name;
  double density = 0;
  double viscosity = 0;    // dynamic
  double sound_speed = 0;  // 0: incompressible, or left to the method
  double exponent = 0;     // of the equation of state; 0: left to the method
};

// Liquid particles at the start, one array per component (z arrays are empty in two dimensions).
struct InitialParticles {
  std::array<Array<double>, 3> position;
  std::array<Array<double>, 3> velocity;
  Array<std::int32_t> region;  // index of the [[liquid]] or [[region]] entry
  Array<std::int32_t> phase;   // index into Scene::phases; empty in a scene of one fluid
  double volume = 0;           // of every particle
  std::size_t size() const { return position[0].size(); }
};

// What a region asks for and what its particles hold.
struct RegionFill {
  std::string name;           // "liquid.0", or that of a phase
  double asked = 0, got = 0;  // volumes
  std::size_t particles = 0;
  bool flat = false;  // a box: its surface is level
};

struct Scene {
  std::string title;
  std::string method;
  Domain domain;
  Fluid fluid;                                         // with phases: the first, and the gravity of all
  std::vector<Phase> phases;                           // of methods that take several; empty: `fluid` alone
  double surface_tension = 0;                          // between the phases
  double spacing = 0;                                  // of particles; on a grid the smallest of the three
  std::array<std::size_t, 3> grid{};                   // points along x, y, z; zero for particle methods
  bool free_surface = false;                           // false: the liquid fills a closed or periodic domain
  std::optional<VectorExpression> body_force;          // acceleration, beside gravity
  std::optional<VectorExpression> initial_velocity;    // of a flow on a grid
  std::shared_ptr<const Expression> initial_spectrum;  // E(k) up to a factor; its first argument is k
  std::uint64_t seed = 1;
  InitialParticles particles;
  std::vector<RegionFill> fills;  // of the [[liquid]] entries, or of the phases
  std::vector<Body> bodies;
  std::vector<BodyMotion> motions;
  Combination walls;  // of the bodies that are walls, in their order, where they stand at the start
  std::vector<Sponge> sponges;
  std::vector<Opening> openings;
};

}  // namespace spume
