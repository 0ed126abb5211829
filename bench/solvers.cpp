// SPDX-License-Identifier: MIT
// Cost of the cell multigrid preconditioner per particle: setup once a step, application once per Krylov half-step.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "machine.hpp"
#include "spume/solvers/cell_multigrid.hpp"

namespace {

// A jittered lattice with a wavy open surface, particles along x-rows of cells of 2.6 spacings as a sort leaves them.
struct Cloud {
  explicit Cloud(double wanted) {
    const int across = static_cast<int>(std::cbrt(wanted / 0.6));
    spacing = 1.0 / across;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> jitter(-0.2 * spacing, 0.2 * spacing);
    const int cell = 3;
    for (int k0 = 0; k0 < across; k0 += cell)
      for (int j0 = 0; j0 < across; j0 += cell)
        for (int i0 = 0; i0 < across; i0 += cell)
          for (int k = k0; k < std::min(across, k0 + cell); ++k)
            for (int j = j0; j < std::min(across, j0 + cell); ++j)
              for (int i = i0; i < std::min(across, i0 + cell); ++i) {
                const double px = (i + 0.5) * spacing, pz = (k + 0.5) * spacing;
                const double depth = 0.6 + 0.1 * std::cos(6.283185307 * px) - pz;
                if (depth < 0) continue;
                x.push_back(px + jitter(random));
                y.push_back((j + 0.5) * spacing + jitter(random));
                z.push_back(pz + jitter(random));
                interior.push_back(depth > spacing ? 1.0F : 0.0F);
              }
    diagonal.assign(x.size(), static_cast<float>(10 * spacing));
    geometry.upper = {1, 1, 1};
    geometry.periodic = {true, true, false};
    geometry.wall[2] = {true, false};
    geometry.cell_size = 1.5 * spacing;
  }
  double spacing = 0;
  std::vector<double> x, y, z;
  std::vector<float> interior, diagonal;
  spume::CellGeometry geometry;
};

void solver_sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"particles", "threads"})
      ->ArgsProduct({{10000, 100000, 1000000}, spume::thread_counts()})
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}

// `numbers`: of four bytes a particle, read or written at least once, those of the cells in their share: 0.34 cells a
// particle on all levels, in cells of 1.5 spacings.
void report(benchmark::State& state, std::size_t particles, double numbers) {
  spume::count_against_machine(state, {4 * numbers * static_cast<double>(particles), 0, 0, 0},
                               static_cast<int>(state.range(1)));
  state.counters["particles"] = static_cast<double>(particles);
  state.counters["per_particle"] = benchmark::Counter(
      static_cast<double>(particles), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void cell_multigrid_setup(benchmark::State& state) {
  spume::use_threads(state, 1);
  const Cloud cloud(static_cast<double>(state.range(0)));
  spume::CellMultigrid multigrid(cloud.geometry);
  for (auto _ : state) multigrid.setup(cloud.x, cloud.y, cloud.z, cloud.interior, 0.0, cloud.diagonal);
  report(state, cloud.x.size(),
         21);  // places 6, stencil 4, order, rank and corner 3; cells: three passes over eight numbers 8
}
BENCHMARK(cell_multigrid_setup)->Apply(solver_sizes);

void cell_multigrid_apply(benchmark::State& state) {
  spume::use_threads(state, 1);
  const Cloud cloud(static_cast<double>(state.range(0)));
  spume::CellMultigrid multigrid(cloud.geometry);
  multigrid.setup(cloud.x, cloud.y, cloud.z, cloud.interior, 0.0, cloud.diagonal);
  std::vector<float> r(cloud.x.size()), z(cloud.x.size());
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = static_cast<float>(std::sin(0.1 * static_cast<double>(i)));
  for (auto _ : state) {
    multigrid.apply(std::span<const float>(r), std::span<float>(z));
    benchmark::DoNotOptimize(z.data());
  }
  report(state, cloud.x.size(),
         28);  // stencils twice 8, order and corner 2, vectors 4; cells: five passes over eight numbers 14
}
BENCHMARK(cell_multigrid_apply)->Apply(solver_sizes);

}  // namespace
