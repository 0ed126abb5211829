// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include <functional>

#include "neighbours/neighbourhood.hpp"
#include "spume/neighbours/list_skin.hpp"

namespace spume::test {
namespace {

using enum ImageKind;
using Way = std::function<Point(const Point&, std::size_t)>;

struct Moved {
  Neighbourhood hood;
  std::array<Array<float>, 3> place, way;
  double longest = 0;

  Moved(const ImageRules& rules, const std::vector<Point>& points, const Way& way_of) : hood(rules, points) {
    const std::array<const Array<double>*, 3> at{&hood.x, &hood.y, &hood.z};
    for (auto& axis : place) axis = Array<float>(hood.n);
    for (auto& axis : way) axis = Array<float>(hood.n);
    for (std::size_t i = 0; i < hood.n; ++i) {
      const Point one = way_of({hood.x[i], hood.y[i], hood.z[i]}, i);
      double squares = 0;
      for (int axis = 0; axis < hood.rules.dimensions; ++axis) {
        place[axis][i] = static_cast<float>((*at[axis])[i] - hood.origin[axis]);
        way[axis][i] = static_cast<float>(one[axis]);
        squares += one[axis] * one[axis];
      }
      longest = std::max(longest, std::sqrt(squares));
    }
  }

  double nearest(ListSkin& skin) const {
    return skin.nearest({.grid = hood.grid,
                         .particles = hood.table,
                         .images = hood.images,
                         .rules = hood.rules,
                         .origin = hood.origin,
                         .place = {place[0].data(), place[1].data(), place[2].data()},
                         .way = {way[0].data(), way[1].data(), way[2].data()}},
                        longest);
  }
  double nearest() const {
    ListSkin skin;
    return nearest(skin);
  }

