// SPDX-License-Identifier: MIT
// A whole step of vortices in a periodic box: of les-sph in bench/cases/periodic.toml, without closure, surface, walls,
// forces and bubbles, and of gfd in bench/cases/two_fluids.toml with as many particles. Compiled twice: into
// spume_bench, and into spume_bench_minimal against features of les-sph that are constants (bench/minimal), where the
// code for everything else does not exist. Argument: particles per axis.
#include "spume/methods/gfd/gfd.hpp"
#include "spume/methods/les_sph/les_sph.hpp"
#include "whole_step.hpp"

namespace spume {
namespace {

// Steps before those that are timed.
constexpr int warming = 3;

void les_sph_step(benchmark::State& state) {
  time_steps<les_sph::LesSph>(state, SPUME_BENCH_CASES "/periodic.toml", warming);
}
void gfd_step(benchmark::State& state) {
  time_steps<gfd::Gfd>(state, SPUME_BENCH_CASES "/two_fluids.toml", warming);
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
