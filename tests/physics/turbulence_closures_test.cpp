// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "spume/core/kernel.hpp"
#include "spume/core/random.hpp"
#include "spume/physics/turbulence/closures.hpp"

namespace spume::turbulence {
namespace {

double uniform(std::uint64_t index, int component) {
  return 2 * random_uniform(11, RandomPurpose::test, index, static_cast<std::uint32_t>(component / 4),
                            0)[static_cast<std::size_t>(component % 4)] -
         1;
}

// A cloud of particles with random positive filter weights, filtered as Shepard does.
template <int D>
struct Cloud {
  std::vector<std::array<double, D>> velocity;
  std::vector<Symmetric<D>> strain;
  std::vector<double> weight;

  explicit Cloud(std::size_t size) : velocity(size), strain(size), weight(size) {
    for (std::size_t i = 0; i < size; ++i) {
      for (int a = 0; a < D; ++a) velocity[i][static_cast<std::size_t>(a)] = uniform(i, a);
      Gradient<D> gradient;
      for (int n = 0; n < D * D; ++n) gradient[static_cast<std::size_t>(n)] = uniform(i, 4 + n);
      strain[i] = strain_rate<D>(gradient);
      weight[i] = 1.1 + uniform(i, 16);
    }
  }

  TestFiltered<D> filtered() const {
    TestFiltered<D> sum{};
    double total = 0;
    for (const double w : weight) total += w;
    for (std::size_t i = 0; i < weight.size(); ++i) {
      const double w = weight[i] / total;
      const double magnitude = strain_magnitude<D>(strain[i]);
      for (int a = 0; a < D; ++a) {
        sum.velocity[static_cast<std::size_t>(a)] += w * velocity[i][static_cast<std::size_t>(a)];
        for (int b = a; b < D; ++b)
          sum.velocity_product[symmetric_index<D>(a, b)] +=
              w * velocity[i][static_cast<std::size_t>(a)] * velocity[i][static_cast<std::size_t>(b)];
      }
      for (std::size_t n = 0; n < strain[i].size(); ++n) {
        sum.strain[n] += w * strain[i][n];
        sum.strain_times_magnitude[n] += w * magnitude * strain[i][n];
      }
    }
    return sum;
  }
};

TEST(SymmetricTensor, IndexCountsTheUpperTriangleByRows) {
  EXPECT_EQ(symmetric_index<2>(0, 0), 0u);
  EXPECT_EQ(symmetric_index<2>(1, 0), 1u);
  EXPECT_EQ(symmetric_index<2>(1, 1), 2u);
  std::size_t n = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b, ++n) {
      EXPECT_EQ(symmetric_index<3>(a, b), n);
      EXPECT_EQ(symmetric_index<3>(b, a), n);
    }
}

TEST(StrainMagnitude, OfLinearFlows) {
  // Simple shear du/dy = g: |S| = |g|. Plane strain (e, -e): |S| = 2 |e|. Uniaxial strain (2, -1, -1): sqrt(12).
  // Rigid rotation: 0.
  EXPECT_DOUBLE_EQ(strain_magnitude<3>(strain_rate<3>(Gradient<3>{0, 3, 0, 0, 0, 0, 0, 0, 0})), 3);
  EXPECT_DOUBLE_EQ(strain_magnitude<2>(strain_rate<2>(Gradient<2>{0, -3, 0, 0})), 3);
  EXPECT_DOUBLE_EQ(strain_magnitude<2>(strain_rate<2>(Gradient<2>{5, 0, 0, -5})), 10);
  EXPECT_DOUBLE_EQ(strain_magnitude<3>(strain_rate<3>(Gradient<3>{2, 0, 0, 0, -1, 0, 0, 0, -1})), std::sqrt(12.0));
  EXPECT_EQ(strain_magnitude<3>(strain_rate<3>(Gradient<3>{0, -1, 2, 1, 0, -3, -2, 3, 0})), 0);
}

TEST(Smagorinsky, HandComputedValue) {
  EXPECT_DOUBLE_EQ(smagorinsky_viscosity(100.0, 0.01, 0.2), 4e-4);
  EXPECT_DOUBLE_EQ(smagorinsky_viscosity(1.0, 1.0), 0.18 * 0.18);
}

TEST(MixedScale, HandComputedValueAndDimensions) {
  // Delta = 4: Delta^(3/2) = 8; |S| = 9: 3; u - u_hat = (4, 4): q_c^2 = 16, its fourth root 2. 0.06 * 8 * 3 * 2.
  const double energy = test_filter_energy<2>(std::array{5.0, 1.0}, std::array{1.0, -3.0});
  EXPECT_DOUBLE_EQ(energy, 16);
  EXPECT_NEAR(mixed_scale_viscosity(9.0, energy, 4.0), 2.88, 1e-15);
  // Other units of length (factor l) and time (factor t) change a viscosity by l^2 / t.
  const double l = 3.7, t = 0.21;
  EXPECT_NEAR(mixed_scale_viscosity(9.0 / t, energy * l * l / (t * t), 4.0 * l), 2.88 * l * l / t, 1e-12);
  EXPECT_EQ(mixed_scale_viscosity(0.0, 1.0, 1.0), 0);
  EXPECT_EQ(mixed_scale_viscosity(1.0, 0.0, 1.0), 0);
}

TEST(TestFilter, IsAboutTwiceAsWideWithTheWendlandKernel) {
  const double h = 0.3;
  EXPECT_NEAR(test_filter_width_ratio(h, WendlandC2::variance(3) * h * h), std::sqrt(4.2), 1e-14);
}

TEST(Germano, TensorIsTracelessAndContractsAsDefined) {
  const TestFiltered<3> filtered = Cloud<3>(40).filtered();
  const double delta = 0.7, alpha = 2.1;
  const Symmetric<3> m = germano_tensor<3>(filtered, delta, alpha);
  double scale = 0;
  for (const double value : m) scale = std::max(scale, std::abs(value));
  EXPECT_GT(scale, 0.01);
  EXPECT_NEAR(m[0] + m[3] + m[5], 0, 1e-14 * scale);

  // Against full matrices.
  const Symmetric<3> l = leonard_stress<3>(filtered);
  const GermanoContractions<double> both = germano_contractions<3>(filtered, delta, alpha);
  double lm = 0, mm = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      lm += l[symmetric_index<3>(a, b)] * m[symmetric_index<3>(a, b)];
      mm += m[symmetric_index<3>(a, b)] * m[symmetric_index<3>(a, b)];
    }
  EXPECT_NEAR(both.leonard_germano, lm, 1e-13);
  EXPECT_NEAR(both.germano_germano, mm, 1e-13);
}

