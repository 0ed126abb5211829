// SPDX-License-Identifier: MIT
// Generalised finite differences against their slow twins, on random fields over every arrangement. The twins are given
// the float stencils of the moment sweep: a sweep is held to its own arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "operators/gfd_arrangement.hpp"
#include "spume/operators/gfd_gradient.hpp"
#include "spume/operators/gfd_laplacian.hpp"
#include "spume/operators/sph_diffusion.hpp"

namespace spume::test {
namespace {

using SphPoint = GfdSums::SphPoint;

// Without sums of the kernel beside, and with them.
void expect_stencils(bool with_kernel) {
  std::size_t full = 0, no_offset = 0, isotropic = 0;
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils stencils(a, with_kernel);
    const GfdSums& twin = gfd_twin(a);
    const int d = a.dimensions();
    Comparison corrections("B"), offsets("o"), factors("Laplacian factor");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto slow = twin.stencil(i, 6, 0.1);
      // Rounding decides where the limits are passed by less than a hundredth.
      const auto easier = twin.stencil(i, 6.06, 0.099), harder = twin.stencil(i, 5.94, 0.101);
      if (easier.isotropic != harder.isotropic || easier.no_offset != harder.no_offset) continue;
      const auto expected = slow.isotropic   ? GfdFallback::isotropic
                            : slow.no_offset ? GfdFallback::no_offset
                                             : GfdFallback::none;
      ASSERT_EQ(stencils.fallback[i], expected) << "particle " << i;
      (slow.isotropic ? isotropic : slow.no_offset ? no_offset : full) += 1;
      const auto fast = stencils.of(i);
      for (int r = 0; r < d; ++r) {
        for (int c = 0; c < d; ++c)
          corrections.add_error(std::abs(fast.correction[r][c] - slow.value.correction[r][c]),
                                slow.bound.correction[r][c] + 1e-30, fast.correction[r][c], slow.value.correction[r][c],
                                i);
        offsets.add_error(std::abs(fast.offset[r] - slow.value.offset[r]), slow.bound.offset[r] + 1e-30, fast.offset[r],
                          slow.value.offset[r], i);
      }
      factors.add_error(std::abs(fast.laplacian_factor - slow.value.laplacian_factor),
                        slow.bound.laplacian_factor + 1e-30, fast.laplacian_factor, slow.value.laplacian_factor, i);
    }
  });
  EXPECT_GT(full, 5000U);
  EXPECT_GT(no_offset, 50U);
  EXPECT_GT(isotropic, 20U);
}

TEST(GfdOperators, StencilsAgreeWithTheSlowTwin) {
  expect_stencils(false);
}

TEST(GfdOperators, StencilsAndSumsOfTheKernelAgreeWithTheSlowTwin) {
  expect_stencils(true);
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils fast(a, true);
    Comparison sums("kernel sum"), gradients("concentration gradient");
    for (std::size_t i = 0; i < a.size(); ++i) {
      sums.add(fast.kernel_sum[i], a.twin.kernel_sum(i), a.twin.tolerance(i), i);
      const auto slow = a.twin.concentration_gradient(i, a.setup.spacing);
      for (int axis = 0; axis < a.dimensions(); ++axis)
        gradients.add(fast.concentration_gradient[axis][i], slow[axis], a.twin.tolerance(i), i);
    }
  });
}

TEST(GfdOperators, StencilsOfASubsetAreThoseOfAll) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils all(a);
    std::vector<std::int32_t> subset;
    for (std::size_t i = 1; i < a.size(); i += 3) subset.push_back(static_cast<std::int32_t>(i));
    std::array<Array<float>, 6> correction;
    GfdMoments out;
    const std::size_t entries = a.dimensions() == 3 ? 6 : 3;
    for (std::size_t k = 0; k < entries; ++k) {
      correction[k].resize(a.size());
      correction[k].fill(-7.0F);
      out.correction[k] = correction[k].data();
    }
    gfd_moment_subset(a.context, a.packed, subset, out);
    for (std::size_t k = 0; k < entries; ++k)
      for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_EQ(correction[k][i], i % 3 == 1 ? all.correction[k][i] : -7.0F) << i;
  });
}

