// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <limits>

#include "neighbours/neighbourhood.hpp"

namespace spume::test {
namespace {

using enum ImageKind;

// Float coordinates are off by half a unit in the last place of the largest one; a distance by that of both
// ends in each axis, and by the rounding of its own sum of squares (four roundings of 2^-24).
double distance_tolerance(const Neighbourhood& hood) {
  double extent = 0;
  for (const Point& p : hood.all())
    for (int axis = 0; axis < hood.rules.dimensions; ++axis)
      extent = std::max(extent, std::abs(p[axis] - hood.origin[axis]));
  const double half_unit = 0.5 * std::numeric_limits<float>::epsilon();
  return half_unit * (2 * std::sqrt(3.0) * extent + 4 * hood.rules.support_radius);
}

void expect_lists_match_brute_force(const Neighbourhood& hood) {
  const std::vector<Point> all = hood.all();
  const double tolerance = distance_tolerance(hood);
  ASSERT_EQ(hood.list.particles(), hood.n);
  ASSERT_EQ(hood.list.points(), all.size());
  std::int64_t pairs = 0;
  for (std::size_t i = 0; i < hood.n; ++i) {
    const auto expected = reference::neighbours(all, i, hood.rules.dimensions, hood.rules.support_radius, tolerance);
    const auto list = hood.list.of(i);
    const std::set<std::int32_t> found(list.begin(), list.end());
    ASSERT_EQ(found.size(), list.size()) << "a neighbour of " << i << " twice";
    ASSERT_TRUE(std::includes(found.begin(), found.end(), expected.certain.begin(), expected.certain.end()))
        << "a neighbour of " << i << " is missing";
    ASSERT_TRUE(std::includes(expected.possible.begin(), expected.possible.end(), found.begin(), found.end()))
        << "the list of " << i << " holds a point that is too far";
    for (const std::int32_t* j = hood.list.begin(i) + hood.list.count(i); j < hood.list.padded_end(i); ++j)
      ASSERT_EQ(*j, entry_scale * hood.list.sentinel());
    pairs += hood.list.count(i);
  }
  EXPECT_EQ(hood.list.pair_count(), pairs);
}

void expect_pairs_symmetric(const Neighbourhood& hood) {
  for (std::size_t i = 0; i < hood.n; ++i)
    for (const std::int32_t j : hood.list.of(i)) {
      if (static_cast<std::size_t>(j) >= hood.n) continue;
      const auto back = hood.list.of(static_cast<std::size_t>(j));
      ASSERT_NE(std::find(back.begin(), back.end(), static_cast<std::int32_t>(i)), back.end())
          << j << " is a neighbour of " << i << " but not the other way round";
    }
}

// Reflections too: i sees as many images of j, at the same distances, as j sees of i.
void expect_reflections_symmetric(const Neighbourhood& hood) {
  const double tolerance = distance_tolerance(hood);
  const std::vector<Point> all = hood.all();
  std::map<std::array<std::size_t, 2>, std::vector<double>> distances;
  for (std::size_t i = 0; i < hood.n; ++i)
    for (const std::int32_t j : hood.list.of(i)) {
      const auto k = static_cast<std::size_t>(j);
      double distance2 = 0;
      for (int axis = 0; axis < hood.rules.dimensions; ++axis) distance2 += std::pow(all[k][axis] - all[i][axis], 2);
      if (std::sqrt(distance2) > hood.rules.support_radius - tolerance) continue;
      const std::size_t source = k < hood.n ? k : static_cast<std::size_t>(hood.images.source()[k - hood.n]);
      distances[{i, source}].push_back(std::sqrt(distance2));
    }
  for (auto& [pair, there] : distances) {
    auto& back = distances[{pair[1], pair[0]}];
    ASSERT_EQ(there.size(), back.size()) << pair[0] << " and " << pair[1];
    std::sort(there.begin(), there.end());
    std::sort(back.begin(), back.end());
    for (std::size_t k = 0; k < there.size(); ++k) ASSERT_NEAR(there[k], back[k], tolerance);
  }
}

std::vector<std::vector<std::int32_t>> lists_of(const NeighbourList& list) {
  std::vector<std::vector<std::int32_t>> lists(list.particles());
  for (std::size_t i = 0; i < lists.size(); ++i) lists[i].assign(list.begin(i), list.padded_end(i));
  return lists;
}

// The entries of a narrow list, as its batches say them.
std::vector<std::int32_t> decoded(const NeighbourList& list, std::size_t i) {
  std::vector<std::int32_t> entries;
  const NarrowBatches batches = list.batches(i);
  for (std::size_t b = 0; b < batches.size; ++b)
    for (std::size_t l = 0; l < simd::pair_lanes; ++l) {
      const std::uint16_t code = batches.code[b * simd::pair_lanes + l];
      if (l > 0 && code == batches.code[b * simd::pair_lanes]) break;
      entries.push_back(batches.base[b] + entry_scale * code);
    }
  return entries;
}

std::size_t batches_of(const NeighbourList& list) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < list.particles(); ++i) sum += list.batches(i).size;
  return sum;
}