TEST(Germano, HandComputedTensorInTwoDimensions) {
  // hat S = shear 3 / 2 off the diagonal, so |hat S| = 3; hat(|S| S_xy) = 5; Delta = 1, alpha = 2:
  // M_xy = 2 (5 - 4 * 3 * 1.5) = -26, M : M = 2 * 26^2 = 1352.
  TestFiltered<2> filtered{};
  filtered.strain = {0, 1.5, 0};
  filtered.strain_times_magnitude = {0, 5, 0};
  filtered.velocity = {1, 2};
  filtered.velocity_product = {4, 7, 9};
  const Symmetric<2> m = germano_tensor<2>(filtered, 1.0, 2.0);
  EXPECT_DOUBLE_EQ(m[0], 0);
  EXPECT_DOUBLE_EQ(m[1], -26);
  EXPECT_DOUBLE_EQ(m[2], 0);
  // L = (3, 5, 5): L : M = 2 * 5 * (-26).
  const GermanoContractions<double> both = germano_contractions<2>(filtered, 1.0, 2.0);
  EXPECT_DOUBLE_EQ(both.leonard_germano, -260);
  EXPECT_DOUBLE_EQ(both.germano_germano, 1352);
}

TEST(Germano, AStressThatObeysTheModelReturnsItsCoefficient) {
  // L deviator = C M plus any isotropic part: the least squares give back C.
  const double c = 0.031;
  TestFiltered<3> filtered = Cloud<3>(40).filtered();
  const Symmetric<3> m = germano_tensor<3>(filtered, 0.5, 2.0);
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) {
      const std::size_t n = symmetric_index<3>(a, b);
      filtered.velocity_product[n] =
          filtered.velocity[static_cast<std::size_t>(a)] * filtered.velocity[static_cast<std::size_t>(b)] + c * m[n] +
          (a == b ? 7.0 : 0.0);
    }
  EXPECT_NEAR(dynamic_coefficient(germano_contractions<3>(filtered, 0.5, 2.0)), c, 1e-13);
}

