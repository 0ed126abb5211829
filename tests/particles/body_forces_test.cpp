// SPDX-License-Identifier: MIT
#include "spume/particles/body_forces.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "particles/walled.hpp"

namespace spume::test {
namespace {

// A box a fifth of a spacing over the floor, in liquid of one pressure but for that of one particle, which stands in
// the gap below it, or somewhere else.
Vec3 force_beside(const Vec3& place, double pressure) {
  Walled walled(scene_text("lower = [-1, -1]\nupper = [1, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\nbottom = "
                           "\"free-slip\"\n",
                           0.05, "[[body]]\nshape = \"box\"\nsize = [0.6, 0.4]\nposition = [0, -0.79]\n"),
                0);
  ParticleStore& particles = walled.particles;
  for (int axis = 0; axis < 2; ++axis) (*particles.position[axis])[0] = place[axis];
  walled.arrangement.sort(particles, particles.position);
  BodyForces::Fields fields(walled.arrangement, particles, walled.boundary.walls);
  fields.density = [](std::size_t) { return 1.0; };
  fields.pressure = [&](std::size_t i) { return walled.place(i) == place ? pressure : 1.0; };
  return BodyForces(walled.scene(), walled.resolution, *walled.boundary.bodies()).measure(fields, 0)[0].pressure;
}

}  // namespace

// One pressure all around moves no body; in the gap it is that beside the gap. What is crushed in it, below a quarter
// of a spacing, has pressures of any size.
TEST(BodyForces, AParticleCrushedBelowABodyTellsNoPressure) {
  const double width = 0.6;
  for (const double pressure : {1.0, 1000.0}) {
    const Vec3 force = force_beside({0.02, -0.995, 0}, pressure);
    EXPECT_NEAR(force[0], 0, 1e-9) << pressure;
    EXPECT_NEAR(force[1], 0, 1e-3 * width) << pressure;
  }
  // Above the box it counts.
  EXPECT_GT(std::abs(force_beside({0.02, -0.56, 0}, 1000)[1]), 1);
}

}  // namespace spume::test
