// SPDX-License-Identifier: MIT
#include "spume/particles/pockets.hpp"

#include <gtest/gtest.h>

#include "particles/walled.hpp"

namespace spume::test {
namespace {

constexpr double spacing = 0.05;

// A box turned by 20 degrees that stands on an edge above the floor of a tank.
struct Tank {
  LoadedCase loaded = load_text(
      scene_text("lower = [-1, 0]\nupper = [1, 2]\nleft = \"free-slip\"\nright = \"free-slip\"\nbottom = \"no-slip\"\n",
                 spacing, "[[body]]\nshape = \"box\"\nsize = [0.8, 0.8]\nposition = [0, 0.52]\nrotation = [20]\n"));
  Resolution resolution{2, spacing, KernelKind::wendland_c2, 1.3};
  Boundary boundary{loaded.scene.domain, spacing, make_body_walls(loaded.scene, resolution)};
  // Where the face at 20 degrees, right of the lowest corner, is so high above the floor.
  Vec3 under_face(double height, double share) const {
    const Vec3 corner{-0.4 * std::cos(angle) + 0.4 * std::sin(angle),
                      0.52 - 0.4 * std::sin(angle) - 0.4 * std::cos(angle), 0};
    return {corner[0] + (height - corner[1]) / std::tan(angle), share * height, 0};
  }
  static constexpr double angle = 20 * std::numbers::pi / 180;
};

// A ball of half a spacing, less a fifth, touches both where they are 1 / cos^2(10 degrees) spacings apart, and is up
// to a radius away.
TEST(Pockets, AParticleHasRoomWhereABallFits) {
  const Tank tank;
  EXPECT_FALSE(has_room(tank.boundary, tank.under_face(0.6 * spacing, 0.5)));
  EXPECT_TRUE(has_room(tank.boundary, tank.under_face(1.2 * spacing, 0.5)));
  EXPECT_TRUE(has_room(tank.boundary, tank.under_face(1.2 * spacing, 0.1)));
  EXPECT_TRUE(has_room(tank.boundary, {-0.9, 0.3, 0}));
  EXPECT_FALSE(in_one_layer(tank.boundary, tank.under_face(2.3 * spacing, 0.5)));
  EXPECT_TRUE(in_one_layer(tank.boundary, tank.under_face(1.8 * spacing, 0.5)));
  EXPECT_FALSE(in_one_layer(tank.boundary, {-0.9, 0.3, 0}));
}

TEST(Pockets, ParticlesAreLedOutOfWedges) {
  const Tank tank;
  const BodyWalls& box = *tank.boundary.bodies();
  Vec3 place = tank.under_face(0.5 * spacing, 0.4), velocity{-1, 0.2, 0};
  const Vec3 before = place;
  lead_out_of_wedges(tank.boundary, place, &velocity);
  EXPECT_GT(place[0], before[0]);
  // Between parallels through its foot: to first order in the angle.
  EXPECT_NEAR(box.distance(place) + place[1], 0.6 * spacing, 0.02 * spacing);
  const Vec3 outwards{std::sin(Tank::angle), 1 - std::cos(Tank::angle), 0};
  EXPECT_NEAR(dot(velocity, outwards), 0, 1e-12);
  const Vec3 along{-outwards[1], outwards[0], 0};
  EXPECT_NEAR(dot(velocity, along), dot(Vec3{-1, 0.2, 0}, along), 1e-12);

  velocity = {1, 0, 0};  // on its way out
  place = before;
  lead_out_of_wedges(tank.boundary, place, &velocity);
  EXPECT_EQ(velocity[0], 1);
}

// In wide gaps, before a single face, at the steep face of an obtuse corner, and between parallels.
TEST(Pockets, OtherPlacesAreLeft) {
  const Tank tank;
  const Vec3 beside{-0.4 * std::cos(Tank::angle) + 0.4 * std::sin(Tank::angle) - 0.3 * spacing, 0.5 * spacing, 0};
  for (const Vec3& at : {tank.under_face(0.7 * spacing, 0.5), beside, Vec3{-0.9, 0.01, 0}, Vec3{0, 1.2, 0}}) {
    Vec3 place = at, velocity{-1, -1, 0};
    lead_out_of_wedges(tank.boundary, place, &velocity);
    EXPECT_EQ(place, at);
    EXPECT_EQ(velocity, (Vec3{-1, -1, 0}));
  }
  const LoadedCase slot = load_text(
      scene_text("lower = [-1, 0]\nupper = [1, 2]\nbottom = \"no-slip\"\nleft = \"free-slip\"\nright = \"free-slip\"\n",
                 spacing, "[[body]]\nshape = \"box\"\nsize = [0.8, 0.8]\nposition = [0, 0.42]\n"));
  const Resolution resolution(2, spacing, KernelKind::wendland_c2, 1.3);
  const Boundary boundary(slot.scene.domain, spacing, make_body_walls(slot.scene, resolution));
  Vec3 place{0.1, 0.01, 0};
  lead_out_of_wedges(boundary, place, nullptr);
  EXPECT_EQ(place, (Vec3{0.1, 0.01, 0}));
}

// Boxes 0.3 and 0.45 spacings above the floor, whose edges round which a wedge is 0.6 spacings wide end the slot.
TEST(Pockets, ParticlesAreLedOutOfSlots) {
  const std::string plane =
      "lower = [-1, 0]\nupper = [1, 2]\nbottom = \"no-slip\"\nleft = \"free-slip\"\nright = \"free-slip\"\n";
  const std::string space =
      "lower = [-1, -1, 0]\nupper = [1, 1, 2]\nbottom = \"no-slip\"\nleft = \"free-slip\"\nright = \"free-slip\"\n"
      "front = \"free-slip\"\nback = \"free-slip\"\n";
  for (const auto& [d, height] : {std::pair{2, 0.3}, {2, 0.45}, {3, 0.3}, {3, 0.45}}) {
    const std::string middle = std::to_string(0.4 + height * spacing);
    const LoadedCase slot = load_text(
        scene_text(d == 2 ? plane : space, spacing,
                   d == 2 ? "[[body]]\nshape = \"box\"\nsize = [0.8, 0.8]\nposition = [0, " + middle + "]\n"
                          : "[[body]]\nshape = \"box\"\nsize = [0.8, 0.8, 0.8]\nposition = [0, 0, " + middle + "]\n"));
    const Resolution resolution(d, spacing, KernelKind::wendland_c2, 1.3);
    const Boundary boundary(slot.scene.domain, spacing, make_body_walls(slot.scene, resolution));
    const auto up = static_cast<std::size_t>(d) - 1;
    for (const double side : {-1.0, 1.0}) {
      Vec3 place{side * (0.4 - 0.1 * spacing)}, velocity{-side, 0.3};
      place[up] = 0.4 * height * spacing;
      const Vec3 before = place;
      lead_out_of_wedges(boundary, place, &velocity);
      EXPECT_GT(side * place[0], 0.4);
      EXPECT_LT(side * place[0], 0.4 + 0.6 * spacing);
      EXPECT_EQ(place[up], before[up]);
      EXPECT_NEAR(velocity[0], 0, 1e-12);
      EXPECT_NEAR(velocity[1], 0.3, 1e-12);
      // As far as spray goes in a step, where no rows of the start may stand.
      Vec3 deep = before;
      deep[0] -= side * 1.2 * spacing;
      lead_out_of_wedges(boundary, deep, nullptr);
      EXPECT_NEAR(deep[0], height < 0.4 ? place[0] : before[0] - side * 1.2 * spacing, 1e-3 * spacing);
      // To the mouth and no farther.
      const Vec3 led = place;
      lead_out_of_wedges(boundary, place, nullptr);
      EXPECT_EQ(place, led);
      place[0] -= side * 2e-3 * spacing;
      lead_out_of_wedges(boundary, place, nullptr);
      EXPECT_NEAR(place[0], led[0], 3e-3 * spacing);
    }
  }
}

// Where a slot between two boxes meets that below them, the box across is entered by its side, though its lower face is
// nearer to what is behind that.
TEST(Pockets, TheWallAcrossASlotIsTheFaceBeforeIt) {
  const LoadedCase loaded = load_text(scene_text(
      "lower = [-1, 0]\nupper = [1, 2]\nleft = \"free-slip\"\nright = \"free-slip\"\nbottom = \"free-slip\"\n", spacing,
      "[[body]]\nshape = \"box\"\nsize = [0.6, 0.6]\nposition = [-0.28, 0.315]\n[[body]]\nshape = "
      "\"box\"\nsize = [0.6, 0.6]\nposition = [0.33, 0.315]\n"));
  const Resolution resolution(2, spacing, KernelKind::wendland_c2, 1.3);
  const Boundary boundary(loaded.scene.domain, spacing, make_body_walls(loaded.scene, resolution));
  const std::optional<WallBehind> across = wall_across(boundary, {0.029, 0.025, 0}, 0.6 * spacing);
  ASSERT_TRUE(across.has_value());
  EXPECT_NEAR(across->normal[0], 1, 1e-9);
  EXPECT_NEAR(across->behind, 0.6 * spacing - 0.01, 0.01 * spacing);
  for (std::size_t i = 0; i < loaded.scene.particles.size(); ++i) {
    const double x = loaded.scene.particles.position[0][i] - 0.025, y = loaded.scene.particles.position[1][i];
    EXPECT_FALSE((std::abs(x) < 0.605 && y < 0.015) || (std::abs(x) < 0.005 && y < 0.615)) << x << ' ' << y;
  }
}

// An edge 0.2 spacings from a wall: what comes past it from above goes back, what was below is led farther down, and
// so is what comes along the face.
TEST(Pockets, NothingComesThroughAThroat) {
  const LoadedCase loaded = load_text(scene_text(
      "lower = [-1, 0]\nupper = [1, 2]\nleft = \"free-slip\"\nright = \"free-slip\"\nbottom = \"free-slip\"\n", spacing,
      "[[body]]\nshape = \"box\"\nsize = [0.6, 0.6]\nposition = [0.5657359313, 1]\nrotation = [45]\n"));
  const Resolution resolution(2, spacing, KernelKind::wendland_c2, 1.3);
  const Boundary boundary(loaded.scene.domain, spacing, make_body_walls(loaded.scene, resolution));
  const auto led = [&](const Vec3& from, Vec3 place, Vec3& velocity) {
    lead_out_of_wedges(boundary, place, &velocity, &from);
    return place;
  };
  const Vec3 above{0.992, 1.012, 0}, below{0.995, 0.996, 0};
  Vec3 velocity{0.1, -1, 0};
  const Vec3 back = led(above, below, velocity);
  for (std::size_t axis = 0; axis < 2; ++axis) EXPECT_NEAR(back[axis], above[axis], 1e-12);
  EXPECT_GE(dot(velocity, subtract(above, below)), -1e-12);
  velocity = {0, -1, 0};
  EXPECT_LT(led({0.995, 0.98, 0}, below, velocity)[1], below[1]);
  EXPECT_EQ(velocity[1], -1);
  EXPECT_LT(led({0.995, 0.995, 0}, below, velocity)[1], below[1]);
  // A body that moves has come over where the way began.
  const Vec3 covered{0.989, 1.0009, 0};
  ASSERT_LT(boundary.bodies()->distance(covered), 0);
  EXPECT_LT(led(covered, below, velocity)[1], below[1]);
}

// Bubbles, for which a place that is moved is one where they have struck a wall, are not.
TEST(Pockets, LiquidAloneIsLedOut) {
  const Tank tank;
  const Vec3 in_wedge = tank.under_face(0.5 * spacing, 0.4);
  Vec3 bubble = in_wedge, liquid = in_wedge;
  tank.boundary.apply_walls(tank.boundary.walls, bubble, nullptr);
  tank.boundary.hold_liquid(tank.boundary.walls, liquid, nullptr);
  EXPECT_EQ(bubble, in_wedge);
  EXPECT_GT(liquid[0], in_wedge[0]);
}

// Out of the wedge before one side of a corner, aslant, lies what is behind another.
TEST(Pockets, LiquidIsHeldInCornersInSpace) {
  const Resolution resolution(3, spacing, KernelKind::wendland_c2, 1.3);
  int moved = 0;
  for (int k = 0; k < 20; ++k) {
    const std::string turns = "[" + std::to_string(5 + 17 * k % 80) + ", " + std::to_string(10 + 29 * k % 70) + ", " +
                              std::to_string(3 + 41 * k % 85) + "]";
    const LoadedCase corner =
        load_text(scene_text("lower = [0, 0, 0]\nupper = [1, 1, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\n"
                             "front = \"free-slip\"\nback = \"free-slip\"\nbottom = \"no-slip\"\n",
                             spacing,
                             "[[body]]\nshape = \"box\"\nsize = [0.4, 0.4, 0.4]\nposition = [0.22, 0.22, 0.22]\n"
                             "rotation = " +
                                 turns + "\n"));
    const Boundary boundary(corner.scene.domain, spacing, make_body_walls(corner.scene, resolution));
    for (int n = 0; n < 1000; ++n) {
      const Vec3 start{(n % 10 + 0.5) * 0.005, (n / 10 % 10 + 0.5) * 0.005, (n / 100 + 0.5) * 0.005};
      Vec3 walled = start, held = start;
      boundary.apply_walls(boundary.walls, walled, nullptr);
      boundary.hold_liquid(boundary.walls, held, nullptr);
      moved += held != walled ? 1 : 0;
      for (int axis = 0; axis < 3; ++axis) ASSERT_GE(held[axis], 0) << turns << n;
    }
  }
  EXPECT_GT(moved, 100);
}

}  // namespace
}  // namespace spume::test