TEST(Germano, IsGalileanInvariant) {
  Cloud<3> cloud(40);
  const GermanoContractions<double> at_rest = germano_contractions<3>(cloud.filtered(), 0.5, 2.0);
  for (auto& u : cloud.velocity) u = {u[0] + 10, u[1] - 20, u[2] + 5};
  const GermanoContractions<double> moving = germano_contractions<3>(cloud.filtered(), 0.5, 2.0);
  // Rounding of products of size 400.
  EXPECT_NEAR(moving.leonard_germano, at_rest.leonard_germano, 1e-11);
  EXPECT_NEAR(moving.germano_germano, at_rest.germano_germano, 1e-14 * at_rest.germano_germano);
}

TEST(Germano, CoefficientDoesNotDependOnUnits) {
  Cloud<2> cloud(30);
  const double length = 2.5, time = 0.3;
  const double c = dynamic_coefficient(germano_contractions<2>(cloud.filtered(), 0.5, 2.0));
  for (auto& u : cloud.velocity)
    for (double& component : u) component *= length / time;
  for (auto& s : cloud.strain)
    for (double& component : s) component /= time;
  EXPECT_NEAR(dynamic_coefficient(germano_contractions<2>(cloud.filtered(), 0.5 * length, 2.0)), c,
              1e-12 * std::abs(c));
}

TEST(DynamicViscosity, IsClippedWhereTheTotalWouldBeNegative) {
  EXPECT_DOUBLE_EQ(dynamic_viscosity({0.02, 1.0}, 10.0, 0.1, 1e-3), 2e-3);
  EXPECT_DOUBLE_EQ(dynamic_viscosity({-0.005, 1.0}, 10.0, 0.1, 1e-3), -5e-4);
  EXPECT_DOUBLE_EQ(dynamic_viscosity({-0.02, 1.0}, 10.0, 0.1, 1e-3), -1e-3);
  EXPECT_EQ(dynamic_viscosity({0.0, 0.0}, 0.0, 0.1, 1e-3), 0);
}

// In nearly uniform flow numerator and denominator are rounding: their ratio must not become a viscosity.
TEST(DynamicViscosity, TheCoefficientIsBounded) {
  EXPECT_EQ(dynamic_coefficient({1e-3, 1e-12}), dynamic_largest);
  EXPECT_EQ(dynamic_coefficient({0.2, 1.0}), 0.2);
  EXPECT_DOUBLE_EQ(dynamic_coefficient({-1e-3, 1e-12}), -1e9);  // backscatter is bounded by the viscosity
}

TEST(LagrangianAverage, StartsFromTheFirstStrainAndOneStepIsAsComputedByHand) {
  const GermanoContractions<double> start = lagrangian_average({0, 0}, {3.0, 4.0}, 0.1, 0.01);
  EXPECT_DOUBLE_EQ(start.germano_germano, 4.0);
  EXPECT_DOUBLE_EQ(start.leonard_germano, 0.1024);
  // I_LM = 16, I_MM = 16: (256)^(1/8) = 2, T = 1.5 * 0.3 / 2 = 0.225; dt = 0.075: e = (1/3) / (4/3) = 1/4.
  const GermanoContractions<double> next = lagrangian_average({16, 16}, {-4, 32}, 0.3, 0.075);
  EXPECT_NEAR(next.leonard_germano, 11, 1e-13);
  EXPECT_NEAR(next.germano_germano, 20, 1e-13);
}

TEST(LagrangianAverage, ConvergesToASteadyValueAndRecoversFromZero) {
  GermanoContractions<double> memory{1.0, 1.0};
  // At the floor T is at most 10 * 1.5 Delta / I_MM^(1/4) = 1.5: 2000 steps of 0.01 are 13 times that, e^-13 = 2e-6.
  for (int step = 0; step < 2000; ++step) memory = lagrangian_average(memory, {-1.0, 2.0}, 0.1, 0.01);
  EXPECT_GT(memory.leonard_germano, 0);
  EXPECT_LT(memory.leonard_germano, 1e-7);
  EXPECT_NEAR(memory.germano_germano, 2.0, 1e-5);
  for (int step = 0; step < 2000; ++step) memory = lagrangian_average(memory, {0.1, 2.0}, 0.1, 0.01);
  EXPECT_NEAR(dynamic_coefficient(memory), 0.05, 1e-6);
}

TEST(LagrangianAverage, TinyContractionsDoNotUnderflowToAStandstill) {
  // The product 1e-400 underflows, the roots do not: the memory still relaxes at a finite rate.
  const GermanoContractions<double> next = lagrangian_average({1e-200, 1e-200}, {2e-200, 2e-200}, 1e-50, 1.0);
  EXPECT_GT(next.germano_germano, 1.1e-200);
}

}  // namespace
}  // namespace spume::turbulence
