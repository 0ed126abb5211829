// SPDX-License-Identifier: MIT
#include "methods/spectral_flow.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/io/checkpoint.hpp"
#include "spume/methods/spectral/flow_fields.hpp"
#include "spume/methods/spectral/flow_statistics.hpp"

namespace spume {
namespace {

using spectral::Flow;
using spectral::Modes;
using test::beltrami_start;
using test::random_start;
using test::spectral_text;
using test::SpectralRun;

constexpr double pi = std::numbers::pi;

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

TEST(SpectralFlow, ShellForceInjectsExactlyAndTheBalanceCloses) {
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
TEST(SpectralFlow, AForceFeedsNothingThatIsInNoVelocity) {
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
TEST(SpectralFlow, ShellForceFeedsAWaveByItsInjection) {
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

// The force is injection / (2 E) times the velocity of its shell. A shell of next to no energy is fed in steps that
// raise it by a tenth at a time; one that holds only what transforms round is refused, as one that holds nothing.
TEST(SpectralFlow, AShellOfLittleEnergyIsFedInSmallSteps) {
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

TEST(SpectralFlow, LinearForceGrowsAsItsRateSays) {
  SpectralRun<> run(spectral_text("[6, 8, 10]",
                                  "[fluid]\nreynolds = 5\n[initial]\nkind = \"expressions\"\nvelocity = "
                                  "[\"cos(pi*z)\", \"-sin(pi*z)\", 0]\n[forcing]\nkind = \"linear\"\nrate = "
                                  "0.8\n[spectral]\nintegrator = \"rk4\"\n"));
  run.start().steps(20, 0.01);
  EXPECT_NEAR(run.series()["mean_energy"], 0.5 * std::exp(2 * (0.8 - pi * pi / 5) * 0.2), 1e-9);
  EXPECT_NEAR(run.series()["mean_injection"], 2 * 0.8 * run.series()["mean_energy"], 1e-14);
}

TEST(SpectralFlow, ExternalForceIsProjectedAndItsMeanMovesTheFluid) {
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

TEST(SpectralFlow, ResumesBitForBit) {
  for (const char* integrator : {"ab2", "rk3"}) {
    const std::string text = spectral_text(
        "[12, 16, 10]", random_start +
                            "[forcing]\nkind = \"shell\"\nwidth = 3\ninjection = 1\n[spectral]\nintegrator = \"" +
                            integrator + "\"\n");
    SpectralRun<> whole(text), first(text), second(text);
    whole.start().steps(3, 0.004).steps(1, 0.002).series();
    whole.steps(3, 0.003);
    first.start().steps(3, 0.004).steps(1, 0.002).series();
    test::SavedState state = first.saved();
    second.method.load(state);
    second.steps(3, 0.003);
    EXPECT_EQ(whole.saved().reals, second.saved().reals) << integrator;
    EXPECT_EQ(whole.series(), second.series());
  }
}

TEST(SpectralFlow, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<test::SavedState> states;
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    SpectralRun<> run(spectral_text("[12, 16, 10]", random_start));
    run.start().steps(4, 0.004);
    states.push_back(run.saved());
  }
  omp_set_num_threads(before);
  EXPECT_EQ(states[0].reals, states[1].reals);
}

TEST(SpectralFlow, StepsBeyondStabilityAreRefusedAndTheStateStays) {
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

TEST(SpectralFlow, AdamsBashforthIsLimitedByItsOwnInstability) {
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
TEST(SpectralFlow, AdamsBashforthAtItsLimitAmplifiesNoWaveInAStream) {
  for (const std::string reynolds : {"1e6", "1e3", "100", "40"}) {
    EXPECT_LT(growth_in_a_stream(reynolds, "padded", 1), 1) << reynolds;
    EXPECT_LT(growth_in_a_stream(reynolds, "two-thirds", 1), 1) << reynolds;
  }
  EXPECT_GT(growth_in_a_stream("100", "padded", 1.1), 2);
  EXPECT_GT(growth_in_a_stream("100", "two-thirds", 1.1), 2);
}

TEST(SpectralFlow, RandomFieldHasTheWantedSpectrumOnEveryGrid) {
  SpectralRun<> coarse(spectral_text("[12, 18, 24]", random_start)), fine(spectral_text("[16, 24, 32]", random_start));
  const auto spectrum = spectral::shell_spectrum(coarse.start().method.flow());
  fine.start();
  double energy = 0;
  for (const double e : spectrum.energy) energy += e * spectrum.width;
  EXPECT_NEAR(energy, 0.5, 1e-12);
  const auto wanted = [](double k) { return k * k * std::exp(-k * k / 64); };
  for (std::size_t n = 2; n < 8; ++n)
    EXPECT_NEAR(spectrum.energy[n] / spectrum.energy[1],
                wanted(spectrum.wavenumber[n]) / wanted(spectrum.wavenumber[1]), 1e-9);
  // The same seed gives the same waves.
  const auto phase = [](const SpectralRun<>& run) {
    const auto& flow = const_cast<SpectralRun<>&>(run).method.flow();
    return std::arg(flow.potential()[0][flow.layout().plane + 2 * flow.layout().row + 1]);
  };
  EXPECT_NEAR(phase(coarse), phase(fine), 1e-12);
}

TEST(SpectralFlow, RestartOnAnotherGridKeepsTheCommonModes) {
  const test::CaseFile folder("");
  const std::string file = folder.folder() + "/checkpoint.h5";
  SpectralRun<> run(spectral_text("[12, 18, 24]", random_start));
  run.start().steps(2, 0.002);
  CheckpointWriter writer(file, {"", "", ""});
  test::SavedState state = run.saved();
  for (const auto& [name, values] : state.reals) writer.f64("method/" + name, values);
  for (const auto& [name, values] : state.integers) writer.i64("method/" + name, values);
  writer.commit();
  const std::string rest = "[fluid]\nreynolds = 60\n[initial]\nkind = \"checkpoint\"\nfile = \"" + file + "\"\n";
  SpectralRun<> same(spectral_text("[12, 18, 24]", rest)), fine(spectral_text("[20, 22, 36]", rest));
  SpectralRun<float> coarse(spectral_text("[8, 12, 16]", rest + "[spectral]\nprecision = \"single\"\n"));
  same.start(), fine.start(), coarse.start();
  EXPECT_EQ(same.saved().reals.at("potential_x"), state.reals.at("potential_x"));
  const Vec3 at{0.3, 0.8, 1.7};
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(fine.method.sample(at).velocity[c], run.method.sample(at).velocity[c], 1e-13);
  const auto& small = coarse.method.flow();
  const auto& large = run.method.flow();
  // Wavenumbers (-3, 5, 7) along x, y, z.
  const auto mode = [](const auto& flow, std::size_t c) {
    const ModeLayout& layout = flow.layout();
    return std::complex<double>(flow.potential()[c][(layout.points[0] - 3) * layout.plane + 5 * layout.row + 7]);
  };
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(std::abs(mode(small, c) - mode(large, c)), 0, 1e-9);
  EXPECT_THROW(SpectralRun<>(spectral_text("16", rest), {"domain.upper=[1, 1.5, 2.5]"}).start(), InputError);
  EXPECT_THROW(SpectralRun<>(spectral_text("16", rest), {"initial.file=\"/nowhere.h5\""}).start(), InputError);
}

TEST(SpectralFlow, SampledVelocityAndPressureAreThoseOfTheTaylorGreenVortex) {
  SpectralRun<> run(
      "method = \"spectral\"\n[domain]\nlower = [1, 0, 0]\nupper = [7.283185307179586, 6.283185307179586, "
      "6.283185307179586]\nx = \"periodic\"\ny = \"periodic\"\nz = \"periodic\"\n[resolution]\ngrid = 16\n"
      "[time]\nend = 1\n[fluid]\nreynolds = 100\n[initial]\nkind = \"taylor-green\"\n");
  run.start();
  const double x = 0.4, y = 0.9, z = 1.7;
  const PointSample sample = run.method.sample({1 + x, y, z});
  EXPECT_NEAR(sample.velocity[0], std::sin(x) * std::cos(y) * std::cos(z), 1e-14);
  EXPECT_NEAR(sample.velocity[1], -std::cos(x) * std::sin(y) * std::cos(z), 1e-14);
  EXPECT_NEAR(sample.pressure, (std::cos(2 * x) + std::cos(2 * y)) * (std::cos(2 * z) + 2) / 16, 1e-14);
}

// On 8^3 points fields have three modes along an axis and squares six: the mean over eight samples along each direction
// of the plane is exact.
TEST(SpectralFlow, AveragesOverPlanesAreThoseOfManySamples) {
  SpectralRun<> run(spectral_text("8", random_start));
  run.start();
  const double place[3] = {0.37, 0.51, 1.13};
  const auto& lengths = run.method.flow().layout().lengths;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
    PointSample mean;
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j) {
        Vec3 at{};
        at[axis] = place[axis];
        at[p] = i * lengths[p] / 8;
        at[q] = j * lengths[q] / 8;
        const PointSample one = run.method.sample(at);
        mean.pressure += one.pressure / 64;
        for (std::size_t c = 0; c < 3; ++c) mean.velocity[c] += one.velocity[c] / 64;
      }
    const PlaneSample plane = run.method.plane_average(static_cast<int>(axis), place[axis]);
    EXPECT_EQ(plane.area, lengths[p] * lengths[q]);
    EXPECT_NEAR(plane.pressure, mean.pressure, 1e-13);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(plane.velocity[c], mean.velocity[c], 1e-13) << axis << c;
    EXPECT_NEAR(plane.velocity[axis], 0, 1e-14);  // what flows through a plane flows through all
  }
}

// u = U + (cos pi z, -sin pi z, 0) has no pressure, and depends on z alone.
TEST(SpectralFlow, AveragesOverPlanesAreThoseOfTheBeltramiFlow) {
  SpectralRun<> run(spectral_text("8", beltrami_start("ab2")));
  run.start();
  for (const double z : {0.0, 0.3, 1.9}) {
    const PlaneSample plane = run.method.plane_average(2, z);
    EXPECT_NEAR(plane.velocity[0], 0.3 + std::cos(std::numbers::pi * z), 1e-14);
    EXPECT_NEAR(plane.velocity[1], 0.2 - std::sin(std::numbers::pi * z), 1e-14);
    EXPECT_NEAR(plane.velocity[2], 0.9, 1e-14);
    EXPECT_NEAR(plane.pressure, 0, 1e-14);
  }
  const PlaneSample across = run.method.plane_average(0, 0.4);
  for (const auto& [c, stream] : {std::pair{0, 0.3}, {1, 0.2}, {2, 0.9}})
    EXPECT_NEAR(across.velocity[c], stream, 1e-14);
}

TEST(SpectralFlow, TheEnergyOfAFlowThatNothingDrivesMustNotGrow) {
  SpectralRun<> decaying(spectral_text("8", random_start)),
      driven(spectral_text("8", random_start + "[forcing]\nkind = \"linear\"\nrate = 1\n"));
  ASSERT_EQ(decaying.method.invariants().size(), 1u);
  EXPECT_EQ(decaying.method.invariants()[0].quantity, "energy_growth");
  EXPECT_TRUE(driven.method.invariants().empty());
}

TEST(SpectralFlow, SteadyStepAllocatesNothing) {
  for (const char* integrator : {"ab2", "rk3"}) {
    SpectralRun<> run(
        spectral_text("16", random_start + "[spectral]\nintegrator = \"" + std::string(integrator) + "\"\n"));
    run.start().steps(2, 0.002);
    const auto before = array_statistics().allocations;
    run.steps(3, 0.002);
    EXPECT_EQ(array_statistics().allocations, before) << integrator;
  }
}

TEST(SpectralFlow, StaysWithinTheMemoryThatItIsRefusedBy) {
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

TEST(SpectralFlow, TooLargeGridsAreRefusedBeforeAnythingIsAllocated) {
  EXPECT_THROW(test::load_text(spectral_text("16384", random_start)), InputError);
  // Those whose points alone would fit are the method's to refuse.
  LoadedCase loaded = test::load_text(spectral_text("16", random_start));
  loaded.scene.grid = {16384, 16384, 16384};
  EXPECT_THROW(spectral::Spectral<double> method(loaded), InputError);
}

TEST(SpectralFlow, ForceWithoutEnergyInItsShellIsRefused) {
  SpectralRun<> run(spectral_text(
      "16", "[fluid]\nreynolds = 60\n[initial]\nkind = \"rest\"\n[forcing]\nkind = \"shell\"\ninjection = 1\n"));
  EXPECT_THROW(run.start(), InputError);
}

TEST(SpectralFlow, UnresolvedScalesAreRemarkedOnce) {
  SpectralRun<> run(spectral_text("16", random_start), {"fluid.reynolds=1e5"});
  run.start().series();
  EXPECT_THAT(run.method.take_remarks(), testing::ElementsAre(testing::HasSubstr("k_max eta")));
  run.series();
  EXPECT_TRUE(run.method.take_remarks().empty());
}

}  // namespace
}  // namespace spume
