// SPDX-License-Identifier: MIT
// States of the spectral flow: initial fields, checkpoints, other grids and numbers of threads.
#include "methods/spectral_flow.hpp"
#include "spume/core/parallel.hpp"
#include "spume/io/checkpoint.hpp"
#include "spume/methods/spectral/flow_statistics.hpp"

namespace spume {
namespace {

using test::random_start;
using test::spectral_text;
using test::SpectralRun;

TEST(SpectralState, ResumesBitForBit) {
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

TEST(SpectralState, SameBitsForAnyNumberOfThreads) {
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

TEST(SpectralState, RandomFieldHasTheWantedSpectrumOnEveryGrid) {
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

TEST(SpectralState, RestartOnAnotherGridKeepsTheCommonModes) {
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

}  // namespace
}  // namespace spume
