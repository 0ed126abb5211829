// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "particles/walled.hpp"
#include "spume/particles/reports.hpp"

namespace spume::test {
namespace {

// Places all around a box of walls, periodic sides and open ones: those that are said to be clear of sides are left to
// the bit, and so are all but those within a ten thousandth of a spacing of a side, which is the other way round.
TEST(BoundarySides, APlaceClearOfThemIsLeftWhereItIs) {
  for (const char* domain : {"lower = [0, 0]\nupper = [1, 0.7]\nleft = \"free-slip\"\nbottom = \"no-slip\"\n",
                             "lower = [-1, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\nfront = \"free-slip\"\n"
                             "back = \"free-slip\"\nbottom = \"free-slip\"\n"}) {
    const LoadedCase loaded = load_text(scene_text(domain, 0.1, ""));
    const Domain& box = loaded.scene.domain;
    const Boundary boundary(box, loaded.scene.spacing, nullptr);
    std::size_t clear = 0, held = 0;
    for (std::uint64_t n = 0; n < 4000; ++n) {
      Vec3 place{};
      double depth = 1;
      for (int axis = 0; axis < box.dimensions; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        // One in four lies within some gaps of a side.
        const Point r = uniform(n, 5), near = uniform(n, 6);
        const double side = near[a] < 0.5 ? box.lower[a] : box.upper[a];
        place[a] = n % 4 == 0 && n / 4 % static_cast<std::uint64_t>(box.dimensions) == static_cast<std::uint64_t>(axis)
                       ? side + 4 * boundary.gap() * (2 * r[a] - 1)
                       : box.lower[a] + (1.2 * r[a] - 0.1) * (box.upper[a] - box.lower[a]);
        depth = std::min({depth, place[a] - box.lower[a], box.upper[a] - place[a]});
      }
      Vec3 held_place = place;
      boundary.apply_walls(boundary.walls, held_place, nullptr);
      if (boundary.clear_of_sides(place)) {
        EXPECT_EQ(held_place, place);
        ++clear;
      } else {
        EXPECT_LT(depth, 1.01 * boundary.gap());
        held += held_place != place ? 1 : 0;
      }
    }
    EXPECT_GT(clear, 1000U);
    EXPECT_GT(held, 100U);
  }
}

// A block is clear as its places are, of walls that have moved; and goes round as each of them does.
TEST(BoundarySides, ABlockClearOfThemGoesRoundPeriodicSidesAlone) {
  const LoadedCase loaded = load_text(scene_text(
      "lower = [-1, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\nfront = \"free-slip\"\nbottom = \"free-slip\"\n", 0.1,
      ""));
  const Boundary boundary(loaded.scene.domain, loaded.scene.spacing, nullptr);
  WallPositions at = boundary.walls;
  at[1][0] = 0.3;  // the front has moved
  constexpr std::size_t n = 64;
  std::size_t clear = 0;
  for (std::uint64_t block = 0; block < 200; ++block) {
    std::array<std::array<double, n>, 3> places;
    bool each_clear = true;
    for (std::uint64_t k = 0; k < n; ++k) {
      const Point r = uniform(block * n + k, 7);
      places[0][k] = 2.4 * r[0] - 1.2;
      places[1][k] = (block % 2 == 0 ? 0.301 : 0.27) + 0.69 * r[1];
      places[2][k] = 0.001 + 0.99 * r[2];
      each_clear = each_clear && places[1][k] > at[1][0] + boundary.gap() && places[2][k] > boundary.gap();
    }
    ASSERT_EQ(boundary.clear_of_sides(at, {places[0].data(), places[1].data(), places[2].data()}, 0, n), each_clear);
    if (!each_clear) continue;
    ++clear;
    const auto before = places;
    boundary.go_round(at, {places[0].data(), places[1].data(), places[2].data()}, 3, n);
    for (std::size_t k = 0; k < n; ++k) {
      Vec3 held{before[0][k], before[1][k], before[2][k]};
      if (k >= 3) boundary.hold_liquid(at, held, nullptr);
      EXPECT_EQ((Vec3{places[0][k], places[1][k], places[2][k]}), held);
    }
  }
  EXPECT_GT(clear, 50U);
  EXPECT_LT(clear, 150U);
}

// Places that are clear of bodies stay where they are, whole blocks too; ways across thin bodies count wherever they
// end.
TEST(BoundarySides, PlacesClearOfBodiesStay) {
  const std::string ball = "[[body]]\nshape = \"ball\"\nradius = 0.2\nposition = [0.5, 0.5]\n";
  const std::string turned = "[[body]]\nshape = \"box\"\nsize = [0.4, 0.3]\nposition = [0.55, 0.4]\nangle = 20\n";
  const std::string moving =
      "[[body]]\nshape = \"box\"\nsize = [0.3, 0.2]\nposition = [0.2, 0.4]\ndisplacement = [\"0.3*t\", \"0\"]\n";
  for (const std::string& bodies : {ball, turned, ball + moving}) {
    Walled walled(scene_text("lower = [0, 0]\nupper = [1, 1]\nbottom = \"free-slip\"\n", 0.02, bodies));
    Boundary& boundary = walled.boundary;
    boundary.advance(0, 0.7);
    std::size_t clear = 0, held = 0;
    for (std::uint64_t n = 0; n < 4000; ++n) {
      const Point r = uniform(n, 8);
      const Vec3 place{1.1 * r[0] - 0.05, 1.1 * r[1] - 0.05, 0};
      Vec3 now = place;
      boundary.hold_liquid(boundary.walls, now, nullptr);
      const bool alone = boundary.clear_of_sides(place);
      ASSERT_EQ(boundary.clear_of_sides(boundary.walls, {&place[0], &place[1], &place[2]}, 0, 1), alone);
      if (alone) EXPECT_EQ(now, place);
      clear += alone ? 1 : 0;
      held += now != place ? 1 : 0;
    }
    EXPECT_GT(clear, 1500U);
    EXPECT_GT(held, 300U);
  }
  const Walled plate(scene_text("lower = [0, 0]\nupper = [1, 1]\nbottom = \"free-slip\"\n", 0.02,
                                "[[body]]\nshape = \"box\"\nsize = [0.03, 0.4]\nposition = [0.5, 0.5]\n"));
  EXPECT_FALSE(plate.boundary.clear_of_sides({0.5, 0.9, 0}));
}

// Simpson's rule is exact for 0.2 t; the floor slides along itself, and the other sides stand.
TEST(BoundarySides, ThoseThatMoveAlongTheirNormalsAreInTheSeries) {
  const LoadedCase loaded = load_text(scene_text(
      "lower = [0, 0, -1]\nupper = [1, 0.7, 0]\nleft = \"free-slip\"\nright = \"free-slip\"\nback = \"no-slip\"\n"
      "bottom = \"no-slip\"\n[domain.wall_velocity]\nright = [\"0.2*t\", \"0\", \"0\"]\n"
      "back = [\"0\", \"-0.1\", \"0\"]\nbottom = [\"1\", \"0\", \"0\"]\n",
      0.1, ""));
  Boundary boundary(loaded.scene.domain, loaded.scene.spacing, nullptr);
  SeriesTable series;
  add_wall_columns(series, boundary);
  ASSERT_EQ(series.columns().size(), 2U);
  EXPECT_EQ(series.columns()[0].name, "wall_right");
  EXPECT_EQ(series.columns()[1].name, "wall_back");
  std::array<double, 2> row{};
  series.values(row);
  EXPECT_EQ(row, (std::array{1.0, 0.7}));
  for (int step = 0; step < 4; ++step) {
    boundary.advance(0.5 * step, 0.5);
    boundary.accept();
  }
  series.values(row);
  EXPECT_NEAR(row[0], 1.4, 1e-14);
  EXPECT_NEAR(row[1], 0.5, 1e-14);
}

}  // namespace
}  // namespace spume::test
