// SPDX-License-Identifier: MIT
// A whole step of vortices in a periodic box: of les-sph in bench/cases/periodic.toml, without closure, surface, walls,
// forces and bubbles, and of gfd in bench/cases/two_fluids.toml with as many particles. Compiled twice: into
// spume_bench, and into spume_bench_minimal against features of les-sph that are constants (bench/minimal), where the
// code for everything else does not exist. Argument: particles per axis.
#include <benchmark/benchmark.h>

#include <cstdio>

#include "spume/core/parallel.hpp"
#include "spume/methods/gfd/gfd.hpp"
#include "spume/methods/les_sph/les_sph.hpp"
#include "spume/methods/registry.hpp"

namespace spume {
namespace {

template <class Method>
void step(benchmark::State& state, const char* path) {
  omp_set_num_threads(static_cast<int>(state.range(1)));
  char spacing[60];
  std::snprintf(spacing, sizeof spacing, "resolution.spacing=%.17g", 1.0 / static_cast<double>(state.range(0)));
  const LoadedCase loaded = load_case(path, {spacing});
  Method method(loaded);
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
void les_sph_step(benchmark::State& state) {
  step<les_sph::LesSph>(state, SPUME_BENCH_CASES "/periodic.toml");
}
void gfd_step(benchmark::State& state) {
  step<gfd::Gfd>(state, SPUME_BENCH_CASES "/two_fluids.toml");
}
// The number of steps is fixed: a flow that has gone on for longer needs other work.
void sizes(benchmark::internal::Benchmark* routine) {
  routine->ArgNames({"per_axis", "threads"})
      ->Args({15, 1})
      ->Args({30, 1})
      ->Args({30, 2})
      ->Iterations(10)
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK(les_sph_step)->Apply(sizes);
BENCHMARK(gfd_step)->Apply(sizes);

}  // namespace
}  // namespace spume