  // The definition: of all pairs of a particle and a particle or an image, those of no list among them.
  double least() const {
    const int d = hood.rules.dimensions;
    double least2 = 1e9;
    for (std::size_t i = 0; i < hood.n; ++i)
      for (std::size_t j = 0; j < hood.n; ++j)
        for (int path = 0; path < (d == 3 ? 27 : 9); ++path) {
          double before2 = 0, after2 = 0;
          bool exists = i != j || path > 0;
          for (int axis = 0, digits = path; axis < d; ++axis, digits /= 3) {
            const int side = digits % 3 - 1;
            double x = hood.origin[axis] + place[axis][j], dx = way[axis][j];
            if (side >= 0) {
              const ImageKind kind = hood.rules.sides[axis][side];
              exists = exists && kind != none;
              if (kind == mirror) {
                x = 2 * (side == 0 ? hood.rules.lower[axis] : hood.rules.upper[axis]) - x;
                dx = -dx;
              } else {
                x += (side == 0 ? -1 : 1) * (hood.rules.upper[axis] - hood.rules.lower[axis]);
              }
            }
            const double before = x - (hood.origin[axis] + place[axis][i]), after = before + dx - way[axis][i];
            before2 += before * before;
            after2 += after * after;
          }
          if (exists && before2 > hood.rules.support_radius * hood.rules.support_radius)
            least2 = std::min(least2, after2);
        }
    return std::sqrt(least2);
  }
};

constexpr double list_reach = 0.2;
// Of places and ways in float, in a box of 1.
constexpr double way_rounding = 2e-6;

ImageRules rules_of(int dimensions, ImageKind x, ImageKind y, ImageKind z) {
  return unit_box_rules(dimensions, list_reach, x, y, z);
}

Way translation(double size) {
  return [=](const Point&, std::size_t) { return Point{size, -0.5 * size, 0.3 * size}; };
}
// By an angle around the middle of the box.
Way rotation(double angle) {
  return [=](const Point& r, std::size_t) {
    const double x = r[0] - 0.5, y = r[1] - 0.5;
    return Point{std::cos(angle) * x - std::sin(angle) * y - x, std::sin(angle) * x + std::cos(angle) * y - y, 0};
  };
}
Way strain(double size) {
  return [=](const Point& r, std::size_t) { return Point{size * (r[0] - 0.5), -size * (r[1] - 0.5), 0}; };
}
// Vanishes across the sides.
Way vortices(double size) {
  constexpr double turn = 2 * 3.14159265358979;
  return [=](const Point& r, std::size_t) {
    return Point{size * std::sin(turn * r[0]) * std::cos(turn * r[1]),
                 -size * std::cos(turn * r[0]) * std::sin(turn * r[1]), size * std::sin(turn * r[2]) * 0.3};
  };
}
Way noise(double size) {
  return [=](const Point&, std::size_t i) {
    const Point r = uniform(i, 3);
    return Point{size * (2 * r[0] - 1), size * (2 * r[1] - 1), size * (2 * r[2] - 1)};
  };
}
Way sum_of(const Way& a, const Way& b) {
  return [=](const Point& r, std::size_t i) {
    const Point x = a(r, i), y = b(r, i);
    return Point{x[0] + y[0], x[1] + y[1], x[2] + y[2]};
  };
}

void expect_bound(const Moved& moved, const char* what) {
  EXPECT_LE(moved.nearest(), moved.least() + way_rounding) << what;
}

TEST(ListSkin, IsNeverMoreThanTheLeastDistanceOfThoseOutsideTheLists) {
  for (const int d : {2, 3}) {
    const std::vector<std::pair<const char*, std::vector<Point>>> arrangements{
        {"random", random_points(300, d)},
        {"lattice", lattice_points(d == 3 ? 7 : 18, d, 0.3)},
        {"clustered", clustered_points(250, d, 0.15)},
        {"few", random_points(7, d)}};
    const std::vector<std::pair<const char*, ImageRules>> sides{{"none", rules_of(d, none, none, none)},
                                                                {"periodic", rules_of(d, periodic, periodic, periodic)},
                                                                {"mirrors", rules_of(d, mirror, mirror, mirror)},
                                                                {"mixed", rules_of(d, periodic, mirror, none)}};
    const std::vector<std::pair<const char*, Way>> ways{
        {"translation", translation(0.4 * list_reach)},
        {"far translation", translation(1.5 * list_reach)},
        {"rotation", rotation(0.1)},
        {"strain", strain(0.3)},
        {"vortices", vortices(0.4 * list_reach)},
        {"noise", noise(0.2 * list_reach)},
        {"all", sum_of(vortices(0.2 * list_reach), noise(0.05 * list_reach))}};
    for (const auto& [arrangement, points] : arrangements)
      for (const auto& [side, rules] : sides)
        for (const auto& [way, way_of] : ways)
          expect_bound(Moved(rules, points, way_of),
                       (std::to_string(d) + " " + arrangement + ", " + side + ", " + way).c_str());
  }
}

// Two drops with nothing between them: they are in blocks that touch, two apart, or farther.
TEST(ListSkin, SeesDropsThatFlyTowardsEachOther) {
  for (const int d : {2, 3})
    for (const double gap :
         {0.5 * list_reach, 1.01 * list_reach, 1.5 * list_reach, 1.99 * list_reach, 2.5 * list_reach, 3 * list_reach}) {
      std::vector<Point> points = clustered_points(0, d, 0.1);
      for (std::uint64_t i = 0; i < 120; ++i) {
        const Point r = uniform(i);
        points.push_back(
            {0.3 + 0.15 * r[0] + (i % 2 == 0 ? 0 : 0.15 + gap), 0.4 + 0.1 * r[1], d == 3 ? 0.4 + 0.1 * r[2] : 0});
      }
      for (const double speed : {0.1 * list_reach, 0.3 * list_reach, 0.6 * list_reach, list_reach}) {
        const Moved moved(rules_of(d, none, none, none), points, [&](const Point& r, std::size_t) {
          return Point{r[0] < 0.45 + gap / 2 ? speed : -speed, 0, 0};
        });
        expect_bound(
            moved, ("gap " + std::to_string(gap / list_reach) + ", way " + std::to_string(speed / list_reach)).c_str());
      }
    }
}

TEST(ListSkin, HoldsWhatGoesTogether) {
  for (const int d : {2, 3}) {
    const std::vector<Point> points = lattice_points(d == 3 ? 12 : 20, d, 0.2);
    const Moved gone(rules_of(d, periodic, periodic, periodic), points, translation(0.4 * list_reach));
    EXPECT_NEAR(gone.nearest(), list_reach, way_rounding);
    EXPECT_LT(list_reach - 2 * gone.longest, 0.2 * list_reach) << "a way of which the longest alone would say nothing";
    // A rotation changes no distance; floats of the gradients round 1e-7 of it.
    EXPECT_NEAR(Moved(rules_of(d, none, none, none), points, rotation(0.1)).nearest(), list_reach, 1e-4 * list_reach);
    EXPECT_NEAR(Moved(rules_of(d, none, none, none), points, strain(0.1)).nearest(), 0.9 * list_reach,
                1e-3 * list_reach);
    // Away from a mirror: the images recede as the particles do.
    ImageRules one_mirror = rules_of(d, mirror, none, none);
    one_mirror.sides[0][1] = none;
    const Moved away(one_mirror, points, [](const Point& r, std::size_t) { return Point{0.1 * r[0], 0, 0}; });
    EXPECT_NEAR(away.nearest(), list_reach, 1e-4 * list_reach);
  }
}

TEST(ListSkin, IsTheSameForAnyNumberOfThreads) {
  const Moved moved(rules_of(3, periodic, mirror, none), lattice_points(12, 3, 0.4),
                    sum_of(vortices(0.3 * list_reach), noise(0.02 * list_reach)));
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const double one = moved.nearest();
  omp_set_num_threads(3);
  const double three = moved.nearest();
  omp_set_num_threads(before);
  EXPECT_EQ(one, three);
}

// Blocks are those of the lists until renew().
TEST(ListSkin, FollowsNewLists) {
  ListSkin skin;
  const Moved first(rules_of(2, none, none, none), lattice_points(10, 2, 0), translation(0.1 * list_reach));
  const Moved second(rules_of(2, none, none, none), clustered_points(300, 2, 0.1), noise(0.3 * list_reach));
  first.nearest(skin);
  skin.renew();
  EXPECT_EQ(second.nearest(skin), second.nearest());
}

}  // namespace
}  // namespace spume::test
