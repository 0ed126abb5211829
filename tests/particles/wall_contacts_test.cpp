// SPDX-License-Identifier: MIT
#include "spume/particles/wall_contacts.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "particles/walled.hpp"

namespace spume::test {
namespace {

constexpr double spacing = 0.05;
// What walls keep free before them: 1e-3 spacings.
constexpr double gap = 1e-3 * spacing;

// A box turned by 20 degrees that stands on an edge above the floor: right of it face and floor make a wedge.
struct Wedge {
  explicit Wedge(const std::string& motion = "")
      : loaded(load_text(scene_text(
            "lower = [-1, 0]\nupper = [1, 2]\nx = \"periodic\"\nbottom = \"free-slip\"\n", spacing,
            "[[body]]\nshape = \"box\"\nsize = [0.8, 0.8]\nposition = [0, 0.52]\nrotation = [20]\n" + motion))) {}
  LoadedCase loaded;
  Resolution resolution{2, spacing, KernelKind::wendland_c2, 1.3};
  Boundary boundary{loaded.scene.domain, spacing, make_body_walls(loaded.scene, resolution)};
  // On the bisector of the wedge, where the face is so high above the floor.
  Vec3 middle(double height) const {
    const Vec3 corner{-0.4 * std::cos(angle) + 0.4 * std::sin(angle),
                      0.52 - 0.4 * std::sin(angle) - 0.4 * std::cos(angle), 0};
    return {corner[0] + (height - corner[1]) / std::tan(angle), height / 2, 0};
  }
  // Before the upper face, so far from it.
  Vec3 before_face(double distance) const {
    return {-(0.4 + distance) * std::sin(angle), 0.52 + (0.4 + distance) * std::cos(angle), 0};
  }
  static constexpr double angle = 20 * std::numbers::pi / 180;
};

TEST(WallContacts, AWallBearsWhatGoesIntoItAlongItsNormal) {
  const Wedge wedge;
  const Vec3 normal{-std::sin(Wedge::angle), std::cos(Wedge::angle), 0}, along{normal[1], -normal[0], 0};
  const Vec3 place = wedge.before_face(gap), into = add(multiply(-0.1 * spacing, normal), multiply(0.05, along));
  const Vec3 outwards = direction_of_contact(wedge.boundary, place, into);
  EXPECT_NEAR(dot(outwards, normal), 1, 1e-9);
  EXPECT_EQ(direction_of_contact(wedge.boundary, place, multiply(-1, into)), Vec3{});
  EXPECT_EQ(direction_of_contact(wedge.boundary, wedge.before_face(0.5 * spacing), into), Vec3{});
}

// Particles of density 5 about a wedge, at the end of a step: velocities have half of it of the accelerations.
struct PressedParticles {
  PressedParticles(const Wedge& around, double step)
      : wedge(around), dt(step), particles(2, wedge.loaded.scene.particles), phase(particles.size()) {
    for (auto& component : values) component.resize(particles.size()), component.fill(0.0F);
    phase.fill(0);
  }
  void put(std::size_t i, const Vec3& place, const Vec3& a) {
    for (int axis = 0; axis < 2; ++axis) {
      (*particles.position[axis])[i] = place[axis];
      (*acceleration[axis])[i] = static_cast<float>(a[axis]);
      (*particles.velocity[axis])[i] = dt / 2 * a[axis];
    }
  }
  // What each body has of the first `count` of them.
  std::vector<SurfaceForce> bear(std::int32_t count) {
    std::vector<std::int32_t> near(static_cast<std::size_t>(count));
    std::iota(near.begin(), near.end(), 0);
    WallContacts contacts(wedge.boundary);
    contacts.bear(near, {particles, acceleration, ParticleLaws(laws, phase), dt});
    std::vector<SurfaceForce> forces(wedge.loaded.scene.bodies.size());
    contacts.add_to_bodies(forces);
    return forces;
  }
  Vec3 a(std::size_t i) const { return vector_at(acceleration, 2, i); }
  double mass() const { return laws[0].density * particles.volume; }