// What any_of() asks of a list, to its end and up to the entry `last`.
std::vector<std::int32_t> asked(const NeighbourList& list, std::size_t i, std::int32_t last = -1) {
  std::vector<std::int32_t> entries;
  const bool found = list.any_of(i, [&](std::int32_t j) {
    entries.push_back(entry_scale * j);
    return entries.back() == last;
  });
  EXPECT_EQ(found, last >= 0);
  return entries;
}

// Points are numbered beyond what 16 bits reach, and images far from the particles that see them.
TEST(NarrowLists, HoldWhatTheOthersHoldInTheSameOrder) {
  for (const int points_across : {40, 280}) {
    Neighbourhood hood(unit_box_rules(2, 3.0 / points_across, periodic, mirror, none),
                       lattice_points(points_across, 2, 0.5));
    std::vector<std::vector<std::int32_t>> wide(hood.n);
    std::size_t whole = 0;
    for (std::size_t i = 0; i < hood.n; ++i) {
      wide[i].assign(hood.list.begin(i), hood.list.begin(i) + hood.list.count(i));
      whole += (wide[i].size() + simd::pair_lanes - 1) / simd::pair_lanes;
      ASSERT_EQ(asked(hood.list, i), wide[i]) << i;
    }
    const double bytes = hood.list.list_bytes();
    hood.list.keep_narrow();
    for (const int threads : {1, 3}) {
      omp_set_num_threads(threads);
      hood.build();
      for (std::size_t i = 0; i < hood.n; ++i) {
        ASSERT_EQ(decoded(hood.list, i), wide[i]) << i;
        ASSERT_EQ(asked(hood.list, i), wide[i]) << i;
      }
      const std::size_t half = wide[0].size() / 2;
      EXPECT_EQ(asked(hood.list, 0, wide[0][half]),
                std::vector<std::int32_t>(wide[0].begin(), wide[0].begin() + static_cast<std::ptrdiff_t>(half) + 1));
    }
    // One batch more than there must be where images are too far for the base of the particles, and nowhere else.
    EXPECT_GE(batches_of(hood.list), whole);
    EXPECT_EQ(batches_of(hood.list) > whole, hood.list.points() > narrow_reach);
    EXPECT_LT(hood.list.list_bytes(), 0.8 * bytes);
    EXPECT_THROW(hood.list.of(0), std::logic_error);
  }
}

struct SceneCase {
  const char* name;
  int dimensions;
  double support_radius;
  std::array<ImageKind, 3> sides;
  std::vector<Point> points;
};
void PrintTo(const SceneCase& scene, std::ostream* out) {
  *out << scene.name;
}

std::vector<Point> with_outsiders(std::vector<Point> points, int dimensions) {
  for (std::size_t i = 0; i < 60; ++i) {
    Point p = uniform(i, 3);
    for (int axis = 0; axis < dimensions; ++axis) p[axis] = 3 * p[axis] - 1;
    if (dimensions == 2) p[2] = 0;
    points.push_back(p);
  }
  return points;
}

class EveryScene : public testing::TestWithParam<SceneCase> {};

TEST_P(EveryScene, ListsEqualBruteForceAndPairsAreSymmetric) {
  const SceneCase& scene = GetParam();
  const Neighbourhood hood(
      unit_box_rules(scene.dimensions, scene.support_radius, scene.sides[0], scene.sides[1], scene.sides[2]),
      scene.points);
  expect_lists_match_brute_force(hood);
  expect_pairs_symmetric(hood);
}

