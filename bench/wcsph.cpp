// SPDX-License-Identifier: MIT
// Whole steps of wcsph: one phase in a periodic box, bench/cases/weakly_compressible.toml, with and without shifting,
// and two phases in two dimensions, bench/cases/layers.toml. Arguments: particles per axis, threads. 400 x 500 and 46^3
// are the sizes of the targets; les_sph_step of step.cpp is the one to interleave with.
#include "spume/methods/wcsph/wcsph.hpp"

#include "whole_step.hpp"

namespace spume {
namespace {

void run_wcsph(benchmark::State& state, const char* path, std::vector<std::string> set = {}) {
  time_steps<wcsph::Wcsph>(state, path, 20, std::move(set));  // the lists have been made anew
}

void wcsph_step(benchmark::State& state) {
  run_wcsph(state, SPUME_BENCH_CASES "/weakly_compressible.toml", {"compressibility.shifting=\"off\""});
}
void wcsph_step_shifted(benchmark::State& state) {
  run_wcsph(state, SPUME_BENCH_CASES "/weakly_compressible.toml");
}
void wcsph_step_two_phases(benchmark::State& state) {
  run_wcsph(state, SPUME_BENCH_CASES "/layers.toml");
}
// Enough steps for several builds of the lists.
void settings(benchmark::internal::Benchmark* routine) {
  routine->ArgNames({"per_axis", "threads"})
      ->Iterations(60)
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK(wcsph_step)->Apply(settings)->Args({46, 1})->Args({46, 2});
BENCHMARK(wcsph_step_shifted)->Apply(settings)->Args({46, 2});
BENCHMARK(wcsph_step_two_phases)->Apply(settings)->Args({400, 1})->Args({400, 2});

}  // namespace
}  // namespace spume
