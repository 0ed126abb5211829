// SPDX-License-Identifier: MIT
// Depths and layers below a surface against their slow twins, on every arrangement: with the normals that its shape
// gives, random ones and the diagonal. Errors are of float arithmetic: each of `count` neighbours adds some epsilons of
// squared distances, in spacings, to a sum; a mean normal also errs the more, the more the normals around cancel.
#include "spume/operators/surface_layers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "operators/sph_arrangement.hpp"
#include "reference/surface_layers.hpp"

namespace spume::test {
namespace {

using reference::SurfaceLayers;
using reference::Vector;

constexpr double epsilon = std::numeric_limits<float>::epsilon();

// Those that the shape gives, random ones, and all of them along the diagonal, where the sentinel of the lists lies.
enum class Normals { of_shape, random, diagonal };
constexpr Normals all_normals[] = {Normals::of_shape, Normals::random, Normals::diagonal};

struct Surface {
  Arrangement& a;
  VectorArrays<float> normal;
  std::vector<Vector> exact;  // the same numbers
  std::vector<std::int32_t> edge;

  // The fraction of the particles at the edge.
  Surface(Arrangement& arrangement, double fraction, Normals normals)
      : a(arrangement), normal(a.size(), a.dimensions()) {
    exact.resize(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (int axis = 0; axis < a.dimensions(); ++axis) normal[axis][i] = 0;
      if (uniform(i, 41)[0] >= fraction) continue;
      const auto sums = a.twin.normal(i);
      const Point draw = uniform(i, 42);
      double size = 0;
      for (int axis = 0; axis < a.dimensions(); ++axis) {
        exact[i][axis] = normals == Normals::random     ? draw[axis] - 0.5
                         : normals == Normals::diagonal ? 1
                                                        : sums[axis].value;
        size += exact[i][axis] * exact[i][axis];
      }
      if (size == 0) continue;
      for (int axis = 0; axis < a.dimensions(); ++axis) {
        normal[axis][i] = static_cast<float>(exact[i][axis] / std::sqrt(size));
        exact[i][axis] = normal[axis][i];
      }
      edge.push_back(static_cast<std::int32_t>(i));
    }
  }
  SurfaceLayers twin() const { return {a.twin, {a.setup.kernel, a.dimensions()}, a.setup.spacing, exact}; }
  // Of the support, in spacings.
  double support_radius() const {
    const double largest = a.setup.sizes ? largest_length_ratio : 1;
    return largest * PlainKernel{a.setup.kernel, a.dimensions()}.support() * a.setup.smoothing_length() /
           a.setup.spacing;
  }
  double rounding(std::size_t i) const { return epsilon * static_cast<double>(a.twin.neighbours(i) + 4); }
};

TEST(SurfaceLayers, DepthsAgreeWithTheSlowTwin) {
  std::size_t between = 0;  // neither of the limits
  for (Arrangement& a : all_arrangements())
    for (const Normals normals : all_normals) {
      SCOPED_TRACE(a.setup.name);
      const Surface surface(a, 0.5, normals);
      const SurfaceLayers twin = surface.twin();
      Array<float> scratch(a.size()), depth(surface.edge.size());
      surface_depths(a.context, a.packed, {a.setup.spacing, surface.edge, surface.normal.read()}, scratch, depth);
      Comparison depths("depth");
      const double support_radius = surface.support_radius();
      for (std::size_t k = 0; k < surface.edge.size(); ++k) {
        const auto i = static_cast<std::size_t>(surface.edge[k]);
        const double slow = twin.depth(i), spacing = a.setup.spacing;
        depths.add_error(std::abs(depth[k] - slow),
                         spacing * surface.rounding(i) * (8 * support_radius * support_radius + 64 * support_radius),
                         depth[k], slow, i);
        between += slow > 0.26 * spacing && slow < 1.99 * spacing ? 1 : 0;
      }
    }
  EXPECT_GT(between, 1000u);
}

TEST(SurfaceLayers, UpperLayersAreThoseBesideAnEdgeParticle) {
  std::size_t upper = 0, others = 0;
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Surface surface(a, 0.03, Normals::random);
    const std::vector<bool> expected = surface.twin().upper();
    Array<std::uint8_t> beside(a.size());
    mark_upper_layers(a.context, a.setup.spacing, surface.edge, beside);
    for (std::size_t i = 0; i < a.size(); ++i) {
      (expected[i] ? upper : others) += 1;
      ASSERT_EQ(beside[i] != 0, expected[i]) << "particle " << i;
    }
  }
  EXPECT_GT(upper, 1000u);
  EXPECT_GT(others, 1000u);
}

TEST(SurfaceLayers, WhatLayersShareAgreesWithTheSlowTwin) {
  std::size_t partly = 0;
  for (Arrangement& a : all_arrangements())
    for (const Normals normals : all_normals) {
      SCOPED_TRACE(a.setup.name);
      const Surface surface(a, normals == Normals::of_shape ? 0.5 : 0.05, normals);
      const SurfaceLayers twin = surface.twin();
      const std::vector<bool> is_upper = twin.upper();
      std::vector<std::int32_t> upper;
      for (std::size_t i = 0; i < a.size(); ++i)
        if (is_upper[i]) upper.push_back(static_cast<std::int32_t>(i));
      VectorArrays<float> vector(a.size(), a.dimensions());
      std::vector<Vector> exact(a.size());
      for (int axis = 0; axis < a.dimensions(); ++axis) {
        const auto values = a.random(50 + static_cast<std::uint32_t>(axis));
        for (std::size_t i = 0; i < a.size(); ++i) exact[i][axis] = vector[axis][i] = static_cast<float>(values[i]);
      }
      Array<std::array<float, 3>> shared(upper.size());
      shared_along_normal(a.context, a.packed, a.setup.spacing, surface.normal.read(), vector.read(), a.reflection,
                          upper, shared);
      Comparison comparison("shared part");
      for (std::size_t k = 0; k < upper.size(); ++k) {
        const auto i = static_cast<std::size_t>(upper[k]);
        const auto slow = twin.shared(i, exact);
        partly += slow.c < 1 ? 1 : 0;
        const double bound = surface.rounding(i) * 64 * surface.support_radius() * (1 + 1 / slow.of_normals);
        for (int axis = 0; axis < a.dimensions(); ++axis)
          comparison.add_error(std::abs(shared[k][axis] - slow.value[axis]), bound, shared[k][axis], slow.value[axis],
                               i);
      }
    }
  EXPECT_GT(partly, 1000u);
}

}  // namespace
}  // namespace spume::test