INSTANTIATE_TEST_SUITE_P(
    Neighbours, EveryScene,
    testing::Values(
        SceneCase{"random_2d", 2, 0.11, {none, none, none}, random_points(900, 2)},
        SceneCase{"random_3d", 3, 0.23, {none, none, none}, random_points(1500, 3)},
        SceneCase{"random_periodic_2d", 2, 0.11, {periodic, periodic, none}, random_points(900, 2)},
        SceneCase{"random_periodic_3d", 3, 0.23, {periodic, periodic, periodic}, random_points(900, 3)},
        SceneCase{"random_mirror_2d", 2, 0.11, {mirror, mirror, none}, random_points(900, 2)},
        SceneCase{"random_mixed_3d", 3, 0.23, {periodic, mirror, none}, random_points(900, 3)},
        SceneCase{"clustered_2d", 2, 0.06, {periodic, mirror, none}, clustered_points(900, 2, 0.06)},
        SceneCase{"clustered_3d", 3, 0.1, {mirror, periodic, mirror}, clustered_points(1200, 3, 0.1)},
        // On a lattice of ten cells with a support radius of three spacings, distances equal the support radius up to
        // rounding and points lie on borders of the quarter-support columns.
        SceneCase{"lattice_at_reach_2d", 2, 0.3, {periodic, mirror, none}, lattice_points(10, 2, 0)},
        SceneCase{"lattice_at_reach_3d", 3, 0.3, {periodic, mirror, none}, lattice_points(10, 3, 0)},
        SceneCase{"jittered_lattice_3d", 3, 0.26, {periodic, periodic, mirror}, lattice_points(10, 3, 0.4)},
        SceneCase{"outside_the_grid_2d", 2, 0.11, {none, none, none}, with_outsiders(random_points(400, 2), 2)},
        SceneCase{"outside_the_grid_3d", 3, 0.23, {none, none, none}, with_outsiders(random_points(600, 3), 3)},
        SceneCase{"support_as_large_as_the_domain", 3, 1.0, {periodic, periodic, none}, random_points(60, 3)}),
    [](const auto& info) { return std::string(info.param.name); });

class SmallSets : public testing::TestWithParam<int> {};

TEST_P(SmallSets, NoParticleNoNeighbours) {
  const Neighbourhood hood(unit_box_rules(GetParam(), 0.1, periodic, mirror, none), {});
  EXPECT_EQ(hood.list.particles(), 0U);
  EXPECT_EQ(hood.list.points(), 0U);
  EXPECT_EQ(hood.list.pair_count(), 0);
}

TEST_P(SmallSets, OneParticleInTheOpenHasNoNeighbourAndItsOwnImageNearAWall) {
  const Neighbourhood open(unit_box_rules(GetParam(), 0.1, none, none, none), {{0.01, 0.5, 0}});
  EXPECT_EQ(open.list.count(0), 0);
  const Neighbourhood wall(unit_box_rules(GetParam(), 0.1, mirror, none, none), {{0.01, 0.5, 0}});
  EXPECT_THAT(wall.list.of(0), testing::ElementsAre(1));
}

TEST_P(SmallSets, CoincidentParticlesAreEachOthersNeighbours) {
  const Neighbourhood hood(unit_box_rules(GetParam(), 0.1, none, none, none), {{0.3, 0.3, 0}, {0.3, 0.3, 0}});
  EXPECT_THAT(hood.list.of(0), testing::ElementsAre(1));
  EXPECT_THAT(hood.list.of(1), testing::ElementsAre(0));
}

TEST_P(SmallSets, ManyCoincidentParticlesAreAllNeighbours) {
  const Neighbourhood hood(unit_box_rules(GetParam(), 0.1, none, none, none), std::vector<Point>(700, {0.3, 0.3, 0}));
  EXPECT_EQ(hood.list.pair_count(), 700 * 699);
}

INSTANTIATE_TEST_SUITE_P(Neighbours, SmallSets, testing::Values(2, 3));

