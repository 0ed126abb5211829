// SPDX-License-Identifier: MIT
// Forces on the spectral flow: what they inject, and that they feed nothing else.
#include <numbers>

#include "methods/spectral_flow.hpp"
#include "spume/methods/spectral/flow_fields.hpp"

namespace spume {
namespace {

using spectral::Flow;
using spectral::Modes;
using test::random_start;
using test::spectral_text;
using test::SpectralRun;

using std::numbers::pi;

TEST(SpectralForcing, ShellForceInjectsExactlyAndTheBalanceCloses) {
  SpectralRun<> run(spectral_text("16", random_start +
                                            "[forcing]\nkind = \"shell\"\nwavenumber = 1.5\nwidth = 2\ninjection = "
                                            "0.7\n[spectral]\nintegrator = \"rk4\"\n"));
  run.start();
  run.series();
  for (int i = 0; i < 5; ++i) {
    run.steps(4, 0.005);
    const auto row = run.series();
    EXPECT_NEAR(row.at("mean_injection"), 0.7, 1e-14);
    // The sums of the present state, from the modes themselves: both conjugates count.
    EXPECT_NEAR(run.method.flow().measure_budget().injection, 0.7, 1e-13);
    EXPECT_NEAR(run.method.flow().measure_budget().energy, row.at("mean_energy"), 1e-14);
    EXPECT_LT(std::abs(row.at("balance_residual")), 1e-3);  // trapezoidal sums of dissipation: dt^2
  }
}

// Two parts of the potential are in no velocity: along k, and what keeps the stored conjugates of the plane k_z = 0
// apart. A force in proportion to the potential that took them along would feed them from rounding on.
TEST(SpectralForcing, AForceFeedsNothingThatIsInNoVelocity) {
  for (const char* integrator : {"ab2", "rk3", "rk4"})
    for (const char* force : {"\"shell\"\nwidth = 3\ninjection = 5\n", "\"linear\"\nrate = 3\n"}) {
      SpectralRun<> run(spectral_text("[8, 8, 8]", random_start + "[forcing]\nkind = " + force +
                                                       "[spectral]\nintegrator = \"" + integrator + "\"\n"));
      run.start();
      Flow<double>& flow = run.method.flow();
      const ModeLayout& layout = flow.layout();
      const std::size_t one = layout.plane, other = 7 * layout.plane, slanted = layout.row + 1;
      const double k[3] = {0, layout.wavenumber[1][1], layout.wavenumber[2][1]}, k2 = k[1] * k[1] + k[2] * k[2];
      Modes<double> b;
      for (std::size_t c = 0; c < 3; ++c) {
        b[c].resize(layout.size());
        std::copy_n(flow.potential()[c].data(), layout.size(), b[c].data());
      }
      const auto along = [&](const Modes<double>& of) {
        return std::abs(k[1] * of[1][slanted] + k[2] * of[2][slanted]);
      };
      const double scale = std::abs(b[1][one]);
      b[1][one] += std::complex<double>(0.3, 0.2) * scale;
      for (std::size_t c = 1; c < 3; ++c) b[c][slanted] += k[c] * scale;
      const double start = along(b);
      flow.set_potential(std::move(b));
      run.steps(40, 0.002);
      EXPECT_LT(std::abs(flow.potential()[1][one] - std::conj(flow.potential()[1][other])), 1e-14 * scale)
          << integrator;
      EXPECT_NEAR(along(flow.potential()), start * std::exp(-k2 / 60 * 0.08), 1e-10 * start) << integrator;
    }
}

// A wave that is parallel to its vorticity has no other motion: dE/dt = injection - 2 nu k^2 E, exactly. Along z every
// stored mode stands for its conjugate too, along x both are stored: a shell that counted either wrong would feed the
// wave twice or half as much. The tolerance is that of 40 steps of fourth order, (2 nu k^2 dt)^4 / 120 each.
TEST(SpectralForcing, ShellForceFeedsAWaveByItsInjection) {
  for (const bool along_z : {true, false}) {
    const std::string velocity =
        along_z ? "[\"cos(pi*z)\", \"-sin(pi*z)\", 0]" : "[0, \"cos(2*pi*x)\", \"-sin(2*pi*x)\"]";
    SpectralRun<> run(spectral_text(
        "[8, 4, 12]", "[fluid]\nreynolds = 20\n[initial]\nkind = \"expressions\"\nvelocity = " + velocity +
                          "\n[forcing]\nkind = \"shell\"\nwidth = 1\nwavenumber = " + (along_z ? "1" : "2") +
                          "\ninjection = 0.7\n[spectral]\nintegrator = \"rk4\"\n"));
    run.start();
    const double rate = 2 * std::pow(along_z ? pi : 2 * pi, 2) / 20, rest = 0.7 / rate;
    for (int step = 1; step <= 40; ++step) {
      run.steps(1, 0.001);
      EXPECT_NEAR(run.series().at("mean_energy"), rest + (0.5 - rest) * std::exp(-rate * 0.001 * step), 1e-12);
    }
  }
}

// Modes of a wide shell that viscosity damps within a step: energy went without a word, 10 % of what was exchanged at
// nu k^2 dt = 2.4. At nu k^2 dt = 0.1 the sum of the dissipation over steps is (2 * 0.1)^2 / 12 off.
TEST(SpectralForcing, ViscosityOnAForcedShellLimitsTheStep) {
  SpectralRun<> run(spectral_text("16",
                                  "[fluid]\nreynolds = 1\n[initial]\nkind = \"random\"\nspectrum = \"k^2*exp(-(k/12)"
                                  "^2)\"\nenergy = 0.3\n[forcing]\nkind = \"shell\"\nwavenumber = 1\nwidth = "
                                  "6\ninjection = 0.1\n"));
  run.start();
  const StepLimit limit = run.method.step_limit();
  EXPECT_EQ(limit.limited_by, "forcing");
  EXPECT_LT(limit.dt * std::pow(6.5 * pi, 2), 0.1);
  run.series();
  for (int row = 0; row < 5; ++row) {
    run.steps(4, limit.dt);
    EXPECT_LT(std::abs(run.series().at("balance_residual")), 0.005) << row;
  }
}

// The force is injection / (2 E) times the velocity of its shell. A shell of next to no energy is fed in steps that
// raise it by a tenth at a time; one that holds only what transforms round is refused, as one that holds nothing.
TEST(SpectralForcing, AShellOfLittleEnergyIsFedInSmallSteps) {
  const auto flow = [](const std::string& start, const std::string& wavenumber) {
    return spectral_text("[8, 4, 12]",
                         "[fluid]\nreynolds = 20\n[initial]\nkind = \"expressions\"\nvelocity = [\"cos(pi*z)" + start +
                             "\", \"-sin(pi*z)\", 0]\n[forcing]\nkind = \"shell\"\nwavenumber = " + wavenumber +
                             "\ninjection = 0.7\n");
  };
  SpectralRun<> run(flow(" + 1e-5*cos(3*pi*z)", "3"));
  run.start();
  const double forced = 0.5 * 1e-10 / 2;
  EXPECT_EQ(run.method.step_limit().limited_by, "forcing");
  EXPECT_NEAR(run.method.step_limit().dt, 0.1 * 2 * forced / 0.7, 1e-6 * forced);
  for (int step = 0; step < 100; ++step) run.steps(1, run.method.step_limit().dt);
  // What was injected beside the decay of the first wave; viscosity takes 1 % of it by then, the scheme errs by as
  // much.
  const double t = run.method.time(), injected = 0.7 * t;
  EXPECT_NEAR(run.series().at("mean_energy"), 0.5 * std::exp(-2 * pi * pi / 20 * t) + injected, 0.03 * injected);
  for (const char* wavenumber : {"3", "2"}) EXPECT_THROW(SpectralRun<>(flow("", wavenumber)).start(), InputError);
}

TEST(SpectralForcing, LinearForceGrowsAsItsRateSays) {
  SpectralRun<> run(spectral_text("[6, 8, 10]",
                                  "[fluid]\nreynolds = 5\n[initial]\nkind = \"expressions\"\nvelocity = "
                                  "[\"cos(pi*z)\", \"-sin(pi*z)\", 0]\n[forcing]\nkind = \"linear\"\nrate = "
                                  "0.8\n[spectral]\nintegrator = \"rk4\"\n"));
  run.start().steps(20, 0.01);
  EXPECT_NEAR(run.series()["mean_energy"], 0.5 * std::exp(2 * (0.8 - pi * pi / 5) * 0.2), 1e-9);
  EXPECT_NEAR(run.series()["mean_injection"], 2 * 0.8 * run.series()["mean_energy"], 1e-14);
}

TEST(SpectralForcing, ExternalForceIsProjectedAndItsMeanMovesTheFluid) {
  SpectralRun<> run(spectral_text("[8, 12, 16]", "[fluid]\nreynolds = 50\n[initial]\nkind = \"rest\"\n"));
  run.start();
  Flow<double>& flow = run.method.flow();
  const std::size_t nz = 16, stride = 18, size = 8 * 12 * stride;
  Array<double> values(3 * size);
  for (std::size_t ix = 0; ix < 8; ++ix)
    for (std::size_t iy = 0; iy < 12; ++iy)
      for (std::size_t iz = 0; iz < nz; ++iz) {
        const std::size_t at = (ix * 12 + iy) * stride + iz;
        const double x = static_cast<double>(ix) / 8, z = 2 * static_cast<double>(iz) / 16;
        values[at] = 0.5 + std::sin(2 * pi * x);  // the wave along itself is a gradient: no flow
        values[size + at] = std::cos(pi * z);
        values[2 * size + at] = -0.25;
      }
  Modes<double> force;
  spectral::force_modes(flow, {&values[0], &values[size], &values[2 * size]}, stride, force);
  flow.set_force(spectral::view<double>(force));
  const double dt = 0.001;
  run.steps(1, dt);
  const Vec3 u = run.method.sample({0.3, 0.4, 0.5}).velocity;
  EXPECT_NEAR(u[0], 0.5 * dt, 1e-15);
  EXPECT_NEAR(u[1], std::cos(pi * 0.5) * dt, 1e-6 * dt);
  EXPECT_NEAR(u[2], -0.25 * dt, 1e-15);
  EXPECT_NEAR(flow.measure_budget().work, dt * (0.25 + 0.0625 + 0.5), 1e-3 * dt);
}

TEST(SpectralForcing, ForceWithoutEnergyInItsShellIsRefused) {
  SpectralRun<> run(spectral_text(
      "16", "[fluid]\nreynolds = 60\n[initial]\nkind = \"rest\"\n[forcing]\nkind = \"shell\"\ninjection = 1\n"));
  EXPECT_THROW(run.start(), InputError);
}

}  // namespace
}  // namespace spume