TEST(GfdOperators, GradientsAndLaplacianOfAScalarAgreeWithTheSlowTwin) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils stencils(a);
    const GfdSums& twin = gfd_twin(a);
    const int d = a.dimensions();
    const auto f = a.random(101);
    const auto single = to_float(f);
    const double reference = 0.25;
    const RandomProperty density(a, 102);
    VectorArrays<float> gradient(a.size(), d), beside(a.size(), d), uniform_density(a.size(), d), weighted(a.size(), d),
        listed(a.size(), d);
    Array<float> laplacian(a.size()), alone(a.size());
    const auto b = stencils.read().correction;
    gfd_gradient_sweep(a.context, a.packed, f.data(), reference, b, gradient.write());
    gfd_laplacian_sweep(a.context, a.packed, f.data(), reference, stencils.read(), {laplacian.data(), beside.write()});
    gfd_laplacian_sweep(a.context, a.packed, f.data(), reference, stencils.read(), {alone.data(), {}});
    gfd_gradient_over_density_sweep(a.context, a.packed, f.data(), reference, density.read(), b, weighted.write());
    gfd_gradient_over_density_sweep(a.context, a.packed, f.data(), reference, {density.value.data(), nullptr}, b,
                                    uniform_density.write());
    std::vector<std::int32_t> subset;
    for (std::size_t i = 0; i < a.size(); i += 3) subset.push_back(static_cast<std::int32_t>(i));
    gfd_gradient_over_density_subset(a.context, a.packed, single.data(), density.value.data(), b, subset,
                                     listed.write());
    Comparison gradients("grad f"), sums("lap f"), over_density("grad f / rho"), over_own("grad f / rho_i"),
        of_subset("grad f / rho of a subset");
    const GfdSums::AtPoint value = [&](const SphPoint& p) { return f[p.source] - reference; };
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double rounding = twin.tolerance(i);
      const auto stencil = stencils.of(i);
      const double own = density.value[i];
      const GfdSums::AtPoint mean = [&](const SphPoint& p) { return 2 / (own + double(density.value[p.source])); };
      const GfdSums::AtPoint inverse = [&](const SphPoint&) { return 1 / own; };
      sums.add(laplacian[i], twin.laplacian(i, value, GfdSums::one, stencil), rounding, i);
      ASSERT_EQ(laplacian[i], alone[i]);
      const auto slow = twin.gradient(i, value, GfdSums::one, stencil.correction);
      const auto slow_mean = twin.gradient(i, value, density.varies[i] != 0 ? mean : inverse, stencil.correction);
      const auto slow_own = twin.gradient(i, value, inverse, stencil.correction);
      const auto slow_listed = twin.gradient(
          i, [&](const SphPoint& p) { return double(single[p.source]); }, mean, stencil.correction);
      for (int axis = 0; axis < d; ++axis) {
        gradients.add(gradient[axis][i], slow[axis], rounding, i);
        over_density.add(weighted[axis][i], slow_mean[axis], rounding, i);
        over_own.add(uniform_density[axis][i], slow_own[axis], rounding, i);
        ASSERT_NEAR(beside[axis][i], gradient[axis][i], rounding * slow[axis].magnitude);
        if (i % 3 == 0)
          of_subset.add(listed[axis][i], slow_listed[axis], rounding, i);
        else
          ASSERT_EQ(listed[axis][i], 0) << "not listed";
      }
    }
  });
}

// Of velocities the divergence, and the change over a displacement of up to a tenth of a spacing, or ten times that:
// random velocities are as rough as a field can be, and a particle in three is an extreme on one side or on both.
TEST(GfdOperators, DivergenceAndChangeOverADisplacementAgreeWithTheSlowTwin) {
  std::size_t cut = 0, free = 0;
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils stencils(a);
    const GfdSums& twin = gfd_twin(a);
    const int d = a.dimensions();
    const auto u = random_velocity(a, 111);
    VectorArrays<float> displacement, change(a.size(), d);
    for (int axis = 0; axis < d; ++axis) {
      auto values = a.random(114 + static_cast<std::uint32_t>(axis));
      for (std::size_t i = 0; i < a.size(); ++i) values[i] *= (i % 2 == 0 ? 0.1 : 1) * a.setup.spacing;
      displacement[axis] = to_float(values);
    }
    Array<double> divergence(a.size());
    const auto b = stencils.read().correction;
    gfd_divergence_sweep(a.context, a.packed, u.read(), a.rule, b, divergence.data());
    gfd_change_sweep(a.context, a.packed, u.read(), a.rule, b, displacement.read(), change.write());
    Comparison divergences("div u"), changes("change");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double rounding = twin.tolerance(i);
      reference::Sum sum;
      reference::Vector over{};
      for (int axis = 0; axis < d; ++axis) over[axis] = displacement[axis][i];
      for (int r = 0; r < d; ++r) {
        const auto slow = twin.gradient(
            i, [&](const SphPoint& p) { return a.twin.velocity_at(u, p, r); }, GfdSums::one, stencils.of(i).correction);
        sum.value += slow[r].value;
        sum.magnitude += slow[r].magnitude;
        reference::Sum along;
        for (int c = 0; c < d; ++c) {
          along.value += slow[c].value * displacement[c][i];
          along.magnitude += slow[c].magnitude * std::abs(displacement[c][i]);
        }
        const auto [low, high] = a.twin.change_bounds(i, u, over, r);
        const double bounded = std::clamp(along.value, allowed_change * low, allowed_change * high);
        (bounded == along.value ? free : cut) += 1;
        along.value = bounded;
        along.magnitude += std::abs(low) + std::abs(high);
        changes.add(change[r][i], along, rounding, i);
      }
      divergences.add(divergence[i], sum, rounding, i);
    }
  });
  EXPECT_GT(free, 100U);
  EXPECT_GT(cut, 100U);
}