TEST(NeighbourList, CellBordersLoseNoNeighbour) {
  // Pairs a little nearer than the support radius, one end on a corner of a cell, in all directions.
  for (const int dimensions : {2, 3}) {
    const double support_radius = 0.1;
    const ImageRules rules = unit_box_rules(dimensions, support_radius, none, none, none);
    for (int corner = 0; corner < 12; ++corner)
      for (int direction = 0; direction < 26; ++direction) {
        const int step[3] = {direction % 3 - 1, direction / 3 % 3 - 1, dimensions == 3 ? direction / 9 - 1 : 0};
        const double length = std::sqrt(double(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]));
        if (length == 0) continue;
        const Point a{0.2 + 0.025 * corner, 0.2 + 0.05 * corner, dimensions == 3 ? 0.2 + 0.05 * corner : 0};
        Point b = a;
        for (int axis = 0; axis < dimensions; ++axis) b[axis] += support_radius * (1 - 1e-5) * step[axis] / length;
        const Neighbourhood hood(rules, {a, b});
        ASSERT_EQ(hood.list.pair_count(), 2) << corner << ' ' << direction;
      }
  }
}

TEST(NeighbourList, PairsFarFromTheOriginOfALongDomainStaySymmetricAndComplete) {
  // 20,000 support radii long: float coordinates at the ends resolve 1e-3 radii, much more than a rounding of the
  // radius.
  ImageRules rules = unit_box_rules(2, 0.01, none, none, none);
  rules.lower = {-100, -100, 0};
  rules.upper = {100, 100, 0};
  std::vector<Point> points = random_points(1200, 2);
  for (Point& p : points) {
    p[0] = 99.8 + 0.2 * p[0];
    p[1] = 99.8 + 0.2 * p[1];
  }
  Neighbourhood hood(rules, points);
  expect_lists_match_brute_force(hood);
  expect_pairs_symmetric(hood);
}

// What the list of i holds, as sources and places; of points within rounding of the support radius alone.
using Seen = std::set<std::pair<std::int32_t, std::array<std::int64_t, 3>>>;
Seen::value_type seen_point(std::int32_t source, const Point& place) {
  Seen::value_type point{source, {}};
  for (int axis = 0; axis < 3; ++axis) point.second[axis] = std::llround(place[axis] * 1e9);
  return point;
}

// `boxes` and, in the solid alone, the first of them once more.
void expect_lists_hold_what_is_seen(const ImageRules& base, const std::vector<SolidBox>& boxes, std::size_t points) {
  ImageRules rules = base;
  std::vector<SolidBox> repeated = boxes;
  repeated.push_back(boxes.front());
  rules.solids = unite(rules, repeated, 0.05);
  std::vector<Point> liquid;
  for (const Point& p : random_points(points, rules.dimensions))
    if (!inside_any(boxes, p, rules.dimensions)) liquid.push_back(p);
  const Neighbourhood hood(rules, liquid);
  const double tolerance = distance_tolerance(hood);
  const std::vector<Point> all = hood.all();
  const std::vector<Point> sorted(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(hood.n));
  auto candidates = reference::images(rules, sorted, boxes);
  for (std::size_t j = 0; j < hood.n; ++j) candidates.push_back({sorted[j], static_cast<std::int32_t>(j), {}});
  std::size_t hidden = 0, reflected = 0;
  for (std::size_t i = 0; i < hood.n; ++i) {
    Seen expected, found;
    const auto certain = [&](const Point& place) {
      double distance2 = 0;
      for (int axis = 0; axis < rules.dimensions; ++axis) distance2 += std::pow(place[axis] - sorted[i][axis], 2);
      return distance2 > 0 && std::sqrt(distance2) < rules.support_radius - tolerance;
    };
    for (const auto& image : candidates) {
      if (!certain(image.position)) continue;
      const Point end = reference::end_of_ray(rules, image, sorted[static_cast<std::size_t>(image.source)]);
      const bool seen = reference::sees(rules, boxes, sorted[i], image.position, end);
      hidden += !seen && image.path == ImagePath{} ? 1 : 0;
      reflected += seen && image.path != ImagePath{} ? 1 : 0;
      if (seen) expected.insert(seen_point(image.source, image.position));
    }
    for (const std::int32_t j : hood.list.of(i)) {
      const auto k = static_cast<std::size_t>(j);
      if (certain(all[k])) found.insert(seen_point(k < hood.n ? j : hood.images.source()[k - hood.n], all[k]));
    }
    ASSERT_EQ(found, expected) << i;
  }
  EXPECT_GT(hidden, 10U) << "some liquid lies behind solids";
  EXPECT_GT(reflected, hood.n / 2);
}

