// SPDX-License-Identifier: MIT
// A cube of sorted particles with images and lists, about 74 neighbours each, for the benchmarks.
// Benchmark arguments: particles (about), arrangement (0 lattice, 1 jittered, 2 clustered and jittered), threads.
#pragma once

#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>

#include "spume/core/random.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/images.hpp"
#include "spume/neighbours/neighbour_list.hpp"
#include "spume/operators/pair_sweep.hpp"

namespace spume {

struct ParticleCube {
  ImageRules rules;
  CellGrid grid;
  CellOrder table;
  Images images;
  NeighbourList list;
  Array<double> x, y, z;
  std::size_t n;

  explicit ParticleCube(const benchmark::State& state) {
    omp_set_num_threads(static_cast<int>(state.range(2)));
    const auto m = static_cast<std::size_t>(std::lround(std::cbrt(static_cast<double>(state.range(0)))));
    n = m * m * m;
    const double spacing = 1.0 / static_cast<double>(m);
    rules.dimensions = 3;
    rules.upper = {1, 1, 1};
    rules.support_radius = 2.6 * spacing;
    rules.sides = {{{ImageKind::periodic, ImageKind::periodic},
                    {ImageKind::periodic, ImageKind::periodic},
                    {ImageKind::mirror, ImageKind::none}}};
    const double support_radius = rules.support_radius;
    grid = CellGrid(3, {-support_radius, -support_radius, -support_radius},
                    {1 + support_radius, 1 + support_radius, 1 + support_radius}, support_radius, n);
    for (auto* axis : {&x, &y, &z}) axis->resize(n);
    const double jitter = state.range(1) == 0 ? 0 : 0.4;
    const bool clustered = state.range(1) == 2;
    for (std::size_t i = 0; i < n; ++i) {
      const auto r = random_uniform(1, RandomPurpose::test, i, 0, 0);
      const double place[3] = {static_cast<double>(i % m), static_cast<double>(i / m % m),
                               static_cast<double>(i / m / m)};
      double p[3];
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = (place[axis] + 0.5 + jitter * (r[axis] - 0.5)) * spacing;
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

  static void sizes(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"particles", "arrangement", "threads"})
        ->ArgsProduct({{10000, 100000, 1000000}, {0, 1, 2}, thread_counts()})
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);
  }

  double spacing() const { return std::cbrt(1.0 / static_cast<double>(n)); }
  // What sweeps need to know; stays valid as long as the particles.
  SweepContext sweep_context() const {
    SweepContext context;
    context.list = &list;
    context.images = &images;
    context.smoothing_length = 1.3 * spacing();
    context.volume = std::pow(spacing(), 3);
    return context;
  }

  void count(benchmark::State& state, double per_particle) const {
    state.counters["time_per_particle"] = benchmark::Counter(
        static_cast<double>(n), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    if (per_particle > 0)
      state.counters["pairs_per_second"] =
          benchmark::Counter(static_cast<double>(n) * per_particle, benchmark::Counter::kIsIterationInvariantRate);
  }
};

}  // namespace spume
