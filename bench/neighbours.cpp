// SPDX-License-Identifier: MIT
// Sort, images and neighbour lists: about 74 neighbours per particle in three dimensions.
// Arguments: particles (about), 0 jittered lattice or 1 clustered, threads.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>

#include "spume/core/random.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/images.hpp"
#include "spume/neighbours/neighbour_list.hpp"

namespace spume {
namespace {

struct Particles {
  ImageRules rules;
  CellGrid grid;
  CellTable table;
  Images images;
  NeighbourList list;
  Array<double> x, y, z;
  std::size_t n;

  explicit Particles(const benchmark::State& state) {
    omp_set_num_threads(static_cast<int>(state.range(2)));
    const auto m = static_cast<std::size_t>(std::lround(std::cbrt(static_cast<double>(state.range(0)))));
    n = m * m * m;
    const double spacing = 1.0 / static_cast<double>(m);
    rules.dimensions = 3;
    rules.upper = {1, 1, 1};
    rules.reach = 2.6 * spacing;
    rules.sides = {{{ImageKind::periodic, ImageKind::periodic},
                    {ImageKind::periodic, ImageKind::periodic},
                    {ImageKind::mirror, ImageKind::none}}};
    const double reach = rules.reach;
    grid = CellGrid(3, {-reach, -reach, -reach}, {1 + reach, 1 + reach, 1 + reach}, reach, n);
    for (auto* axis : {&x, &y, &z}) axis->resize(n);
    const bool clustered = state.range(1) == 1;
    for (std::size_t i = 0; i < n; ++i) {
      const auto r = random_uniform(1, RandomPurpose::test, i, 0, 0);
      const double place[3] = {static_cast<double>(i % m), static_cast<double>(i / m % m),
                               static_cast<double>(i / m / m)};
      double p[3];
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = (place[axis] + 0.5 + 0.4 * (r[axis] - 0.5)) * spacing;
        // A third denser along each axis in the middle of the domain, a fifth thinner near its sides.
        if (clustered) p[axis] -= 0.25 / (2 * M_PI) * std::sin(2 * M_PI * (p[axis] - 0.5));
      }
      x[i] = p[0];
      y[i] = p[1];
      z[i] = p[2];
    }
    table.build(grid, x.data(), y.data(), z.data(), n);
    for (auto* axis : {&x, &y, &z}) {
      Array<double> sorted(n);
      for (std::size_t k = 0; k < n; ++k) sorted[k] = (*axis)[static_cast<std::size_t>(table.order()[k])];
      axis->swap(sorted);
    }
    sort();
    make_images();
    make_list();
  }
  void sort() { table.build(grid, x.data(), y.data(), z.data(), n); }
  void make_images() { images.build(rules, grid, x.data(), y.data(), z.data(), n); }
  void make_list() { list.build(grid, table, x.data(), y.data(), z.data(), n, images, {0.5, 0.5, 0.5}); }

  void count(benchmark::State& state, double per_particle) const {
    state.counters["time_per_particle"] = benchmark::Counter(
        static_cast<double>(n), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    if (per_particle > 0)
      state.counters["pairs_per_second"] =
          benchmark::Counter(static_cast<double>(n) * per_particle, benchmark::Counter::kIsIterationInvariantRate);
  }
};

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