TEST(NeighbourList, HoldsWhatAParticleSeesAroundBoxesThatTouchOverlapRepeatOrAreThin) {
  constexpr auto slip = BoundaryKind::free_slip;
  for (const int dimensions : {2, 3}) {
    const ImageRules rules = unit_box_rules(dimensions, 0.15, mirror, periodic, mirror);
    // Side by side, over each other, and a plate.
    // No gap is narrower than the support radius: the twin reflects once along an axis.
    const std::vector<SolidBox> boxes{{{0.33, 0.3, 0.3}, {0.5, 0.7, 0.84}, slip},
                                      {{0.5, 0.3, 0.3}, {0.7, 0.7, 0.84}, slip},
                                      {{0.4, 0.5, 0.2}, {0.84, 0.8, 0.6}, slip},
                                      {{0.16, 0.2, 0.16}, {0.17, 0.8, 0.8}, slip}};
    expect_lists_hold_what_is_seen(rules, boxes, dimensions == 2 ? 600 : 900);
  }
}

TEST(NeighbourList, PointsSeeEachOtherAroundABox) {
  ImageRules rules = unit_box_rules(2, 0.21, mirror, periodic, mirror);
  const std::vector<SolidBox> boxes{{{0.3, 0.3, 0}, {0.8, 0.7, 0}, BoundaryKind::free_slip}};
  rules.solids = unite(rules, boxes, 0.05);
  std::vector<Point> liquid;
  for (const Point& p : random_points(700, 2))
    if (!inside_any(boxes, p, 2)) liquid.push_back(p);
  expect_pairs_symmetric(Neighbourhood(rules, liquid));
  expect_reflections_symmetric(Neighbourhood(rules, liquid));
}

TEST(NeighbourList, ALatticeAroundSolidsSeesALattice) {
  // Every site within the support of a particle is seen once, liquid or image, at edges and in corners too, but for the
  // one that stands exactly behind a convex edge.
  const int m = 20;
  const double spacing = 1.0 / m;
  ImageRules rules = unit_box_rules(2, 2.6 * spacing, mirror, mirror, none);
  const std::vector<SolidBox> boxes{{{0.3, 0, 0}, {0.5, 0.2, 0}, BoundaryKind::free_slip},
                                    {{0.5, 0, 0}, {1, 0.4, 0}, BoundaryKind::free_slip},
                                    {{0.2, 0.5, 0}, {0.25, 0.8, 0}, BoundaryKind::free_slip},
                                    {{0.4, 0.6, 0}, {0.6, 0.65, 0}, BoundaryKind::free_slip}};
  rules.solids = unite(rules, boxes, spacing);
  std::vector<Point> liquid;
  for (const Point& p : lattice_points(m, 2, 0))
    if (!inside_any(boxes, p, 2)) liquid.push_back(p);
  const Neighbourhood hood(rules, liquid);
  const std::vector<Point> all = hood.all();
  const auto solid = [&](const Point& p) {
    return inside_any(boxes, p, 2) || p[0] < 0 || p[0] > 1 || p[1] < 0 || p[1] > 1;
  };
  int edges = 0;
  for (std::size_t i = 0; i < hood.n; ++i) {
    std::set<std::array<std::int64_t, 2>> sites;
    for (const std::int32_t j : hood.list.of(i)) {
      const Point& p = all[static_cast<std::size_t>(j)];
      sites.insert({std::llround((p[0] - all[i][0]) / spacing), std::llround((p[1] - all[i][1]) / spacing)});
    }
    int behind_edges = 0;
    for (const double x : {-spacing, spacing})
      for (const double y : {-spacing, spacing})
        behind_edges += solid({all[i][0] + x, all[i][1] + y, 0}) && !solid({all[i][0] + x, all[i][1], 0}) &&
                                !solid({all[i][0], all[i][1] + y, 0})
                            ? 1
                            : 0;
    edges += behind_edges;
    ASSERT_EQ(sites.size(), 20U - static_cast<unsigned>(behind_edges)) << all[i][0] << ' ' << all[i][1];
    ASSERT_EQ(hood.list.count(i), 20 - behind_edges) << all[i][0] << ' ' << all[i][1];
  }
  EXPECT_EQ(edges, 10) << "a stair has two convex edges, a plate four";
}

