// SPDX-License-Identifier: MIT
#include "spume/particles/thin_regions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace spume::test {
namespace {

// A lattice of phases: region and phase of the particle at a place.
Scene lattice(int dimensions, const std::array<bool, 3>& periodic, double spacing,
              const std::function<int(const Vec3&)>& region) {
  Scene scene;
  scene.phases.resize(2);
  scene.spacing = spacing;
  scene.domain.dimensions = dimensions;
  const std::array<int, 3> count{10, 8, dimensions == 3 ? 7 : 1};
  for (int axis = 0; axis < dimensions; ++axis) {
    scene.domain.upper[axis] = count[axis] * spacing;
    for (Side& side : scene.domain.sides[axis])
      side.kind = periodic[axis] ? BoundaryKind::periodic : BoundaryKind::free_slip;
  }
  const std::size_t size = static_cast<std::size_t>(count[0] * count[1] * count[2]);
  for (int axis = 0; axis < dimensions; ++axis) scene.particles.position[axis].resize(size);
  scene.particles.region.resize(size);
  scene.particles.phase.resize(size);
  std::size_t i = 0;
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x, ++i) {
        const Vec3 at{(x + 0.5) * spacing, (y + 0.5) * spacing, dimensions == 3 ? (z + 0.5) * spacing : 0};
        for (int axis = 0; axis < dimensions; ++axis) scene.particles.position[axis][i] = at[axis];
        scene.particles.region[i] = region(at);
        scene.particles.phase[i] = region(at) % 2;
      }
  return scene;
}

// All pairs, with all copies of the neighbours beyond periodic sides.
std::vector<ThinRegion> by_all_pairs(const Scene& scene, double width) {
  const InitialParticles& particles = scene.particles;
  std::vector<ThinRegion> thin;
  for (int r = 0; r < 4; ++r) {
    double farthest = -1;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (particles.region[i] != r) continue;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < particles.size(); ++j) {
        if (particles.phase[j] == particles.phase[i]) continue;
        double sum = 0;
        for (int axis = 0; axis < scene.domain.dimensions; ++axis) {
          const double d = std::abs(particles.position[axis][i] - particles.position[axis][j]);
          const double length = scene.domain.upper[axis];
          sum += std::pow(scene.domain.periodic(axis) ? std::min(d, length - d) : d, 2);
        }
        nearest = std::min(nearest, std::sqrt(sum));
      }
      farthest = std::max(farthest, nearest);
    }
    if (farthest >= 0 && 2 * farthest - scene.spacing < width * (1 - 1e-6))
      thin.push_back({static_cast<std::size_t>(r), 2 * farthest - scene.spacing});
  }
  return thin;
}

}  // namespace

TEST(ThinRegions, AreThoseOfAllPairs) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::size_t found = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int dimensions = 2 + trial % 2;
    const std::array<bool, 3> periodic{trial % 3 == 0, trial % 5 == 0, trial % 7 == 0};
    std::array<Vec3, 3> centre;
    std::array<double, 3> radius;
    for (std::size_t b = 0; b < 3; ++b) {
      for (double& x : centre[b]) x = uniform(random);
      radius[b] = 0.1 + 0.25 * uniform(random);
    }
    if (dimensions == 2)
      for (Vec3& at : centre) at[2] = 0;
    const Scene scene = lattice(dimensions, periodic, 0.1, [&](const Vec3& at) {
      for (std::size_t b = 0; b < 3; ++b)
        if (std::hypot(at[0] - centre[b][0], at[1] - centre[b][1], at[2] - centre[b][2]) < radius[b])
          return static_cast<int>(b) + 1;
      return 0;
    });
    for (const double width : {0.1, 0.26, 0.5}) {
      const auto expected = by_all_pairs(scene, width), thin = thin_regions(scene, width);
      ASSERT_EQ(thin.size(), expected.size()) << trial << " " << width;
      found += thin.size();
      for (std::size_t k = 0; k < thin.size(); ++k) {
        EXPECT_EQ(thin[k].region, expected[k].region) << trial;
        EXPECT_NEAR(thin[k].width, expected[k].width, 1e-12) << trial;
      }
    }
  }
  EXPECT_GT(found, 20U);
}

// Layers across a periodic side are whole.
TEST(ThinRegions, GoOnBehindPeriodicSides) {
  const auto two_rows = [](const Vec3& at) { return at[1] < 0.1 || at[1] > 0.7 ? 1 : 0; };
  const Scene whole = lattice(2, {false, true, false}, 0.1, two_rows);
  ASSERT_EQ(thin_regions(whole, 0.26).size(), 1U);
  EXPECT_NEAR(thin_regions(whole, 0.26)[0].width, 0.1, 1e-12);
  Scene one = whole;
  one.phases.resize(1);
  EXPECT_TRUE(thin_regions(one, 0.26).empty());
}

}  // namespace spume::test
