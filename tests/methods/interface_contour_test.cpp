// SPDX-License-Identifier: MIT
// Interfaces as they are drawn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include "methods/gfd_run.hpp"
#include "spume/core/vectors.hpp"
#include "spume/methods/wcsph/wcsph.hpp"

namespace spume::test {
namespace {

using WcsphRun = MethodRun<wcsph::Wcsph>;

double size_of(const SurfaceSnapshot& surface) {
  double sum = 0;
  const auto at = [&](std::size_t k) { return surface.points[static_cast<std::size_t>(surface.corners[k])]; };
  const auto corners = static_cast<std::size_t>(surface.corners_per_cell);
  for (std::size_t k = 0; k < surface.corners.size(); k += corners)
    sum += corners == 2 ? length(subtract(at(k + 1), at(k)))
                        : 0.5 * length(cross(subtract(at(k + 1), at(k)), subtract(at(k + 2), at(k))));
  return sum;
}

Overrides spaced(double spacing) {
  return {"resolution.spacing=" + std::to_string(spacing)};
}

// Mean error of the surface of balls whose middles lie at several places of the lattice.
template <class Run>
double error_of_ball(const std::string& text, int dimensions, double radius, double spacing) {
  double sum = 0;
  constexpr int places = 4;
  for (int k = 0; k < places; ++k) {
    const std::string x = std::to_string(0.5 + spacing * k / places), y = std::to_string(0.5 + spacing * k * k / 7);
    Overrides set = spaced(spacing);
    set.push_back("region.1.centre=[" + x + ", " + y + (dimensions == 3 ? ", 0.5]" : "]"));
    Run run(text, set);
    const double exact = dimensions == 3 ? 4 * M_PI * radius * radius : 2 * M_PI * radius;
    sum += size_of(run.method.interface_surface()) / exact - 1;
  }
  return sum / places;
}

const std::string in_wcsph = replaced(drop_in_a_box, "\"gfd\"", "\"wcsph\"");

}  // namespace

// What averages do to a ball is taken out. What is left is the staircase of the particles, 0.3 %, and their number: of
// balls of 50 and 250 particles in 2-D and of 300 and 2500 in 3-D by about the root of those on the surface over all,
// 10, 5, 16 and 6 %, over the root of four places and, for the length of a circle, by half, for the area by two thirds.
TEST(InterfaceContour, OfABallHasItsSurface) {
  std::vector<double> errors;
  for (const double cells : {16, 32, 64}) errors.push_back(error_of_ball<GfdRun>(drop_in_a_box, 2, 0.25, 1 / cells));
  EXPECT_LT(std::abs(errors[0]), 0.025);
  EXPECT_LT(std::abs(errors[1]), 0.0125);
  EXPECT_LT(std::abs(errors[2]), 0.005);
  RecordProperty("errors", std::to_string(100 * errors[0]) + " " + std::to_string(100 * errors[1]) + " " +
                               std::to_string(100 * errors[2]) + " %");
  std::vector<double> of_ball;
  for (const double cells : {14, 28}) of_ball.push_back(error_of_ball<GfdRun>(ball_in_a_box, 3, 0.3, 1 / cells));
  EXPECT_LT(std::abs(of_ball[0]), 0.05);
  EXPECT_LT(std::abs(of_ball[1]), 0.02);
  RecordProperty("errors_3d", std::to_string(100 * of_ball[0]) + " " + std::to_string(100 * of_ball[1]) + " %");
}

TEST(InterfaceContour, OfWcsphIsTheSame) {
  EXPECT_LT(std::abs(error_of_ball<WcsphRun>(in_wcsph, 2, 0.25, 1.0 / 32)), 0.015);
}

// Layers on a lattice: the interface lies half way between two rows. Averages of the two interfaces, ten rows apart,
// reach each other with a ten-millionth.
TEST(InterfaceContour, OfLayersIsFlatEndsOnTheSidesAndIsThereForBothPhases) {
  GfdRun run(three_layers);
  const SurfaceSnapshot surface = run.method.interface_surface();
  ASSERT_EQ(surface.fields.size(), 1U);
  EXPECT_EQ(surface.fields[0].first, "phase");
  std::map<int, double> lowest, highest, size;
  const auto& number = surface.fields[0].second;
  ASSERT_EQ(2 * number.size(), surface.corners.size());
  for (std::size_t k = 0; k < number.size(); ++k) {
    const Vec3 a = surface.points[static_cast<std::size_t>(surface.corners[2 * k])],
               b = surface.points[static_cast<std::size_t>(surface.corners[2 * k + 1])];
    const int n = number[k];
    if (!size.contains(n)) lowest[n] = 1e9, highest[n] = -1e9;
    size[n] += length(subtract(b, a));
    lowest[n] = std::min(lowest[n], a[1]);
    highest[n] = std::max(highest[n], a[1]);
  }
  EXPECT_NEAR(size[0], 1, 1e-6);  // periodic, 1 wide
  EXPECT_NEAR(size[1], 2, 1e-6);  // above and below
  EXPECT_NEAR(size[2], 1, 1e-6);
  EXPECT_NEAR(lowest[0], 1, 1e-6);
  EXPECT_NEAR(highest[0], 1, 1e-6);
  EXPECT_NEAR(lowest[1], 0.5, 1e-6);
  EXPECT_NEAR(highest[2], 0.5, 1e-6);
}

// Half a drop on a wall: its end meets the wall.
TEST(InterfaceContour, EndsOnWalls) {
  GfdRun run(replaced(drop_in_a_box, "centre = [0.5, 0.5]\nradius = 0.25", "where = \"0.0625 - (x-0.5)^2 - y^2\""),
             spaced(1.0 / 32));
  const SurfaceSnapshot surface = run.method.interface_surface();
  double lowest = 1;
  for (const Vec3& p : surface.points) lowest = std::min(lowest, p[1]);
  EXPECT_EQ(lowest, 0);
  EXPECT_NEAR(size_of(surface), M_PI * 0.25, 0.02 * M_PI * 0.25);
}

// Nothing is drawn of the wall where it meets a phase, nor of what lies behind it.
TEST(InterfaceContour, EndsAtBodies) {
  GfdRun run(
      replaced(drop_in_a_turning_tank, "centre = [0.15, 0]\nradius = 0.2", "where = \"0.04 - (x-0.45)^2 - y^2\""));
  const SurfaceSnapshot surface = run.method.interface_surface();
  ASSERT_FALSE(surface.points.empty());
  double farthest = 0;
  for (const Vec3& p : surface.points) farthest = std::max(farthest, length(p));
  EXPECT_LT(farthest, 0.5 + 0.5 * 0.05);
  EXPECT_GT(farthest, 0.5 - 1.5 * 0.05);
  // The arc of the drop within the tank: x between where both circles meet and its left end.
  const double half = std::acos((0.45 * 0.45 + 0.2 * 0.2 - 0.5 * 0.5) / (2 * 0.45 * 0.2));
  EXPECT_NEAR(size_of(surface), 2 * 0.2 * half, 3 * 0.05);  // each end within 1.5 spacings
}

TEST(InterfaceContour, DoesNotDependOnTheNumberOfThreads) {
  const int before = omp_get_max_threads();
  GfdRun run(ball_in_a_box);
  run.steps(2, 0.002);
  omp_set_num_threads(1);
  const SurfaceSnapshot one = run.method.interface_surface();
  omp_set_num_threads(3);
  const SurfaceSnapshot three = run.method.interface_surface();
  omp_set_num_threads(before);
  EXPECT_EQ(one.points, three.points);
  EXPECT_EQ(one.corners, three.corners);
}

TEST(InterfaceContour, IsRefusedWhereThereIsOnePhase) {
  const std::string one =
      replaced(replaced(drop_in_a_box, "[[region]]\nphase = \"drop\"\ncentre = [0.5, 0.5]\nradius = 0.25\n", ""),
               "[[phase]]\nname = \"drop\"\ndensity = 10\nviscosity = 0.1\n[interface]\nsurface_tension = 1\n", "");
  try {
    load_text(one, {"output.interface=true"});
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(std::string(error.what()), testing::HasSubstr("no interface that output.interface could write"));
  }
}

}  // namespace spume::test
