// SPDX-License-Identifier: MIT
// A whole step of bench/cases/periodic.toml, 27,000 particles and 3,375: vortices in a periodic box without closure,
// surface, walls, forces and bubbles. Compiled twice: into spume_bench, and into spume_bench_minimal against features
// that are constants (bench/minimal), where the code for everything else does not exist. Argument: particles per axis.
#include <benchmark/benchmark.h>

#include <cstdio>

#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/les_sph.hpp"
#include "spume/methods/registry.hpp"

namespace spume {
namespace {

void les_sph_step(benchmark::State& state) {
  omp_set_num_threads(static_cast<int>(state.range(1)));
  char spacing[60];
  std::snprintf(spacing, sizeof spacing, "resolution.spacing=%.17g", 1.0 / static_cast<double>(state.range(0)));
  const LoadedCase loaded = load_case(SPUME_BENCH_CASES "/periodic.toml", {spacing});
  les_sph::LesSph method(loaded);
  Ledger ledger;
  const double dt = method.step_limit().dt;
  for (int warming = 0; warming < 3; ++warming) method.step(dt, ledger);
  for (auto _ : state) method.step(dt, ledger);
  state.counters["time_per_particle"] =
      benchmark::Counter(static_cast<double>(method.particle_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  double bytes = 0;
  for (const ArrayInfo& array : method.arrays()) bytes += array.bytes;
  state.counters["bytes_per_particle"] = bytes / static_cast<double>(method.particle_count());
}
// The number of steps is fixed: a flow that has gone on for longer needs other work.
BENCHMARK(les_sph_step)
    ->ArgNames({"per_axis", "threads"})
    ->Args({15, 1})
    ->Args({30, 1})
    ->Args({30, 2})
    ->Iterations(10)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spume