// On a lattice half a spacing from every face, rays to diagonal neighbours pass exactly through edges and corners.
TEST(NeighbourList, ParticlesOfALatticeAroundSolidsSeeEachOther) {
  constexpr auto slip = BoundaryKind::free_slip;
  const int m = 12;
  const double spacing = 1.0 / m;
  const auto at = [&](int k) { return k * spacing; };
  for (const int dimensions : {2, 3}) {
    ImageRules rules = unit_box_rules(dimensions, 2.6 * spacing, mirror, periodic, mirror);
    // A box; two that meet in an edge, in 3-D in a corner; a plate; a box at a wall.
    const std::vector<SolidBox> boxes{{{at(1), at(2), at(1)}, {at(4), at(4), at(3)}, slip},
                                      {{at(6), at(6), at(6)}, {at(8), at(8), at(8)}, slip},
                                      {{at(8), at(8), at(8)}, {at(10), at(10), at(10)}, slip},
                                      {{at(2), at(7), at(2)}, {at(5), at(8), at(9)}, slip},
                                      {{at(9), at(2), at(0)}, {at(12), at(5), at(6)}, slip}};
    rules.solids = unite(rules, boxes, spacing);
    std::vector<Point> liquid;
    for (const Point& p : lattice_points(m, dimensions, 0))
      if (!inside_any(boxes, p, dimensions)) liquid.push_back(p);
    expect_reflections_symmetric(Neighbourhood(rules, liquid));
  }
}

TEST(NeighbourList, ImageOfAParticleOutsideAWallIsSeenFromWithinItsReach) {
  // The first particle has left through the wall by 0.02; its image lies 0.02 inside.
  // Enough others lie between for the last particle to be searched on its own.
  std::vector<Point> points{{-0.02, 0.51, 0}, {0.115, 0.51, 0}};
  for (int k = 0; k < 63; ++k) points.push_back({0.06 + 1e-4 * k, 0.54, 0});
  const Neighbourhood hood(unit_box_rules(2, 0.1, mirror, none, none), points);
  expect_lists_match_brute_force(hood);
}

TEST(NeighbourList, ThreadCountDoesNotChangeLists) {
  const ImageRules rules = unit_box_rules(3, 0.13, periodic, mirror, none);
  const auto points = lattice_points(20, 3, 0.4);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = lists_of(Neighbourhood(rules, points).list);
  for (const int threads : {2, 3, 5}) {
    omp_set_num_threads(threads);
    EXPECT_EQ(lists_of(Neighbourhood(rules, points).list), one) << threads;
  }
  omp_set_num_threads(before);
}

TEST(NeighbourList, SecondBuildOfTheSameInputAllocatesNothingAndEqualsTheFirst) {
  const int before = omp_get_max_threads();
  // With one thread the per-thread scratch of the first build serves the second whatever the schedule.
  omp_set_num_threads(1);
  ImageRules rules = unit_box_rules(3, 0.13, periodic, mirror, mirror);
  rules.solids = unite(rules, {{{0.4, 0.4, 0}, {0.6, 0.7, 0.5}, BoundaryKind::free_slip}}, 0.05);
  Neighbourhood hood(rules, lattice_points(20, 3, 0.4));
  const auto first = lists_of(hood.list);
  hood.build();
  const auto allocations = array_statistics().allocations;
  hood.build();
  EXPECT_EQ(array_statistics().allocations, allocations);
  EXPECT_EQ(lists_of(hood.list), first);
  omp_set_num_threads(before);
}

TEST(NeighbourList, CoordinatesAreFloatsRelativeToTheOriginWithAFarSentinel) {
  const Neighbourhood hood(unit_box_rules(3, 0.2, periodic, mirror, none), random_points(50, 3));
  const auto all = hood.all();
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < all.size(); ++i)
      ASSERT_EQ(hood.list.coordinate(axis)[i], static_cast<float>(all[i][axis] - hood.origin[axis]));
    EXPECT_GE(hood.list.coordinate(axis)[hood.list.sentinel()], 1e5F * 0.2F);
  }
}

}  // namespace
}  // namespace spume::test
