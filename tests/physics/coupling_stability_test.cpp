// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/coupling_stability.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace spume::test {
namespace {

MotionModel particles_of_ratio(double beta) {
  MotionModel model;
  model.beta = beta;
  return model;
}
const CouplingScheme adams_bashforth{0.5, 0.5}, held{1, 0};

// The increments follow b_n = A (2.25 b_{n-1} - 1.5 b_{n-2} + 0.25 b_{n-3}) and b_n = A (2 b_{n-1} - b_{n-2}), which
// alternate without decay at A = -1/4 and A = -1/3, and grow steadily above A = 1.
TEST(CouplingStability, OfStepsFarAboveTheResponseTimeIsThatOfTheMassLoading) {
  const double ratio = 10, beta = 3 / (1 + 2 * ratio);
  for (const auto& [scheme, bound] : {std::pair{adams_bashforth, 0.25}, std::pair{held, 1.0 / 3}}) {
    const double alpha = bound / (ratio - 1);
    EXPECT_LT(coupling_growth(particles_of_ratio(beta), scheme, 0.99 * alpha, 1e6), 1 + 1e-6);
    EXPECT_GT(coupling_growth(particles_of_ratio(beta), scheme, 1.01 * alpha, 1e6), 1.001);
    EXPECT_TRUE(std::isinf(stable_coupling_step(particles_of_ratio(beta), scheme, 0.99 * alpha)));
    EXPECT_TRUE(std::isfinite(stable_coupling_step(particles_of_ratio(beta), scheme, 1.05 * alpha)));
  }
}

// At A = -1/2 the largest root of x^2 = A (2 x - 1) is -(1 + sqrt 3) / 2. Steps of h response times leave 1 / h of A.
TEST(CouplingStability, GrowthIsTheLargestEigenvalue) {
  const double ratio = 10, beta = 3 / (1 + 2 * ratio);
  const double h = 1e9;
  EXPECT_NEAR(coupling_growth(particles_of_ratio(beta), held, 0.5 / (ratio - 1), h), (1 + std::sqrt(3.0)) / 2, 1e-7);
}

TEST(CouplingStability, OfShortStepsIsThatOfTheAddedMass) {
  const double beta = 0.05;
  EXPECT_NEAR(stable_volume_fraction(particles_of_ratio(beta), adams_bashforth, 0.74), 0.25 / ((1 - beta) / 2), 2e-3);
  EXPECT_NEAR(stable_volume_fraction(particles_of_ratio(beta), held, 0.74), 1 / 3.0 / ((1 - beta) / 2), 2e-3);
  EXPECT_EQ(stable_volume_fraction(particles_of_ratio(0.5), adams_bashforth, 0.74), 0.74);
  EXPECT_EQ(stable_coupling_step(particles_of_ratio(beta), adams_bashforth, 0.6), 0);
}

TEST(CouplingStability, OfBubblesIsThatOfThePaper) {
  for (const auto& scheme : {adams_bashforth, held}) {
    EXPECT_TRUE(std::isinf(stable_coupling_step(particles_of_ratio(3), scheme, 0.74)));
    EXPECT_LT(coupling_growth(particles_of_ratio(3), scheme, 0.99, 10), 1 + 1e-6);
    EXPECT_GT(coupling_growth(particles_of_ratio(3), scheme, 1.01, 1e3), 1.001);
    MotionModel frozen = particles_of_ratio(3);
    frozen.frozen = true;
    EXPECT_GT(coupling_growth(frozen, scheme, 1.01, 1), 1.001);
  }
}

// Fields of volume fraction rely on it.
TEST(CouplingStability, MoreParticlesNeverBearLongerSteps) {
  for (const double beta : {0.01, 0.1, 0.5, 1.0, 2.0, 3.0})
    for (const auto& scheme : {adams_bashforth, held}) {
      double before = std::numeric_limits<double>::infinity();
      for (double alpha = 0.02; alpha < 0.75; alpha += 0.04) {
        const double now = stable_coupling_step(particles_of_ratio(beta), scheme, alpha);
        EXPECT_LE(now, before * 1.002) << beta << " " << alpha;
        before = now;
      }
    }
}

}  // namespace
}  // namespace spume::test