TEST(GfdOperators, EveryMomentumDiffusionAgreesWithTheSlowTwin) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils stencils(a);
    const GfdSums& twin = gfd_twin(a);
    const int d = a.dimensions();
    const auto u = random_velocity(a, 121);
    const RandomProperty viscosity(a, 124), density(a, 125);
    VectorArrays<float> slope;
    for (int axis = 0; axis < d; ++axis) slope[axis] = to_float(a.random(126 + static_cast<std::uint32_t>(axis)));
    for (const auto form : {MomentumDiffusion::split, MomentumDiffusion::printed, MomentumDiffusion::mu_laplacian,
                            MomentumDiffusion::laplacian, MomentumDiffusion::rotation_free})
      for (const bool somewhere : {true, false})
        for (const bool over_density : {true, false}) {
          DiffusionProperties properties{viscosity.read(), over_density ? density.value.data() : nullptr, slope.read()};
          if (!somewhere) properties.viscosity.varies = nullptr;
          VectorArrays<float> fast(a.size(), d);
          gfd_stress_sweep(a.context, a.packed, u.read(), a.rule, stencils.read(), form, properties, fast.write());
          Comparison comparison("form " + std::to_string(static_cast<int>(form)) + (somewhere ? ", varying" : "") +
                                (over_density ? ", over density" : ""));
          for (std::size_t i = 0; i < a.size(); ++i) {
            reference::Vector gradient{};
            for (int axis = 0; axis < d; ++axis) gradient[axis] = slope[axis][i];
            const auto slow = twin.stress(i, form, u, viscosity.value, over_density ? double(density.value[i]) : 1.0,
                                          somewhere && viscosity.varies[i] != 0, gradient, stencils.of(i));
            for (int axis = 0; axis < d; ++axis) comparison.add(fast[axis][i], slow[axis], twin.tolerance(i), i);
          }
        }
  });
}

TEST(GfdOperators, DiffusionOfHuAndAdamsAgreesWithTheSlowTwin) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const GfdSums& twin = gfd_twin(a);
    const int d = a.dimensions();
    const auto u = random_velocity(a, 131);
    const RandomProperty viscosity(a, 134), density(a, 135);
    Array<float> volume(a.size());
    const auto random = a.random(136);
    for (std::size_t i = 0; i < a.size(); ++i)
      volume[i] = static_cast<float>(a.context.volume * (1 + 0.25 * random[i]));
    VectorArrays<float> fast(a.size(), d);
    hu_adams_sweep(a.context, a.packed, u.read(), a.rule, volume.data(), {viscosity.read(), density.value.data(), {}},
                   fast.write());
    Comparison comparison("Hu and Adams");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto slow = twin.hu_adams(i, u, viscosity.value, volume, density.value[i], viscosity.varies[i] != 0);
      for (int axis = 0; axis < d; ++axis) comparison.add(fast[axis][i], slow[axis], twin.tolerance(i), i);
    }
  });
}

TEST(GfdOperators, RefuseParticlesOfDifferentSizes) {
  for (Arrangement& a : all_arrangements()) {
    if (!a.setup.sizes) continue;
    EXPECT_THROW(Stencils{a}, std::logic_error);
    break;
  }
}

}  // namespace
}  // namespace spume::test
