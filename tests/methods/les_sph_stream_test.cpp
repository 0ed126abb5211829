// SPDX-License-Identifier: MIT
// Streams past obstacles with edges at a high Reynolds number: behind an edge the liquid parts from the wall, and what
// opens there must close without a jet.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

// Between free-slip walls, Re = 3e4 with the height of the obstacles, about ten spacings.
const std::string stream = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [60, 30]
x = "periodic"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 1
[fluid]
density = 1
viscosity = 0.01
[[liquid]]
velocity = [30, 0]
[time]
end = 2
)toml";

double kinetic_energy(const Simulation& run) {
  double sum = 0;
  for (const Vec3& u : run.state().velocity) sum += dot(u, u);
  return sum;
}

struct Course {
  double energy = 0, speed = 0;  // the largest over those of the start
};

// Over steps of courant 0.2 at three times the speed of the stream, which the edges turn into two and a half.
Course course_of(const std::string& obstacle, int steps) {
  Simulation run(stream + obstacle);
  const double start = kinetic_energy(run);
  Course course;
  for (int part = 0; part < steps; part += 10) {
    run.steps(10, 0.002);
    course.energy = std::max(course.energy, kinetic_energy(run) / start);
    for (const Vec3& u : run.state().velocity) course.speed = std::max(course.speed, length(u) / 30);
  }
  return course;
}

void expect_no_jets(const std::string& obstacle, int steps) {
  SCOPED_TRACE(obstacle);
  const Course course = course_of(obstacle, steps);
  EXPECT_LT(course.energy, 1);
  EXPECT_LT(course.speed, 5);
}

TEST(LesSphStreams, PassASolidBox) {
  expect_no_jets("[[solid]]\nlower = [20, 10]\nupper = [29, 20]\n", 100);
  expect_no_jets("[[solid]]\nlower = [20.5, 7]\nupper = [24.5, 20]\n", 100);
}

TEST(LesSphStreams, PassAStepOfTheFloor) {
  expect_no_jets("[[solid]]\nlower = [20.1, 0]\nupper = [26, 11.3]\n", 100);
}

TEST(LesSphStreams, PassABoxThatTheySlideAlong) {
  expect_no_jets("[[body]]\nshape = \"box\"\nsize = [9, 10]\nposition = [24.5, 15]\nwall = \"free-slip\"\n", 800);
}

// The faces by which bodies touch are no walls: a particle that comes into the corner above them stays out of the seam,
// where it left the solve without a pressure.
TEST(LesSphStreams, PassBodiesThatTouch) {
  expect_no_jets("[[solid]]\nlower = [20, 0]\nupper = [30, 10]\n[[solid]]\nlower = [30, 0]\nupper = [40.3, 5.1]\n",
                 200);
  expect_no_jets(
      "[[body]]\nshape = \"box\"\nsize = [10, 15]\nposition = [25, 2.5]\nwall = \"no-slip\"\n"
      "[[body]]\nshape = \"box\"\nsize = [10.3, 10.1]\nposition = [35.15, 0.05]\nwall = \"no-slip\"\n",
      200);
}

}  // namespace
}  // namespace spume::test
