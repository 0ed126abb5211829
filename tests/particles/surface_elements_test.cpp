// SPDX-License-Identifier: MIT
#include "spume/particles/surface_elements.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <queue>
#include <random>

#include "particles/walled.hpp"

namespace spume::test {
namespace {

using Role = SurfaceElements::Role;

struct Surface {
  LoadedCase loaded;
  Resolution resolution;
  BodyWalls walls;
  SurfaceElements elements;

  Surface(const std::string& domain, double spacing, const std::string& bodies)
      : Surface(scene_text(domain, spacing, bodies)) {}
  explicit Surface(const std::string& text)
      : loaded(load_text(text)),
        resolution(loaded.scene.domain.dimensions, loaded.scene.spacing, KernelKind::wendland_c2, 1.3),
        walls(loaded.scene, resolution, loaded.scene.particles.volume),
        elements(loaded.scene, walls, loaded.scene.spacing) {}
};

const std::string space = "lower = [-1, -1, -1]\nupper = [1, 1, 1]\nbottom = \"open\"\n";
const std::string trapezoid =
    "[[body]]\nshape = \"outline\"\npoints = [[-0.5, -0.1], [0.5, -0.1], [0.15, 0.1], [-0.15, 0.1]]\n";
const std::string box = "[[body]]\nshape = \"box\"\nsize = [0.7, 0.31, 0.13]\nrotation = [10, 20, 30]\n";
const std::string cylinder = "[[body]]\nshape = \"cylinder\"\nradius = 0.4\nlength = 0.07\n";
const std::string sphere = "[[body]]\nshape = \"ball\"\nradius = 0.5\n";

// Steps from each element to the nearest of a set, by one search over all.
std::vector<int> steps_from(const SurfaceElements& elements, const std::vector<std::size_t>& set) {
  std::vector<int> steps(elements.size(), -1);
  std::queue<std::size_t> ahead;
  for (const std::size_t e : set) {
    steps[e] = 0;
    ahead.push(e);
  }
  for (; !ahead.empty(); ahead.pop())
    for (const std::int32_t e : elements.beside(ahead.front())) {
      const auto k = static_cast<std::size_t>(e);
      if (steps[k] >= 0) continue;
      steps[k] = steps[ahead.front()] + 1;
      ahead.push(k);
    }
  return steps;
}

}  // namespace

// In spacings of 0.1, which do not divide the tank: below the waterline the area of the flap is that of the tank, whose
// sides no element goes across, and few lie above the lid. Before, 98 % lay beside the tank, and the area was off by as
// much as an element at either side is wide.
TEST(SurfaceElements, OfAFlapEndAtTheSidesOfTheTank) {
  const Surface flap(replaced(
      scene_text("lower = [0, 0, 0]\nupper = [3, 0.73, 1.3]\nleft = \"free-slip\"\nright = \"free-slip\"\nfront = "
                 "\"free-slip\"\nback = \"free-slip\"\nbottom = \"free-slip\"\n",
                 0.1,
                 "[[wavemaker]]\nside = \"left\"\nkind = \"flap\"\ndepth = 0.83\nwaves = \"regular\"\nheight = "
                 "0.1\nperiod = 2\n",
                 "upper = [3, 0.73, 0.83]\n"),
      "reynolds = 100\n", "reynolds = 100\nfroude = 1\n"));
  double area = 0, moment = 0;
  for (std::size_t e = 0; e < flap.elements.size(); ++e) {
    const SurfaceElements::Element element = flap.elements[e];
    EXPECT_GT(element.middle[1], 0);
    EXPECT_LT(element.middle[1], 0.73);
    EXPECT_GT(element.middle[2], 0);
    if (std::abs(element.area[0]) < 0.9 * length(element.area)) continue;
    area += element.area[0];
    moment += element.area[0] * element.middle[1];
  }
  const double height = 1.3 + std::sqrt(3 * 3 + 0.73 * 0.73 + 1.3 * 1.3);  // beyond an open top a diagonal more
  EXPECT_NEAR(area, 0.73 * height, 1e-6);
  EXPECT_NEAR(moment, 0.5 * 0.73 * area, 1e-6);
}

// In the plane an element has one neighbour at either end, whatever the angle between them; in space those around it.
TEST(SurfaceElements, AClosedSurfaceIsOnePiece) {
  for (const auto& [domain, spacing, body] : {std::tuple{square, 0.05, trapezoid},
                                              {square, 0.05, disc},
                                              {space, 0.06, box},
                                              {space, 0.06, cylinder},
                                              {space, 0.08, sphere}}) {
    SCOPED_TRACE(body);
    const Surface surface(domain, spacing, body);
    const SurfaceElements& elements = surface.elements;
    ASSERT_GT(elements.size(), 20U);
    Vec3 sum{};
    double size = 0;
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const auto beside = elements.beside(e);
      if (surface.loaded.scene.domain.dimensions == 2)
        EXPECT_EQ(beside.size(), 2U) << e;
      else
        EXPECT_GE(beside.size(), 3U) << e;
      double last = 0;
      for (const std::int32_t other : beside) {
        const auto back = elements.beside(static_cast<std::size_t>(other));
        EXPECT_NE(std::find(back.begin(), back.end(), static_cast<std::int32_t>(e)), back.end());
        const double away = length(subtract(elements[static_cast<std::size_t>(other)].middle, elements[e].middle));
        EXPECT_GE(away, last - 1e-12);
        last = away;
      }
      sum = add(sum, elements[e].area);
      size += length(elements[e].area);
    }
    EXPECT_LT(length(sum), 1e-12 * size);
    for (const int steps : steps_from(elements, {0})) EXPECT_GE(steps, 0);
  }
}

