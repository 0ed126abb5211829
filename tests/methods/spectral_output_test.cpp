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

using std::numbers::pi;

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
  ASSERT_EQ(driven.method.invariants().size(), 1u);
  EXPECT_EQ(driven.method.invariants()[0].column, "balance_residual");
}

// u_x = cos 2 pi y + sin 2 pi (y + z): half of the energy at |k| = 2 pi and half at 2 pi sqrt 2, L = 3 pi / 4 times the
// mean 1/|k|. The box may be longer than the field's period.
TEST(SpectralOutput, TheIntegralScaleIsThatOfTheModesInAnyBox) {
  const double exact = 0.75 * pi * 0.5 * (1 + 1 / std::sqrt(2.0)) / (2 * pi);
  for (const auto& [upper, grid] :
       {std::pair{"[1, 1, 1]", "8"}, {"[2, 1, 1]", "[16, 8, 8]"}, {"[1, 3, 1]", "[8, 24, 8]"}}) {
    SpectralRun<> run(std::string("method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = ") + upper +
                      "\nx = \"periodic\"\ny = \"periodic\"\nz = \"periodic\"\n[resolution]\ngrid = " + grid +
                      "\n[time]\nend = 1\n[fluid]\nreynolds = 100\n[initial]\nkind = \"expressions\"\nvelocity = "
                      "[\"cos(2*pi*y) + sin(2*pi*(y + z))\", 0, 0]\n");
    EXPECT_NEAR(run.start().series().at("integral_scale"), exact, 1e-12) << upper;
  }
}

TEST(SpectralOutput, AFlowAtRestHasNoScales) {
  SpectralRun<> run(
      spectral_text("8", "[fluid]\nreynolds = 20\n[initial]\nkind = \"expressions\"\nvelocity = [0, 0, 0]\n"));
  run.start();
  const auto row = run.series();
  for (const char* scale : {"integral_scale", "taylor_scale", "kolmogorov_scale", "reynolds_lambda", "kmax_eta"})
    EXPECT_TRUE(std::isnan(row.at(scale))) << scale;
  for (const char* sum : {"mean_energy", "mean_dissipation", "mean_enstrophy", "balance_residual", "rms_velocity"})
    EXPECT_EQ(row.at(sum), 0) << sum;
}

// u = exp(-nu pi^2 t) (cos pi z, -sin pi z, 0) has one speed everywhere.
TEST(SpectralOutput, TheLargestSpeedIsThatOfTheRow) {
  SpectralRun<> run(spectral_text("8",
                                  "[fluid]\nreynolds = 20\n[initial]\nkind = \"expressions\"\nvelocity = "
                                  "[\"cos(pi*z)\", \"-sin(pi*z)\", 0]\n"));
  run.start();
  for (int step = 0; step < 3; ++step) {
    EXPECT_NEAR(run.series().at("max_speed"), std::exp(-pi * pi / 20 * 0.01 * step), 1e-9);
    run.steps(1, 0.01);
  }
}

// A constant force on the mean: energy (F t)^2 / 2, exactly, beside a dissipation of rounding.
TEST(SpectralOutput, TheBalanceOfAMeanThatMovesCloses) {
  SpectralRun<> run(spectral_text("8",
                                  "[fluid]\nreynolds = 20\n[initial]\nkind = \"expressions\"\nvelocity = "
                                  "[\"0.3 + 1e-17*cos(pi*z)\", 0.1, \"0.7\"]\n"));
  run.start();
  spectral::Modes<double> force;
  for (auto& component : force) component.resize(run.method.flow().layout().size());
  for (auto& component : force) component.fill(0);
  force[0][0] = 0.2;
  run.steps(1, 0.01).series();
  EXPECT_LT(std::abs(run.steps(1, 0.01).series().at("balance_residual")), 1e-6);
  run.method.flow().set_force(spectral::view<double>(force));
  run.steps(2, 0.01).series();
  EXPECT_LT(std::abs(run.steps(3, 0.01).series().at("balance_residual")), 1e-6);
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
