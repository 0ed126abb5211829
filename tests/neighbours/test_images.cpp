// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include <map>

#include "neighbours/neighbourhood.hpp"

namespace spume::test {
namespace {

using enum ImageKind;

using Key = std::pair<std::int32_t, std::array<std::int8_t, 3>>;

void expect_images_match_brute_force(const ImageRules& rules, const std::vector<Point>& points) {
  const Neighbourhood hood(rules, points);
  const std::vector<Point> all = hood.all();
  const std::vector<Point> particles(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(hood.n));
  std::map<Key, Point> expected, found;
  for (const auto& image : reference::images(rules, particles))
    expected[{image.source, image.path.side}] = image.position;
  for (std::size_t k = 0; k < hood.images.size(); ++k) {
    const ImagePath& path = hood.images.paths()[static_cast<std::size_t>(hood.images.path()[k])];
    const Key key{hood.images.source()[k], path.side};
    ASSERT_FALSE(found.contains(key)) << "the same image twice";
    Point position{};
    for (int axis = 0; axis < rules.dimensions; ++axis) position[axis] = hood.images.position(axis)[k];
    found[key] = position;
  }
  ASSERT_GT(expected.size(), 0U);
  EXPECT_EQ(found, expected);
}

TEST(Images, EqualBruteForceForEveryPairOfSides) {
  for (const int dimensions : {2, 3})
    for (const auto x : {none, periodic, mirror})
      for (const auto y : {none, periodic, mirror}) {
        if (x == none && y == none) continue;
        expect_images_match_brute_force(unit_box_rules(dimensions, 0.2, x, y, mirror), random_points(300, dimensions));
      }
}

// A sort of 30 bytes an image and more leaves none of them.
// Borrowed where they are fewer than half of the particles: 0.33 of them at a reach of 0.05, 1.2 at 0.2.
TEST(Images, AreTheSameInBorrowedMemory) {
  for (const double reach : {0.05, 0.2}) {
    const Neighbourhood hood(unit_box_rules(3, reach, periodic, mirror, periodic), random_points(3000, 3));
    ScratchPool pool;
    Images images;
    for (int round = 0; round < 2; ++round)
      images.build(hood.rules, hood.grid, hood.x.data(), hood.y.data(), hood.z.data(), hood.n, nullptr, &pool);
    ASSERT_EQ(images.size(), hood.images.size());
    for (std::size_t k = 0; k < images.size(); ++k) {
      ASSERT_EQ(images.source()[k], hood.images.source()[k]);
      ASSERT_EQ(images.path()[k], hood.images.path()[k]);
      for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(images.position(axis)[k], hood.images.position(axis)[k]);
    }
    EXPECT_EQ(pool.idle_bytes() > 0, 2 * images.size() <= hood.n) << reach;
    EXPECT_EQ(hood.images.bytes() - images.bytes(), pool.idle_bytes());
  }
}

TEST(Images, EqualBruteForceWithDifferentKindsOnTheTwoSidesOfAnAxis) {
  ImageRules rules = unit_box_rules(3, 0.2, periodic, none, none);
  rules.sides[1] = {mirror, none};
  rules.sides[2] = {none, mirror};
  expect_images_match_brute_force(rules, random_points(300, 3));
}

TEST(Images, SignIsTheProductOfTheReflectionsAlongAnAxis) {
  ImageRules rules = unit_box_rules(3, 0.2, mirror, periodic, mirror);
  ImagePath path;
  EXPECT_EQ(Images::sign(path, rules, 0), 1);
  path.side = {0, 1, -1};
  EXPECT_EQ(Images::sign(path, rules, 0), -1);
  EXPECT_EQ(Images::sign(path, rules, 1), 1);
  EXPECT_EQ(Images::sign(path, rules, 2), 1);
  path.face[0] = {2 + 2 * 3 + 1, -1};
  EXPECT_EQ(Images::sign(path, rules, 0), 1);
  path.face[2] = {2 + 2 * 3, -1};
  EXPECT_EQ(Images::sign(path, rules, 2), -1);
  path.face[2] = {2 + 2 * 3, 1};
  EXPECT_EQ(Images::sign(path, rules, 2), 1);
}

TEST(Images, ContinueALatticeBeyondSidesAndCorners) {
  // Each lattice site within the support radius of the domain holds exactly one image.
  const int m = 10;
  const double spacing = 0.1, support_radius = 0.26;
  for (const auto x : {periodic, mirror})
    for (const auto y : {periodic, mirror}) {
      const Neighbourhood hood(unit_box_rules(2, support_radius, x, y, none), lattice_points(m, 2, 0));
      std::map<std::pair<int, int>, int> at;
      for (std::size_t k = 0; k < hood.images.size(); ++k)
        ++at[{static_cast<int>(std::floor(hood.images.position(0)[k] / spacing)),
              static_cast<int>(std::floor(hood.images.position(1)[k] / spacing))}];
      // Sites 0.05, 0.15 and 0.25 beyond each side are nearer than the support radius.
      for (int b = -3; b < m + 3; ++b)
        for (int a = -3; a < m + 3; ++a) {
          const bool inside = a >= 0 && a < m && b >= 0 && b < m;
          EXPECT_EQ((at[{a, b}]), inside ? 0 : 1) << a << ' ' << b;
        }
      EXPECT_EQ(hood.images.size(), 16U * 16U - 10U * 10U);
    }
}

// Lattice with `spacing`, left out inside the box; the box is a whole number of spacings.
std::vector<Point> lattice_around(const SolidBox& box, int m, int dimensions) {
  std::vector<Point> liquid;
  for (const Point& p : lattice_points(m, dimensions, 0)) {
    bool inside = true;
    for (int axis = 0; axis < dimensions; ++axis)
      inside = inside && p[axis] > box.lower[axis] && p[axis] < box.upper[axis];
    if (!inside) liquid.push_back(p);
  }
  return liquid;
}

TEST(Images, FillABoxOnceWithinReachOfTheLiquidAlsoAtItsEdges) {
  // Images of lattice points fall on lattice sites of the box. Sites nearer than the support radius to a face hold one
  // image, also those that are equally near to two or three faces; deeper sites hold none.
  const int m = 20;
  const double spacing = 1.0 / m, support_radius = 2.6 * spacing;
  for (const int dimensions : {2, 3}) {
    ImageRules rules = unit_box_rules(dimensions, support_radius, none, none, none);
    const SolidBox box{{0.25, 0.3, 0.2}, {0.7, 0.8, 0.6}, BoundaryKind::free_slip};
    rules.solids = unite(rules, {box}, spacing);
    rules.only_nearest = true;
    const Neighbourhood hood(rules, lattice_around(box, m, dimensions));
    std::map<std::array<int, 3>, int> at;
    for (std::size_t k = 0; k < hood.images.size(); ++k) {
      std::array<int, 3> site{};
      for (int axis = 0; axis < dimensions; ++axis)
        site[axis] = static_cast<int>(std::floor(hood.images.position(axis)[k] / spacing));
      ++at[site];
    }
    int wrong = 0;
    std::size_t sites = 0;
    for (const Point& p : lattice_points(m, dimensions, 0)) {
      std::array<int, 3> site{};
      double depth = 1;
      for (int axis = 0; axis < dimensions; ++axis) {
        site[axis] = static_cast<int>(std::floor(p[axis] / spacing));
        depth = std::min({depth, p[axis] - box.lower[axis], box.upper[axis] - p[axis]});
      }
      const int expected = depth > 0 && depth < support_radius ? 1 : 0;
      sites += static_cast<std::size_t>(expected);
      if (at[site] != expected) ++wrong;
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(hood.images.size(), sites);
  }
}

TEST(Images, APointInThePlaneOfAFaceBesideItHasNoImageThere) {
  ImageRules rules = unit_box_rules(2, 0.26, none, none, none);
  rules.solids = unite(rules, {{{0.4, 0.1, 0}, {0.8, 0.3, 0}, BoundaryKind::free_slip}}, 0.1);
  const Neighbourhood hood(rules, {{0.4, 0.5, 0}, {0.4, 0.4, 0}});
  for (std::size_t k = 0; k < hood.images.size(); ++k) EXPECT_LT(hood.images.position(1)[k], 0.3);
  EXPECT_EQ(hood.list.count(0), 1) << "the other point; images are farther than the support radius";
}

TEST(Images, BoxDensityNearEdgesEqualsTheBulk) {
  // A box that does not fit the lattice: the number of images in a strip along an edge is its area times the
  // number density, up to the lattice points that a strip of this perimeter can gain or lose on its border
  // (the discrepancy of a jittered lattice is below half a point per spacing of border).
  const int m = 60;
  const double spacing = 1.0 / m, support_radius = 3.7 * spacing;
  ImageRules rules = unit_box_rules(2, support_radius, none, none, none);
  const SolidBox box{{0.311, 0.307, 0}, {0.713, 0.689, 1}, BoundaryKind::free_slip};
  rules.solids = unite(rules, {box}, spacing);
  rules.only_nearest = true;
  const Neighbourhood hood(rules, lattice_around(box, m, 2));
  const double width = 3 * spacing;
  for (const int cx : {0, 1})
    for (const int cy : {0, 1}) {
      int count = 0;
      for (std::size_t k = 0; k < hood.images.size(); ++k) {
        const double dx =
            cx == 0 ? hood.images.position(0)[k] - box.lower[0] : box.upper[0] - hood.images.position(0)[k];
        const double dy =
            cy == 0 ? hood.images.position(1)[k] - box.lower[1] : box.upper[1] - hood.images.position(1)[k];
        if (dx < width && dy < width) ++count;
      }
      EXPECT_NEAR(count, 9, 0.5 * 4 * width / spacing);
    }
  double area = 0.402 * 0.382 - (0.402 - 2 * support_radius) * (0.382 - 2 * support_radius);
  const double perimeter = 2 * (0.402 + 0.382) + 2 * (0.402 + 0.382 - 4 * support_radius);
  EXPECT_NEAR(static_cast<double>(hood.images.size()), area * m * m, 0.5 * perimeter / spacing);
}

TEST(Images, DoNotDependOnTheThreadCount) {
  ImageRules rules = unit_box_rules(3, 0.13, periodic, mirror, mirror);
  rules.solids = unite(rules, {{{0.4, 0.4, 0.2}, {0.6, 0.7, 0.5}, BoundaryKind::free_slip}}, 0.05);
  const auto points = lattice_points(20, 3, 0.4);
  const auto snapshot = [&](int threads) {
    omp_set_num_threads(threads);
    const Neighbourhood hood(rules, points);
    std::vector<std::tuple<Point, std::int32_t, std::int32_t>> images;
    for (std::size_t k = 0; k < hood.images.size(); ++k)
      images.emplace_back(Point{hood.images.position(0)[k], hood.images.position(1)[k], hood.images.position(2)[k]},
                          hood.images.source()[k], hood.images.path()[k]);
    return images;
  };
  const int before = omp_get_max_threads();
  const auto one = snapshot(1);
  for (const int threads : {2, 3}) EXPECT_EQ(snapshot(threads), one) << threads;
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace spume::test
