// SPDX-License-Identifier: MIT
// The scheme of the spectral flow: order in time, viscosity, products without aliasing.
#include "methods/spectral_flow.hpp"

#include <limits>
#include <numbers>

#include "spume/methods/spectral/flow_fields.hpp"

namespace spume {
namespace {

using spectral::Modes;
using test::beltrami_start;
using test::random_start;
using test::spectral_text;
using test::SpectralRun;

using std::numbers::pi;

// Largest difference of the velocity at a few points from that of beltrami_start.
template <class T>
double beltrami_error(SpectralRun<T>& run) {
  const double t = run.method.time(), decay = std::exp(-pi * pi / 20 * t);
  double worst = 0;
  for (const Vec3& at : {Vec3{0.1, 0.2, 0.3}, Vec3{0.7, 1.1, 1.9}}) {
    const Vec3 u = run.method.sample(at).velocity;
    const double phase = pi * (at[2] - 0.9 * t);
    worst = std::max({worst, std::abs(u[0] - 0.3 - decay * std::cos(phase)),
                      std::abs(u[1] - 0.2 + decay * std::sin(phase)), std::abs(u[2] - 0.9)});
  }
  return worst;
}

double order_of(const std::string& integrator, double dt) {
  double errors[2];
  for (int i = 0; i < 2; ++i) {
    SpectralRun<> run(spectral_text("[8, 4, 12]", beltrami_start(integrator)));
    const double step = dt / (i + 1);
    run.start().steps(static_cast<int>(std::lround(0.4 / step)), step);
    errors[i] = beltrami_error(run);
  }
  EXPECT_GT(errors[1], 1e-13) << "rounding hides the order";
  return std::log2(errors[0] / errors[1]);
}

TEST(SpectralFlow, IntegratorsHaveTheirOrderInBoxesOfAnyLengths) {
  EXPECT_NEAR(order_of("ab2", 0.01), 2, 0.1);
  EXPECT_NEAR(order_of("rk3", 0.02), 3, 0.1);
  EXPECT_NEAR(order_of("rk4", 0.02), 4, 0.15);
}

TEST(SpectralFlow, ViscousDecayIsExactAtAnyStep) {
  for (const char* integrator : {"ab2", "rk3", "rk4"}) {
    SpectralRun<> run(spectral_text("[6, 8, 10]",
                                    "[fluid]\nreynolds = 5\n[initial]\nkind = \"expressions\"\nvelocity = "
                                    "[\"cos(pi*z)\", \"-sin(pi*z)\", 0]\n[spectral]\nintegrator = \"" +
                                        std::string(integrator) + "\"\n"));
    run.start().steps(10, 0.03);
    // u is a Beltrami flow: K vanishes. A few roundings a step.
    EXPECT_NEAR(run.series()["mean_energy"], 0.5 * std::exp(-2 * pi * pi / 5 * 0.3), 1e-14) << integrator;
  }
}

TEST(SpectralFlow, SinglePrecisionFollowsDoubleToItsRounding) {
  SpectralRun<float> run(spectral_text("[8, 4, 12]", beltrami_start("rk4", "precision = \"single\"\n")));
  run.start().steps(20, 0.02);
  EXPECT_LT(beltrami_error(run), 20 * 5 * std::numeric_limits<float>::epsilon());
}

// Steps of nu k^2 dt = 5e-4 in the mean, whose factors differ from 1 by a few thousand roundings of single precision:
// rounded themselves they took 3e-5 of the energy in 400 steps, each the same. Rounded states scatter by the root of
// the number.
TEST(SpectralFlow, SinglePrecisionLosesNoEnergyWithTheNumberOfSteps) {
  for (const char* integrator : {"ab2", "rk3"}) {
    const std::string text =
        spectral_text("8", random_start + "[spectral]\nintegrator = \"" + std::string(integrator) + "\"\n");
    SpectralRun<float> single(text, {"spectral.precision=\"single\"", "fluid.reynolds=120"});
    SpectralRun<double> exact(text, {"fluid.reynolds=120"});
    single.start().steps(400, 0.001);
    exact.start().steps(400, 0.001);
    EXPECT_NEAR(single.method.flow().measure_budget().energy / exact.method.flow().measure_budget().energy, 1, 4e-6)
        << integrator;
  }
}

// A steady vortex that viscosity alone changes, in a step by a sixth of a last place: rounded to the nearest it would
// not decay at all. 800 sums of half a last place scatter by 800^(1/2) 2^-24 / 3^(1/2) = 1e-6 of each of its modes.
TEST(SpectralFlow, SinglePrecisionDecaysWhereAStepChangesLessThanALastPlace) {
  const double dt = 0.001, decay = 1e-8;  // nu k^2 dt
  const int steps = 800;
  for (const char* integrator : {"ab2", "rk3"}) {
    const std::string vortex = "[fluid]\nreynolds = " + std::to_string(dt * pi * pi / decay) +
                               "\n[initial]\nkind = \"expressions\"\nvelocity = [\"cos(pi*z)\", \"-sin(pi*z)\", "
                               "\"0\"]\n[spectral]\nintegrator = \"" +
                               integrator + "\"\nprecision = \"single\"\n";
    SpectralRun<float> run(spectral_text("[8, 4, 12]", vortex));
    run.start();
    const double before = run.method.flow().measure_budget().energy;
    run.steps(steps, dt);
    EXPECT_NEAR(1 - run.method.flow().measure_budget().energy / before, 2 * steps * decay, 4e-6) << integrator;
  }
}

TEST(SpectralFlow, VelocityIsSolenoidalAndRealToRounding) {
  SpectralRun<> run(spectral_text("[12, 18, 20]", random_start));
  run.start().steps(5, 0.01);
  const ModeLayout& layout = run.method.flow().layout();
  const Modes<double>& b = run.method.flow().potential();
  double along = 0, scale = 0, asymmetry = 0;
  for (std::size_t ix = 0; ix < 12; ++ix)
    for (std::size_t iy = 0; iy < 18; ++iy)
      for (std::size_t iz = 0; iz < 10; ++iz) {
        const std::size_t at = ix * layout.plane + iy * layout.row + iz;
        const double k[3] = {layout.wavenumber[0][ix], layout.wavenumber[1][iy], layout.wavenumber[2][iz]};
        std::complex<double> sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          sum += k[c] * b[c][at];
          scale = std::max(scale, std::abs(k[c] * b[c][at]));
        }
        along = std::max(along, std::abs(sum));  // u = curl b is solenoidal anyway; b stays in its gauge
        if (iz == 0) {
          const std::size_t other = (ix == 0 ? 0 : 12 - ix) * layout.plane + (iy == 0 ? 0 : 18 - iy) * layout.row;
          for (std::size_t c = 0; c < 3; ++c)
            asymmetry = std::max(asymmetry, std::abs(b[c][at] - std::conj(b[c][other])));
        }
      }
  EXPECT_LT(along, 1e-14 * scale);
  EXPECT_LT(asymmetry, 1e-14 * scale);
}

TEST(SpectralFlow, InviscidFlowKeepsItsEnergy) {
  for (const char* dealiasing : {"padded", "two-thirds"}) {
    std::string text =
        spectral_text("16", random_start + "[spectral]\nintegrator = \"rk4\"\ndealiasing = \"" + dealiasing + "\"\n");
    text.replace(text.find("reynolds = 60\n"), 14, "");
    SpectralRun<> run(text);
    run.start();
    const double before = run.series()["mean_energy"];
    run.steps(10, 0.004);
    // What is left is the error of the integrator.
    EXPECT_NEAR(run.series()["mean_energy"] / before, 1, 1e-8) << dealiasing;
  }
}

// Rates of change of the modes below 8 of 16 along each axis.
std::vector<std::complex<double>> rates(const std::string& grid, const std::string& dealiasing) {
  const std::string start =
      "[fluid]\nreynolds = 60\n[initial]\nkind = \"random\"\nspectrum = \"k < 21 ? k : 0\"\nenergy = 0.5\n"
      "[spectral]\ndealiasing = \"" +
      dealiasing + "\"\n";
  SpectralRun<> run(spectral_text(grid, start));
  run.start();
  const Modes<double> before = run.method.flow().potential();
  const double dt = 1e-6;
  run.steps(1, dt);
  const ModeLayout& layout = run.method.flow().layout();
  std::vector<std::complex<double>> result;
  for (int sx = -7; sx < 8; ++sx)
    for (int sy = -7; sy < 8; ++sy)
      for (std::size_t iz = 0; iz < 8; ++iz)
        for (std::size_t c = 0; c < 3; ++c) {
          const auto index = [](int s, std::size_t n) {
            return s < 0 ? n - static_cast<std::size_t>(-s) : static_cast<std::size_t>(s);
          };
          const std::size_t at =
              index(sx, layout.points[0]) * layout.plane + index(sy, layout.points[1]) * layout.row + iz;
          result.push_back((run.method.flow().potential()[c][at] - before[c][at]) / dt);
        }
  return result;
}

TEST(SpectralFlow, PaddedProductsAreFreeOfAliasingAndUnpaddedOnesAreNot) {
  // On 24 points the products of modes below 8 need no padding.
  const auto exact = rates("24", "none"), padded = rates("16", "padded"), aliased = rates("16", "none");
  double scale = 0, error = 0, aliasing = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    scale = std::max(scale, std::abs(exact[i]));
    error = std::max(error, std::abs(padded[i] - exact[i]));
    aliasing = std::max(aliasing, std::abs(aliased[i] - exact[i]));
  }
  EXPECT_LT(error, 1e-4 * scale);  // dt times the rate of the fastest mode
  EXPECT_GT(aliasing, 1e-2 * scale);
}

