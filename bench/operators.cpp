// SPDX-License-Identifier: MIT
// Particle sweeps: nanoseconds per pair of the pressure operator, in float and with the residual in double.
// Arguments: particles (about), 0 jittered lattice or 1 clustered, threads.
#include "machine.hpp"
#include "particle_cube.hpp"
#include "spume/operators/pressure_operator.hpp"

namespace spume {
namespace {

struct Pressure {
  Particles particles;
  SweepContext context;
  Records records;
  Array<float> extra, x, y;
  PressureOperator matrix;

  explicit Pressure(const benchmark::State& state) : particles(state) {
    const double spacing = std::cbrt(1.0 / static_cast<double>(particles.n));
    context.list = &particles.list;
    context.images = &particles.images;
    context.smoothing_length = 1.3 * spacing;
    context.volume = spacing * spacing * spacing;
    for (auto* array : {&extra, &x, &y}) array->resize(particles.n);
    for (std::size_t i = 0; i < particles.n; ++i) x[i] = static_cast<float>(std::sin(6.28 * particles.x[i]));
    matrix.bind(context, records, {extra.data(), nullptr});
  }
  // Per pair: an index of 4 bytes, a record, and differences 3, r^2 5, root 1, q 1, kernel slope 6, select 1, sum 3;
  // per particle: 16 bytes of record written and read, 12 of positions, 12 of values in and out. Twice the operations
  // and another record of values for the residual in double.
  void report(benchmark::State& state, double records) const {
    const auto pairs = static_cast<double>(particles.list.pair_count());
    state.counters["time_per_pair"] =
        benchmark::Counter(pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    const auto n = static_cast<double>(particles.n);
    count_against_machine(state, {4 * pairs + 56 * n * records, 20 * pairs * records, pairs * records},
                          static_cast<int>(state.range(2)));
  }
};

void pressure_apply(benchmark::State& state) {
  Pressure pressure(state);
  for (auto _ : state) benchmark::DoNotOptimize(pressure.matrix.apply(pressure.x, pressure.y, pressure.x));
  pressure.report(state, 1);
}

void pressure_residual(benchmark::State& state) {
  Pressure pressure(state);
  Array<double> q(pressure.particles.n), b(pressure.particles.n), r(pressure.particles.n);
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = pressure.x[i];
  for (auto _ : state) pressure.matrix.residual(q, b, r);
  pressure.report(state, 2);
}

void pressure_subtract_product(benchmark::State& state) {
  Pressure pressure(state);
  Array<double> r(pressure.particles.n);
  for (auto _ : state) pressure.matrix.subtract_product(0.5, pressure.x, r);
  pressure.report(state, 1);
}

void sizes(benchmark::internal::Benchmark* bench) {
  for (const int n : {10000, 100000, 1000000})
    for (const int threads : {1, 2}) bench->Args({n, 0, threads});
  bench->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(pressure_apply)->Apply(sizes);
BENCHMARK(pressure_residual)->Apply(sizes);
BENCHMARK(pressure_subtract_product)->Apply(sizes);

}  // namespace
}  // namespace spume
