// SPDX-License-Identifier: MIT
// What the spectral method reports: probes, averages, remarks.
#include <gmock/gmock.h>

#include <numbers>

#include "methods/spectral_flow.hpp"

namespace spume {
namespace {

using test::beltrami_start;
using test::random_start;
using test::spectral_text;
using test::SpectralRun;

constexpr double pi = std::numbers::pi;

TEST(SpectralOutput, SampledVelocityAndPressureAreThoseOfTheTaylorGreenVortex) {
  SpectralRun<> run(
      "method = \"spectral\"\n[domain]\nlower = [1, 0, 0]\nupper = [7.283185307179586, 6.283185307179586, "
      "6.283185307179586]\nx = \"periodic\"\ny = \"periodic\"\nz = \"periodic\"\n[resolution]\ngrid = 16\n"
      "[time]\nend = 1\n[fluid]\nreynolds = 100\n[initial]\nkind = \"taylor-green\"\n");
  run.start();
  const double x = 0.4, y = 0.9, z = 1.7;
  const PointSample sample = run.method.sample({1 + x, y, z});
  EXPECT_NEAR(sample.velocity[0], std::sin(x) * std::cos(y) * std::cos(z), 1e-14);
  EXPECT_NEAR(sample.velocity[1], -std::cos(x) * std::sin(y) * std::cos(z), 1e-14);
  EXPECT_NEAR(sample.scalars[0], (std::cos(2 * x) + std::cos(2 * y)) * (std::cos(2 * z) + 2) / 16, 1e-14);
}

// On 8^3 points fields have three modes along an axis and squares six: the mean over eight samples along each direction
// of the plane is exact.
TEST(SpectralOutput, AveragesOverPlanesAreThoseOfManySamples) {
  SpectralRun<> run(spectral_text("8", random_start));
  run.start();
  const double place[3] = {0.37, 0.51, 1.13};
  const auto& lengths = run.method.flow().layout().lengths;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
    PointSample mean{.scalars = {0.0}};
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j) {
        Vec3 at{};
        at[axis] = place[axis];
        at[p] = i * lengths[p] / 8;
        at[q] = j * lengths[q] / 8;
        const PointSample one = run.method.sample(at);
        mean.scalars[0] += one.scalars[0] / 64;
        for (std::size_t c = 0; c < 3; ++c) mean.velocity[c] += one.velocity[c] / 64;
      }
    const PlaneSample plane = run.method.plane_average(static_cast<int>(axis), place[axis]);
    EXPECT_EQ(plane.area, lengths[p] * lengths[q]);
    EXPECT_NEAR(plane.scalars[0], mean.scalars[0], 1e-13);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(plane.velocity[c], mean.velocity[c], 1e-13) << axis << c;
    EXPECT_NEAR(plane.velocity[axis], 0, 1e-14);  // what flows through a plane flows through all
  }
}

// u = U + (cos pi z, -sin pi z, 0) has no pressure, and depends on z alone.
TEST(SpectralOutput, AveragesOverPlanesAreThoseOfTheBeltramiFlow) {
  SpectralRun<> run(spectral_text("8", beltrami_start("ab2")));
  run.start();
  for (const double z : {0.0, 0.3, 1.9}) {
    const PlaneSample plane = run.method.plane_average(2, z);
    EXPECT_NEAR(plane.velocity[0], 0.3 + std::cos(std::numbers::pi * z), 1e-14);
    EXPECT_NEAR(plane.velocity[1], 0.2 - std::sin(std::numbers::pi * z), 1e-14);
    EXPECT_NEAR(plane.velocity[2], 0.9, 1e-14);
    EXPECT_NEAR(plane.scalars[0], 0, 1e-14);
  }
  const PlaneSample across = run.method.plane_average(0, 0.4);
  for (const auto& [c, stream] : {std::pair{0, 0.3}, {1, 0.2}, {2, 0.9}})
    EXPECT_NEAR(across.velocity[c], stream, 1e-14);
}

TEST(SpectralOutput, TheEnergyOfAFlowThatNothingDrivesMustNotGrow) {
  SpectralRun<> decaying(spectral_text("8", random_start)),
      driven(spectral_text("8", random_start + "[forcing]\nkind = \"linear\"\nrate = 1\n"));
  ASSERT_EQ(decaying.method.invariants().size(), 1u);
  EXPECT_EQ(decaying.method.invariants()[0].quantity, "energy_growth");
  EXPECT_TRUE(driven.method.invariants().empty());
}

TEST(SpectralOutput, UnresolvedScalesAreRemarkedOnce) {
  SpectralRun<> run(spectral_text("16", random_start), {"fluid.reynolds=1e5"});
  run.start().series();
  const auto remarks = run.method.take_remarks();
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_THAT(remarks[0].text, testing::HasSubstr("k_max eta"));
  EXPECT_FALSE(remarks[0].log_only);
  run.series();
  EXPECT_TRUE(run.method.take_remarks().empty());
}

}  // namespace
}  // namespace spume