TEST(SpectralFlow, TwoThirdsRuleCutsModesThatPaddingKeeps) {
  const std::string start =
      "[fluid]\nreynolds = 60\n[initial]\nkind = \"expressions\"\nvelocity = "
      "[\"exp(-((y-0.75)^2 + (z-1)^2)*400)\", 0, 0]\n[spectral]\ndealiasing = \"";
  std::map<std::string, double> peak, lowest;
  for (const std::string dealiasing : {"padded", "two-thirds"}) {
    SpectralRun<> run(spectral_text("24", start + dealiasing + "\"\n"));
    run.start();
    const std::size_t size = 24 * 24 * 24;
    Array<double> values(3 * size);
    spectral::real_velocity(run.method.flow(), run.method.flow().potential(), {},
                            {&values[0], &values[size], &values[2 * size]}, 24);
    peak[dealiasing] = *std::max_element(values.begin(), values.begin() + size);
    lowest[dealiasing] = *std::min_element(values.begin(), values.begin() + size);
  }
  // The narrow peak (figure 2 of the paper) loses height and gains oscillations around it.
  EXPECT_LT(peak["two-thirds"], 0.8 * peak["padded"]);
  EXPECT_LT(lowest["two-thirds"], 2 * lowest["padded"]);
}

}  // namespace
}  // namespace spume
