// SPDX-License-Identifier: MIT
// Whole steps of wcsph: one phase in a periodic box, bench/cases/weakly_compressible.toml, with and without shifting,
// and two phases in two dimensions, bench/cases/layers.toml. Arguments: particles per axis, threads. 400 x 500 and 46^3
// are the sizes of the targets; les_sph_step of step.cpp is the one to interleave with.
#include "spume/methods/wcsph/wcsph.hpp"

#include <benchmark/benchmark.h>

#include <cstdio>

#include "spume/core/parallel.hpp"
#include "spume/methods/registry.hpp"

namespace spume {
namespace {

void run_wcsph(benchmark::State& state, const char* path, std::vector<std::string> set) {
  omp_set_num_threads(static_cast<int>(state.range(1)));
  char spacing[60];
  std::snprintf(spacing, sizeof spacing, "resolution.spacing=%.17g", 1.0 / static_cast<double>(state.range(0)));
  set.emplace_back(spacing);
  const LoadedCase loaded = load_case(path, set);
  wcsph::Wcsph method(loaded);
  Ledger ledger;
  const double dt = method.step_limit().dt;
  for (int warming = 0; warming < 20; ++warming) method.step(dt, ledger);
  for (auto _ : state) method.step(dt, ledger);
  state.counters["time_per_particle"] =
      benchmark::Counter(static_cast<double>(method.particle_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  double bytes = 0;
  for (const ArrayInfo& array : method.arrays()) bytes += array.bytes;
  state.counters["bytes_per_particle"] = bytes / static_cast<double>(method.particle_count());
}

void wcsph_step(benchmark::State& state) {
  run_wcsph(state, SPUME_BENCH_CASES "/weakly_compressible.toml", {"compressibility.shifting=\"off\""});
}
void wcsph_step_shifted(benchmark::State& state) {
  run_wcsph(state, SPUME_BENCH_CASES "/weakly_compressible.toml", {});
}
void wcsph_step_two_phases(benchmark::State& state) {
  run_wcsph(state, SPUME_BENCH_CASES "/layers.toml", {});
}
// Enough steps for several builds of the lists.
BENCHMARK(wcsph_step)
    ->ArgNames({"per_axis", "threads"})
    ->Args({46, 1})
    ->Args({46, 2})
    ->Iterations(60)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(wcsph_step_shifted)
    ->ArgNames({"per_axis", "threads"})
    ->Args({46, 2})
    ->Iterations(60)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(wcsph_step_two_phases)
    ->ArgNames({"per_axis", "threads"})
    ->Args({400, 1})
    ->Args({400, 2})
    ->Iterations(60)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spume