// One that an expression gives has the elements of its outline alone: the edges between the cells that it was found in
// counted as well.
TEST(SurfaceElements, OfAnExpressionAreThoseOfItsOutline) {
  const double perimeter = 2 * std::numbers::pi * 0.4;
  const std::string circle = "[[body]]\nwhere = \"0.4^2 - x^2 - y^2\"\n",
                    diamond = "[[body]]\nwhere = \"0.4 - abs(x) - abs(y)\"\n";
  for (const auto& [body, length_of] : {std::pair{circle, perimeter}, {diamond, 4 * 0.4 * std::numbers::sqrt2}}) {
    SCOPED_TRACE(body);
    const Surface surface(square, 0.05, body);
    Vec3 sum{};
    double size = 0;
    for (std::size_t e = 0; e < surface.elements.size(); ++e) {
      EXPECT_EQ(surface.elements.beside(e).size(), 2U);
      EXPECT_GT(length(surface.elements[e].area), 1e-4 * 0.05);
      sum = add(sum, surface.elements[e].area);
      size += length(surface.elements[e].area);
    }
    EXPECT_NEAR(size, length_of, 0.01 * length_of);
    EXPECT_LT(length(sum), 1e-3 * size);
  }
}

// Two entries that stand on each other are one surface; what lies between them is a way to nowhere.
TEST(SurfaceElements, OfTwoBodiesThatStandOnEachOtherMeet) {
  const Surface surface(square, 0.05,
                        "[[body]]\nshape = \"box\"\nsize = [0.9, 0.05]\nposition = [0, 0.025]\n"
                        "[[body]]\nshape = \"box\"\nsize = [0.9, 0.4]\nposition = [0, 0.25]\n");
  bool meets = false;
  for (std::size_t e = 0; e < surface.elements.size(); ++e)
    for (const std::int32_t other : surface.elements.beside(e))
      meets = meets || surface.elements[static_cast<std::size_t>(other)].body != surface.elements[e].body;
  EXPECT_TRUE(meets);
}

// Those that seek have the source or end of the fewest steps, a source where both are as near.
TEST(SurfaceElements, SourcesAreTheNearestAlongTheSurface) {
  for (const auto& [domain, spacing, body] :
       {std::tuple{square, 0.05, trapezoid}, {space, 0.06, box}, {space, 0.08, sphere}}) {
    SCOPED_TRACE(body);
    const Surface surface(domain, spacing, body);
    const SurfaceElements& elements = surface.elements;
    std::mt19937 generator(7);
    std::vector<Role> role(elements.size(), Role::seeks);
    std::vector<std::size_t> known, sources, seeking;
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const auto draw = generator() % 20;
      if (draw < 2) role[e] = draw == 0 ? Role::source : Role::end;
      if (draw < 2) known.push_back(e);
      if (draw == 0) sources.push_back(e);
      if (draw >= 2) seeking.push_back(e);
    }
    const std::vector<int> steps = steps_from(elements, known), to_source = steps_from(elements, sources);
    const std::vector<std::int32_t> nearest = elements.nearest_sources(role, seeking);
    for (std::size_t k = 0; k < seeking.size(); ++k) {
      ASSERT_GE(nearest[k], 0);
      const auto found = static_cast<std::size_t>(nearest[k]);
      ASSERT_NE(role[found], Role::seeks);
      EXPECT_EQ(steps_from(elements, {found})[seeking[k]], steps[seeking[k]]);
      if (to_source[seeking[k]] == 1 && steps[seeking[k]] == 1) EXPECT_EQ(role[found], Role::source);
    }
  }
}

}  // namespace spume::test