  const Wedge& wedge;
  const double dt;
  ParticleStore particles;
  std::array<Array<float>, 3> values;
  FloatVectorField acceleration{&values[0], &values[1], &values[2]};
  Array<std::int64_t> phase;
  const std::vector<PhaseLaw> laws{{.density = 5}};
};

// Two particles on the face, of which one is drawn away from it, and one half a spacing before it: of the first the
// part of its acceleration into the wall is the body's, with what its velocity has had of it.
TEST(WallContacts, BodiesBearWhatPressesOnThem) {
  const Wedge wedge;
  const Vec3 normal{-std::sin(Wedge::angle), std::cos(Wedge::angle), 0}, along{normal[1], -normal[0], 0};
  const double dt = 1e-3;
  PressedParticles pressed(wedge, dt);
  ASSERT_GT(pressed.particles.size(), 3U);
  const double mass = pressed.mass();
  const Vec3 presses = add(multiply(-7, normal), multiply(3, along)), leaves = multiply(2, normal);
  pressed.put(0, wedge.before_face(gap), presses);
  pressed.put(1, wedge.before_face(gap), leaves);
  pressed.put(2, wedge.before_face(0.5 * spacing), presses);
  const SurfaceForce force = pressed.bear(3)[0];
  // Accelerations are floats of up to 7.
  EXPECT_NEAR(dot(pressed.a(0), normal), 0, 1e-6);
  EXPECT_NEAR(dot(pressed.a(0), along), 3, 1e-6);
  EXPECT_NEAR(dot(vector_at(pressed.particles.velocity, 2, 0), normal), 0, 1e-6 * dt);
  EXPECT_NEAR(dot(pressed.a(1), normal), 2, 1e-6);
  EXPECT_NEAR(dot(pressed.a(2), normal), -7, 1e-6);
  EXPECT_NEAR(dot(force.pressure, normal), -7 * mass, 1e-6 * mass);
  EXPECT_NEAR(dot(force.pressure, along), 0, 1e-6 * mass);
  // Where it is after the step, in which it goes 3 dt^2 along the face.
  const Vec3 foot = add(wedge.before_face(0), multiply(3 * dt * dt, along));
  EXPECT_NEAR(force.pressure_torque[2], cross(foot, multiply(-7 * mass, normal))[2], 1e-6 * mass);
}

// The walls of a wedge push along their normals: what presses a particle into it along the bisector is borne by the
// body by 1 / |n + n'| and by the floor, which is none, by as much. Beside a ramp, whose corner is obtuse, the floor
// alone bears what presses on it.
TEST(WallContacts, TwoWallsShareWhatPressesIntoTheirWedge) {
  const Wedge wedge("[[body]]\nshape = \"box\"\nsize = [0.4, 0.4]\nposition = [-0.7, 0]\nrotation = [45]\n");
  PressedParticles pressed(wedge, 1e-2);
  const double half = Wedge::angle / 2, pressing = 70, mass = pressed.mass();
  const Vec3 face{std::sin(Wedge::angle), -std::cos(Wedge::angle), 0};
  pressed.put(0, wedge.middle(0.605 * spacing), {-pressing * std::cos(half), -pressing * std::sin(half), 0});
  const Vec3 force = pressed.bear(1)[0].pressure;
  // Two unit normals that make an angle of 160 degrees have a sum of 2 sin 10 degrees.
  const double share = pressing * mass / (2 * std::sin(half));
  EXPECT_NEAR(dot(force, face), -share, 0.02 * share);
  EXPECT_NEAR(cross(force, face)[2], 0, 1e-6 * share);
  pressed.put(0, {-0.7 + 0.2 * std::numbers::sqrt2 + 0.3 * spacing, 2 * gap, 0}, {0, -pressing, 0});
  for (const SurfaceForce& of_body : pressed.bear(1)) EXPECT_LT(length(of_body.pressure), 1e-9 * pressing * mass);
  EXPECT_NEAR(pressed.a(0)[1], 0, 1e-6 * pressing);  // the floor does
}

// Of a wedge between two bodies both have their part, and together what presses. The slab lies 0.4 spacings high.
TEST(WallContacts, TwoBodiesShareWhatPressesIntoTheirWedge) {
  const double top = 0.4 * spacing, half = Wedge::angle / 2, pressing = 70;
  const Wedge wedge("[[body]]\nshape = \"box\"\nsize = [1.6, 0.1]\nposition = [0, " + std::to_string(top - 0.05) +
                    "]\n");
  PressedParticles pressed(wedge, 1e-2);
  const Vec3 into{-pressing * std::cos(half), -pressing * std::sin(half), 0};
  const double height = 0.605 * spacing;
  Vec3 place = wedge.middle(top + height);
  place[1] = top + height / 2;
  pressed.put(0, place, into);
  const std::vector<SurfaceForce> forces = pressed.bear(1);
  const double force = pressing * pressed.mass();
  EXPECT_NEAR(forces[1].pressure[1], -force / (2 * std::sin(half)), 0.02 * force / half);
  EXPECT_NEAR(forces[1].pressure[0], 0, 1e-6 * force);
  const Vec3 missing = subtract(add(forces[0].pressure, forces[1].pressure), multiply(pressed.mass(), into));
  EXPECT_LT(length(missing), 0.02 * force);
}

TEST(WallContacts, AWayEndsWhereTheWallHoldsIt) {
  const Wedge wedge;
  const Vec3 from = wedge.before_face(0.3 * spacing);
  const WayToContact free = go_to_contact(wedge.boundary, from, {0.2 * spacing, 0, 0});
  EXPECT_EQ(free.end, add(from, Vec3{0.2 * spacing, 0, 0}));
  EXPECT_EQ(free.outwards, Vec3{});
  const WayToContact stopped = go_to_contact(wedge.boundary, from, {0, -0.5 * spacing, 0});
  EXPECT_NEAR(wedge.boundary.bodies()->distance(stopped.end), gap, 1e-3 * gap);
  EXPECT_NEAR(stopped.outwards[1], std::cos(Wedge::angle), 1e-6);
  // Along the wall it goes on: the free end, put back along the normal.
  EXPECT_NEAR(dot(subtract(stopped.end, from), {std::cos(Wedge::angle), std::sin(Wedge::angle), 0}),
              -0.5 * spacing * std::sin(Wedge::angle), 1e-3 * spacing);
  // At the mouth of the wedge both walls hold it back, along the bisector, before they are 0.6 spacings apart.
  const Vec3 inwards = multiply(-spacing, Vec3{std::cos(Wedge::angle / 2), std::sin(Wedge::angle / 2), 0});
  const WayToContact held = go_to_contact(wedge.boundary, wedge.middle(0.8 * spacing), inwards);
  EXPECT_LT(dot(held.outwards, inwards), -0.9 * spacing);
  EXPECT_LT(length(subtract(held.end, wedge.middle(0.6 * spacing))), 0.15 * spacing);
  // Round a periodic side nothing holds it.
  const WayToContact round = go_to_contact(wedge.boundary, {0.99, 1.5, 0}, {0.02, 0, 0});
  EXPECT_NEAR(round.end[0], 1.01, 1e-12);
  EXPECT_EQ(round.outwards, Vec3{});
}

TEST(WallContacts, MovingBodiesBearNothing) {
  const Wedge wedge("displacement = [\"0\", \"0.1*t\"]\n");
  const Vec3 place = wedge.before_face(gap);
  EXPECT_EQ(direction_of_contact(wedge.boundary, place, {0, -0.1 * spacing, 0}), Vec3{});
  EXPECT_EQ(go_to_contact(wedge.boundary, place, {0, -0.1 * spacing, 0}).outwards, Vec3{});
}

}  // namespace
}  // namespace spume::test
