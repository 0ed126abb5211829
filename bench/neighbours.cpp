// SPDX-License-Identifier: MIT
// Sort, images and neighbour lists: about 74 neighbours per particle in three dimensions.
// Arguments: particles (about), 0 jittered lattice or 1 clustered, threads.
#include "particle_cube.hpp"

namespace spume {
namespace {

void sort(benchmark::State& state) {
  Particles particles(state);
  for (auto _ : state) particles.sort();
  particles.count(state, 0);
}

void images(benchmark::State& state) {
  Particles particles(state);
  for (auto _ : state) particles.make_images();
  particles.count(state, 0);
  state.counters["images"] = static_cast<double>(particles.images.size());
}

void neighbour_list(benchmark::State& state) {
  Particles particles(state);
  for (auto _ : state) particles.make_list();
  const double per_particle = static_cast<double>(particles.list.pair_count()) / static_cast<double>(particles.n);
  particles.count(state, per_particle);
  state.counters["neighbours"] = per_particle;
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"particles", "clustered", "threads"})
      ->ArgsProduct({{10000, 100000, 1000000}, {0, 1}, {1, 2}})
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK(sort)->Apply(sizes);
BENCHMARK(images)->Apply(sizes);
BENCHMARK(neighbour_list)->Apply(sizes);

}  // namespace
}  // namespace spume
