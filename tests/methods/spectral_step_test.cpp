// SPDX-License-Identifier: MIT
// Steps of the spectral flow: their limit, what is refused, and the memory they take.
#include "methods/spectral_flow.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

using test::beltrami_start;
using test::random_start;
using test::spectral_text;
using test::SpectralRun;

TEST(SpectralStep, StepsBeyondStabilityAreRefusedAndTheStateStays) {
  for (const char* integrator : {"ab2", "rk3", "rk4"}) {
    SpectralRun<> run(
        spectral_text("12", random_start + "[spectral]\nintegrator = \"" + std::string(integrator) + "\"\n"));
    run.start().steps(2, 0.002);
    const auto before = run.saved();
    EXPECT_THROW(run.steps(1, 5 * run.method.step_limit().dt), StepFailure);
    const auto after = run.saved();
    for (const char* axis : {"potential_x", "potential_y", "potential_z"})
      EXPECT_EQ(before.reals.at(axis), after.reals.at(axis)) << integrator;
    EXPECT_EQ(run.method.step_count(), 2);
    run.steps(2, 0.002);  // and goes on
    EXPECT_NEAR(run.series()["mean_energy"], 0.5, 0.05);
  }
}

TEST(SpectralStep, AdamsBashforthIsLimitedByItsOwnInstability) {
  SpectralRun<> run(spectral_text("32", random_start), {"fluid.reynolds=1e7", "time.courant=1"});
  run.start();
  EXPECT_EQ(run.method.step_limit().limited_by, "ab2 stability");
}

// Growth of the energy of waves of many lengths across a stream U, of frequency U k and damped by nu k^2, over 300
// steps of `scale` times the limit.
double growth_in_a_stream(const std::string& reynolds, const std::string& dealiasing, double scale) {
  SpectralRun<> run(
      "method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = [6.283185307179586, 6.283185307179586, "
      "6.283185307179586]\nx = \"periodic\"\ny = \"periodic\"\nz = \"periodic\"\n[resolution]\ngrid = [24, 4, 4]\n"
      "[time]\nend = 100\ncourant = 1\n[fluid]\nreynolds = " +
      reynolds +
      "\n[initial]\nkind = \"expressions\"\nvelocity = [\"1\", "
      "\"1e-6*(sin(3*x)+cos(5*x)+sin(6*x)+sin(7*x)+cos(8*x))\", "
      "\"1e-6*(cos(7*x)+sin(9*x)+cos(10*x)+sin(11*x))\"]\n[spectral]\ndealiasing = \"" +
      dealiasing + "\"\n");
  const StepLimit limit = run.start().method.step_limit();
  EXPECT_EQ(limit.limited_by, "ab2 stability");
  const auto energy = [&] {
    const auto& flow = run.method.flow();
    double sum = 0;
    for (std::size_t ix = 1; ix < 24; ++ix)
      for (const auto& field : flow.potential())
        sum += std::pow(flow.layout().wavenumber[0][ix], 2) * std::norm(field[ix * flow.layout().plane]);
    return sum;
  };
  run.steps(20, scale * limit.dt);  // the first steps excite the second root, which decays
  const double early = energy();
  run.steps(300, scale * limit.dt);
  return energy() / early;
}

// The stream is the worst case of the limit: at the limit its highest wave neither grows nor decays.
TEST(SpectralStep, AdamsBashforthAtItsLimitAmplifiesNoWaveInAStream) {
  for (const std::string reynolds : {"1e6", "1e3", "100", "40"}) {
    EXPECT_LT(growth_in_a_stream(reynolds, "padded", 1), 1) << reynolds;
    EXPECT_LT(growth_in_a_stream(reynolds, "two-thirds", 1), 1) << reynolds;
  }
  EXPECT_GT(growth_in_a_stream("100", "padded", 1.1), 2);
  EXPECT_GT(growth_in_a_stream("100", "two-thirds", 1.1), 2);
}

TEST(SpectralStep, SteadyStepAllocatesNothing) {
  for (const char* integrator : {"ab2", "rk3"}) {
    SpectralRun<> run(
        spectral_text("16", random_start + "[spectral]\nintegrator = \"" + std::string(integrator) + "\"\n"));
    run.start().steps(2, 0.002);
    const auto before = array_statistics().allocations;
    run.steps(3, 0.002);
    EXPECT_EQ(array_statistics().allocations, before) << integrator;
  }
}

TEST(SpectralStep, StaysWithinTheMemoryThatItIsRefusedBy) {
  for (const char* integrator : {"ab2", "rk3"}) {
    const std::string text = spectral_text("48", beltrami_start(integrator));
    const LoadedCase loaded = test::load_text(text);
    const double counted = spectral::flow_bytes(loaded.scene.grid, loaded.options.get<SpectralOptions>());
    const ArrayStatistics before = array_statistics();
    SpectralRun<> run(text);
    run.start();
    const auto allocations = array_statistics().allocations;
    run.steps(1, 0.001);
    EXPECT_THROW(run.steps(1, 5 * run.method.step_limit().dt), StepFailure);
    run.steps(2, 0.001);
    // Factors of viscous decay along z, twice: no field, also after a step that was refused.
    EXPECT_LE(array_statistics().allocations, allocations + 2) << integrator;
    const ArrayStatistics after = array_statistics();
    EXPECT_GT(static_cast<double>(after.bytes - before.bytes), 0.9 * counted) << integrator;
    // Beside the lines of the transforms, less than 40 blocks of 8 numbers per point of an axis and thread.
    const double lines = 40 * 8 * 16.0 * 48 * omp_get_max_threads();
    // A peak below that of an earlier test in this process does not show.
    if (after.peak_bytes > before.peak_bytes) {
      EXPECT_LT(static_cast<double>(after.peak_bytes - before.bytes), counted + lines) << integrator;
    }
  }
}

TEST(SpectralStep, TooLargeGridsAreRefusedBeforeAnythingIsAllocated) {
  EXPECT_THROW(test::load_text(spectral_text("16384", random_start)), InputError);
  // Those whose points alone would fit are the method's to refuse.
  LoadedCase loaded = test::load_text(spectral_text("16", random_start));
  loaded.scene.grid = {16384, 16384, 16384};
  EXPECT_THROW(spectral::Spectral<double> method(loaded), InputError);
}

}  // namespace
}  // namespace spume
