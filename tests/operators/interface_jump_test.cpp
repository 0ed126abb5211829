// SPDX-License-Identifier: MIT
// Pairwise jumps at interfaces against slow twins, and against the pressure that they balance.
#include "spume/operators/interface_jump.hpp"

#include <gtest/gtest.h>

#include "operators/gfd_arrangement.hpp"
#include "spume/operators/gfd_gradient.hpp"
#include "spume/operators/interface_filters.hpp"

namespace spume::test {
namespace {

// A drop of phase 1 a thousandth as dense as what surrounds it, with a random potential.
struct Drop {
  Arrangement& a;
  Stencils stencils;
  std::vector<std::uint8_t> phase;
  InterfaceBands bands;
  Array<float> colour, density, potential, weight;

  explicit Drop(Arrangement& arrangement)
      : a(arrangement),
        stencils(a),
        phase(a.size()),
        colour(a.size()),
        density(a.size()),
        potential(a.size()),
        weight(a.size()) {
    const auto inside = a.sample([&](const Point& p) {
      return std::hypot(p[0] - 0.5, p[1] - 0.5, a.dimensions() == 3 ? p[2] - 0.5 : 0) < 0.3 ? 1.0 : 0.0;
    });
    const auto random = a.random(7);
    for (std::size_t i = 0; i < a.size(); ++i) {
      phase[i] = inside[i] > 0 ? 1 : 0;
      potential[i] = static_cast<float>(random[i]);
    }
    bands.build(a.context, a.hood.grid, a.hood.table, phase);
    const std::array<float*, 2> colours{nullptr, colour.data()};
    filter_colours(a.context, a.packed, bands, phase, colours);
    for (std::size_t i = 0; i < a.size(); ++i) {
      density[i] = 1000 - 999 * colour[i];
      weight[i] = 4 * colour[i] * (1 - colour[i]);
    }
  }
};

TEST(InterfaceJump, AgreesWithTheSlowTwinAndIsAdded) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Drop drop(a);
    const GfdSums& twin = gfd_twin(a);
    VectorArrays<float> acceleration(a.size(), a.dimensions());
    Array<double> source(a.size());
    source.fill(0.5);
    interface_jump_sweep(a.context, a.packed, drop.bands.varying(),
                         {drop.colour.data(), drop.potential.data(), drop.density.data()}, drop.stencils.read(),
                         {acceleration.write(), source.data()});
    Comparison accelerations("acceleration"), sources("source");
    std::vector<bool> varies(a.size(), false);
    for (const std::int32_t i : drop.bands.varying()) varies[static_cast<std::size_t>(i)] = true;
    const GfdSums::AtPoint colour = [&](const GfdSums::SphPoint& p) { return double(drop.colour[p.source]); };
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!varies[i]) {
        ASSERT_EQ(acceleration[0][i], 0);
        ASSERT_EQ(source[i], 0.5);
        continue;
      }
      const GfdSums::AtPoint factor = [&](const GfdSums::SphPoint& p) {
        return (double(drop.potential[i]) + drop.potential[p.source]) /
               (double(drop.density[i]) + drop.density[p.source]);
      };
      const auto stencil = drop.stencils.of(i);
      auto slow = twin.gradient(i, colour, factor, stencil.correction);
      auto lap = twin.laplacian(i, colour, factor, stencil);
      // A potential near zero is the sum of two that are not.
      for (int axis = 0; axis < a.dimensions(); ++axis) {
        slow[axis].magnitude = std::max(slow[axis].magnitude, 1e-3);
        accelerations.add(acceleration[axis][i], slow[axis], 4 * twin.tolerance(i), i);
      }
      lap.magnitude = std::max(lap.magnitude, 1.0);
      sources.add(source[i] - 0.5, lap, 4 * twin.tolerance(i), i);
    }
  });
}

// What makes a drop of uniform curvature static whatever the densities: the same sums, so that only their rounding
// differs.
TEST(InterfaceJump, OfAUniformPotentialIsBalancedByThePressureOfTheColour) {
  for_every_equal_arrangement([&](Arrangement& a) {
    Drop drop(a);
    const GfdSums& twin = gfd_twin(a);
    drop.potential.fill(3);
    VectorArrays<float> acceleration(a.size(), a.dimensions()), gradient(a.size(), a.dimensions());
    interface_jump_sweep(a.context, a.packed, drop.bands.varying(),
                         {drop.colour.data(), drop.potential.data(), drop.density.data()}, drop.stencils.read(),
                         {acceleration.write(), nullptr});
    Array<double> pressure(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) pressure[i] = 3 * double(drop.colour[i]);
    gfd_gradient_over_density_sweep(a.context, a.packed, pressure.data(), 0, {drop.density.data(), drop.bands.varies()},
                                    drop.stencils.read().correction, gradient.write());
    const GfdSums::AtPoint colour = [&](const GfdSums::SphPoint& p) { return double(drop.colour[p.source]); };
    Comparison difference("pressure gradient");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const GfdSums::AtPoint factor = [&](const GfdSums::SphPoint& p) {
        return 6 / (double(drop.density[i]) + drop.density[p.source]);
      };
      const auto slow = twin.gradient(i, colour, factor, drop.stencils.of(i).correction);
      for (int axis = 0; axis < a.dimensions(); ++axis)
        difference.add(acceleration[axis][i], {gradient[axis][i], slow[axis].magnitude}, 2 * twin.tolerance(i), i);
    }
  });
}

TEST(InterfaceAverage, IsTheWeightedMeanAndContinuesItAcrossTheBand) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Drop drop(a);
    const GfdSums& twin = gfd_twin(a);
    Array<float> average(a.size()), product(a.size());
    average.fill(-7);
    interface_average_sweep(a.context, a.packed, drop.bands.varying(), drop.weight.data(), drop.potential.data(),
                            average.data());
    for (std::size_t i = 0; i < a.size(); ++i) product[i] = drop.weight[i] * drop.potential[i];
    std::size_t found = 0;
    for (const std::int32_t s : drop.bands.varying()) {
      const auto i = static_cast<std::size_t>(s);
      const auto above = a.twin.filtered_scalar(i, product), below = a.twin.filtered_scalar(i, drop.weight);
      // Where hardly a weight is in reach the quotient is one of roundings.
      if (below.value < 1e-4) continue;
      ASSERT_NEAR(average[i], above.value / below.value,
                  4 * twin.tolerance(i) * (above.magnitude + below.magnitude) / below.value);
      ++found;
    }
    EXPECT_GT(found, 20U);
  });
}

}  // namespace
}  // namespace spume::test
