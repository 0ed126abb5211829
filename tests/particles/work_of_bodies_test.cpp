// SPDX-License-Identifier: MIT
#include "spume/particles/work_of_bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "particles/walled.hpp"

namespace spume::test {
namespace {

const std::string box_that_moves =
    "[[body]]\nshape = \"box\"\nsize = [0.5, 0.4]\nposition = [0.1, 0.2]\npivot = [0.1, 0.2]\n"
    "displacement = [\"0.2*sin(3*t)\", \"0.1*t*t\"]\nangle = \"90*t\"\n";
const std::string box_that_rests = "[[body]]\nshape = \"box\"\nsize = [0.1, 0.2]\nposition = [0.8, 0.8]\n";

// Rows a hundredth of a second apart to t = 1. `force`: of the pivot's place.
template <class Force>
WorkOfBodies work_until_one(
    Walled& walled, Force&& force, const std::function<double(int)>& kinetic_energy = [](int) { return 0.0; }) {
  WorkOfBodies work(walled.scene());
  const double dt = 0.01;
  for (int row = 0; row <= 100; ++row) {
    walled.boundary.advance(row == 0 ? 0 : (row - 1) * dt, row == 0 ? 0 : dt);
    walled.boundary.accept();
    const BodyWalls& walls = *walled.boundary.bodies();
    work.add(row * dt, force(walls.part_of(0).place.position), walls, [&] { return kinetic_energy(row); });
  }
  return work;
}

// The box is pushed by a constant force through its pivot, half of it by viscosity, and the box at rest by another.
TEST(WorkOfBodies, OfAConstantForceIsThatAlongTheWay) {
  Walled walled(scene_text(square, 0.05, box_that_moves + box_that_rests), 0);
  const Vec3 force{3, -2, 0}, half{1.5, -1, 0};
  const WorkOfBodies work = work_until_one(walled, [&](const Vec3& pivot) {
    SurfaceForce of_box{half, half, cross(pivot, half), cross(pivot, half)}, of_other;
    of_other.press({0.8, 0.8, 0}, {100, 100, 0});
    return std::vector<SurfaceForce>{of_box, of_other};
  });
  const double done = -(force[0] * 0.2 * std::sin(3.0) + force[1] * 0.1);  // by the box on the liquid
  // The trapezoidal rule: dt^2 / 12 of the change of dP/dt, 3 * 0.2 * 9 sin(3) + 0.
  EXPECT_NEAR(work.done(), done, 1e-4 / 12 * (3 * 1.8 * std::sin(3.0)) + 1e-9);
  EXPECT_GT(work.uncertainty(), std::abs(work.done() - done));
  EXPECT_LT(work.uncertainty(), 0.15);  // 5 % of int |P| dt, 2.0, and half of dt times the variation of P, 4.7
}

TEST(WorkOfBodies, OfAConstantTorqueIsThatAboutTheTurn) {
  Walled walled(scene_text(square, 0.05, box_that_moves), 0);
  const WorkOfBodies work = work_until_one(walled, [](const Vec3&) {
    SurfaceForce couple;
    couple.pressure_torque = {0, 0, 2};
    return std::vector<SurfaceForce>{couple};
  });
  EXPECT_NEAR(work.done(), -2 * std::numbers::pi / 2, 1e-6);
}

// A box that sets out at a speed pushes the liquid at once, which the force of no row tells; one that sets out from
// rest does not.
TEST(WorkOfBodies, WhatASuddenStartGivesIsUncertain) {
  const auto uncertainty = [](const std::string& motion, const std::function<double(int)>& energy) {
    Walled walled(scene_text(square, 0.05, "[[body]]\nshape = \"box\"\nsize = [0.5, 0.4]\n" + motion), 0);
    const auto no_force = [](const Vec3&) { return std::vector<SurfaceForce>(1); };
    return work_until_one(walled, no_force, energy).uncertainty();
  };
  const auto gained = [](int row) { return row == 0 ? 1.0 : 3.0 + row; };
  EXPECT_EQ(uncertainty("displacement = [\"0.3*t\", \"0\"]\n", gained), 3);
  EXPECT_EQ(uncertainty("displacement = [\"0.3*t*t\", \"0\"]\n", gained), 0);
}

// Forces that scatter from sample to sample leave an error of the square root of their number, which is allowed for
// and not much more: a gain of a tenth of the work shows.
TEST(WorkOfBodies, OfForcesThatScatterIsAsUncertainAsTheirMean) {
  Walled walled(scene_text(square, 0.05,
                           "[[body]]\nshape = \"box\"\nsize = [0.5, 0.4]\ndisplacement = [\"0.5*t\", "
                           "\"0\"]\n"),
                0);
  WorkOfBodies work(walled.scene());
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0, 2);
  constexpr int samples = 1000;
  constexpr double dt = 1e-3;
  for (int k = 0; k <= samples; ++k) {
    if (k > 0) walled.boundary.advance((k - 1) * dt, dt), walled.boundary.accept();
    const std::vector<SurfaceForce> force{{{-10 - noise(generator), 0, 0}, {}, {}, {}}};
    work.add(k * dt, force, *walled.boundary.bodies(), [] { return 0.0; });
  }
  const double done = 10 * 0.5, deviation = 2 * 0.5 * dt * std::sqrt(samples);
  EXPECT_NEAR(work.done(), done, 4 * deviation);
  EXPECT_GT(work.uncertainty(), 2 * deviation);
  EXPECT_LT(work.uncertainty(), 0.05 * (done + 4 * deviation) + 6 * deviation);
}

// A row that is asked for again changes nothing.
TEST(WorkOfBodies, RowsThatAreTakenAgainCountOnce) {
  Walled walled(scene_text(square, 0.05, box_that_moves), 0);
  WorkOfBodies once(walled.scene()), twice(walled.scene());
  for (int row = 0; row <= 10; ++row) {
    if (row > 0) {
      walled.boundary.advance((row - 1) * 0.1, 0.1);
      walled.boundary.accept();
    }
    const std::vector<SurfaceForce> force{{{1, 0.5, 0}, {}, {}, {}}};
    once.add(row * 0.1, force, *walled.boundary.bodies(), [] { return 0.0; });
    for (int k = 0; k < 2; ++k) twice.add(row * 0.1, force, *walled.boundary.bodies(), [] { return 0.0; });
  }
  EXPECT_EQ(once.done(), twice.done());
  EXPECT_EQ(once.uncertainty(), twice.uncertainty());
  EXPECT_NE(once.done(), 0);
}

TEST(WorkOfBodies, IsNotToldOfBeltsOfWhatIsReleasedAndOfFloatsBesideMovingWalls) {
  const auto tells = [](const std::string& bodies) {
    return WorkOfBodies::tells_all(load_text(scene_text(square, 0.05, bodies)).scene);
  };
  const std::string floats =
      "[[body]]\nshape = \"ball\"\nradius = 0.2\nposition = [-0.5, -0.5]\ndensity = 2\n"
      "free = [\"x\", \"y\"]\n";
  EXPECT_TRUE(tells(box_that_moves + box_that_rests));
  EXPECT_TRUE(tells(box_that_rests + floats));
  EXPECT_FALSE(tells(box_that_moves + floats));
  EXPECT_FALSE(tells(box_that_moves + pipe));
}

}  // namespace
}  // namespace spume::test
