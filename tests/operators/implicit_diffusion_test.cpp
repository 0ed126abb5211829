// SPDX-License-Identifier: MIT
// The implicit diffusion against its equation, written out over all pairs.
#include "spume/solvers/implicit_diffusion.hpp"

#include <gtest/gtest.h>

#include "operators/gfd_arrangement.hpp"

namespace spume::test {
namespace {

using SphPoint = GfdSums::SphPoint;

// Two entries of the diagonal of a hundred times the identity, and less: steps of up to 25 explicit limits.
TEST(ImplicitDiffusion, SolvesTheEquationOfTheSlowTwin) {
  for_every_equal_arrangement([](Arrangement& a) {
    const Stencils stencils(a);
    const GfdSums& twin = gfd_twin(a);
    const int d = a.dimensions();
    const std::size_t n = a.size();
    const RandomProperty viscosity(a, 141), density(a, 142);
    for (const bool varying : {true, false}) {
      DiffusionProperties properties{viscosity.read(), density.value.data(), {}};
      if (!varying) properties.viscosity.varies = nullptr;
      Array<float> diagonal(n);
      gfd_diffusion_diagonal(a.context, a.packed, stencils.read(), properties, diagonal.data());
      const auto row = [&](std::size_t i) { return varying && viscosity.varies[i] != 0; };
      const auto mean = [&](std::size_t i, const SphPoint& p) {
        const double own = viscosity.value[i];
        return (row(i) ? GfdSums::harmonic(own, viscosity.value[p.source]) : own) / density.value[i];
      };
      Comparison diagonals("diagonal");
      for (std::size_t i = 0; i < n; ++i)
        diagonals.add(diagonal[i],
                      twin.laplacian_diagonal(
                          i, [&](const SphPoint& p) { return mean(i, p); }, stencils.of(i)),
                      twin.tolerance(i), i);
      const double dt = 100.0 / *std::max_element(diagonal.begin(), diagonal.end());
      ImplicitDiffusion diffusion;
      Array<float>& change = diffusion.change();
      change.resize(n * static_cast<std::size_t>(d));
      const auto b = random_velocity(a, 143);
      VectorArrays<double> w;
      double norm = 0;
      for (int axis = 0; axis < d; ++axis)
        for (std::size_t i = 0; i < n; ++i) {
          change[static_cast<std::size_t>(axis) * n + i] = static_cast<float>(b[axis][i]);
          norm += b[axis][i] * b[axis][i];
        }
      ScratchPool scratch;
      diffusion.solve({a.context, a.packed, a.rule, stencils.read(), properties, dt}, scratch);
      ASSERT_TRUE(diffusion.report().converged);
      EXPECT_GT(diffusion.report().iterations, 1);
      VectorArrays<double> zero;
      for (int axis = 0; axis < d; ++axis) {
        w[axis].resize(n);
        zero[axis].resize(n);
        zero[axis].fill(0.0);
        for (std::size_t i = 0; i < n; ++i) w[axis][i] = b[axis][i] + change[static_cast<std::size_t>(axis) * n + i];
      }
      // M w, the motion of walls left out: what they bring is the same with w = 0.
      double residual = 0, rounding = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const auto with = twin.stress(i, MomentumDiffusion::mu_laplacian, w, viscosity.value, density.value[i], row(i),
                                      {}, stencils.of(i));
        const auto walls = twin.stress(i, MomentumDiffusion::mu_laplacian, zero, viscosity.value, density.value[i],
                                       row(i), {}, stencils.of(i));
        for (int axis = 0; axis < d; ++axis) {
          residual += std::pow(b[axis][i] - w[axis][i] + dt * (with[axis].value - walls[axis].value), 2);
          rounding += std::pow(dt * twin.tolerance(i) * with[axis].magnitude, 2);
        }
      }
      EXPECT_LE(std::sqrt(residual), 1e-4 * std::sqrt(norm) + std::sqrt(rounding));
    }
  });
}

TEST(ImplicitDiffusion, LeavesAVelocityThatIsNotPredictedToChange) {
  Arrangement& a = all_arrangements().front();
  const Stencils stencils(a);
  const RandomProperty viscosity(a, 141), density(a, 142);
  ImplicitDiffusion diffusion;
  diffusion.change().resize(a.size() * static_cast<std::size_t>(a.dimensions()));
  diffusion.change().fill(0.0F);
  ScratchPool scratch;
  diffusion.solve({a.context, a.packed, a.rule, stencils.read(), {viscosity.read(), density.value.data(), {}}, 1.0},
                  scratch);
  EXPECT_TRUE(diffusion.report().converged);
  for (const float value : diffusion.change()) ASSERT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace spume::test
