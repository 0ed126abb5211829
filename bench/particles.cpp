// SPDX-License-Identifier: MIT
// Particles in a 128^3 flow: nanoseconds per particle of every routine.
// Arguments: particles, 1 sorted or 0 in random order, threads.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>

#include "machine.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"
#include "spume/operators/linear_deposition.hpp"
#include "spume/physics/point_particles/exclusion.hpp"
#include "spume/physics/point_particles/motion.hpp"
#include "spume/physics/point_particles/overlap.hpp"

namespace spume {
namespace {

constexpr int points = 128;
enum Order { unsorted, sorted, clustered };  // at random places; in the order of the cells; in clouds, in order
constexpr std::size_t clouds = 64;

PeriodicGrid grid() {
  PeriodicGrid grid;
  grid.length = {2 * M_PI, 2 * M_PI, 2 * M_PI};
  grid.points = {points, points, points};
  grid.z_stride = points + 2;
  return grid;
}

struct Flow {
  std::array<Array<double>, 3> component;
  explicit Flow(double phase) {
    const PeriodicGrid g = grid();
    for (int c = 0; c < 3; ++c) {
      component[c].resize(g.storage());
      parallel_for(g.point_count(), [&](std::size_t p) {
        const std::size_t i = p / points / points, j = p / points % points, k = p % points;
        component[c][g.row(static_cast<int>(i), static_cast<int>(j)) + k] =
            std::sin(0.3 * static_cast<double>(i + j) + 0.1 * static_cast<double>(k) + c + phase);
      });
    }
  }
  std::array<const double*, 3> data() const { return {component[0].data(), component[1].data(), component[2].data()}; }
};

struct Swarm {
  PeriodicGrid g = grid();
  Particles particles{ParticleArrays{true, false}};
  CellOrder order;
  PeriodicCells cells{g.lower, g.length, g.points};

  explicit Swarm(const benchmark::State& state) {
    use_threads(state, 2);
    const auto n = static_cast<std::size_t>(state.range(0));
    particles.fields.resize(n);
    particles.common_diameter = 0.65 * 2 * M_PI / points;
    for (std::size_t i = 0; i < n; ++i) {
      const auto r = random_uniform(1, RandomPurpose::test, i, 0, 0);
      for (int c = 0; c < 3; ++c) {
        (*particles.position[c])[i] = g.length[c] * r[c];
        (*particles.velocity[c])[i] = std::sin(7.0 * static_cast<double>(i) + c);
      }
      (*particles.identifier)[i] = static_cast<std::int64_t>(i);
    }
    if (state.range(1) == clustered) gather_in_clouds();
    if (state.range(1) != unsorted) {
      sort();
      particles.fields.permute(order.order());
      // As a few steps later: a tenth of a spacing of drift.
      for (std::size_t i = 0; i < n; ++i)
        for (int c = 0; c < 3; ++c)
          (*particles.position[c])[i] = wrap_periodic(
              (*particles.position[c])[i] + 0.1 * g.spacing(c) * (*particles.velocity[c])[i], 0, g.length[c]);
    }
    sort();
  }
  // Normal clouds of eight spacings: of N^3 particles four lie in a cell of the grid there, as light ones do at St = 1.
  void gather_in_clouds() {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const auto centre = random_uniform(2, RandomPurpose::test, i % clouds, 0, 0);
      const auto offset = random_normal(3, RandomPurpose::test, i, 0, 0);
      for (int c = 0; c < 3; ++c)
        (*particles.position[c])[i] =
            wrap_periodic(g.length[c] * centre[c] + 8 * g.spacing(c) * offset[c], 0, g.length[c]);
    }
  }
  void sort() {
    const auto x = particles.positions();
    order.build(cells, x[0], x[1], x[2], particles.size());
  }
  void order_columns(const PeriodicCells& columns) {
    const auto x = particles.positions();
    order.build(columns, x[0], x[1], x[2], particles.size());
  }
  Spheres spheres() {
    Spheres s;
    for (int c = 0; c < 3; ++c) s.position[c] = particles.position[c]->data();
    s.identifier = particles.identifier->data();
    s.common_diameter = particles.common_diameter;
    s.size = particles.size();
    return s;
  }
  // `work`: per particle, and per point of the grid.
  void count(benchmark::State& state, const Work& per_particle, const Work& per_point = {}) const {
    const auto n = static_cast<double>(particles.size()), cells = std::pow(points, 3);
    const auto all = [&](double Work::*of) { return n * per_particle.*of + cells * per_point.*of; };
    count_against_machine(state, {all(&Work::bytes), all(&Work::flops), all(&Work::gathers), all(&Work::cached)},
                          static_cast<int>(state.range(2)));
    state.counters["time_per_particle"] =
        benchmark::Counter(static_cast<double>(particles.size()),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  }
};

template <class Real>
void particle_gather(benchmark::State& state) {
  Swarm swarm(state);
  SplineField<Real> field(swarm.g, 4);
  field.fill(Flow(0).data());
  std::array<Array<double>, 3> value;
  for (auto& v : value) v.resize(swarm.particles.size());
  for (auto _ : state)
    gather(field, swarm.particles.size(), swarm.particles.positions(),
           {value[0].data(), value[1].data(), value[2].data()}, nullptr);
  // 64 points of two snapshots in four lanes, a product and a sum each. Operations are counted in floats: a double
  // is two.
  constexpr double size = sizeof(Real);
  swarm.count(state, {48, 64 * 16 * size / 4, 0, 64 * 8 * size}, {8 * size, 0, 0, 0});
}

template <class Real>
void particle_motion(benchmark::State& state) {
  Swarm swarm(state);
  SplineField<Real> field(swarm.g, 4);
  field.fill(Flow(0).data());
  field.fill(Flow(0.01).data());
  MotionModel model;
  model.beta = 3;
  for (auto _ : state) move_particles(model, field, 1e-9, swarm.particles);
  // The points of the gather; along z value and slope, along y three of what that gives, along x four. Positions and
  // velocities are read and written.
  constexpr double size = sizeof(Real);
  swarm.count(state, {96, 16 * (64 * 2 + 16 * 3 + 4 * 4) * size / 4, 0, 64 * 8 * size}, {8 * size, 0, 0, 0});
}

void particle_field_records(benchmark::State& state) {
  Swarm swarm(state);
  SplineField<double> field(swarm.g, 4);
  const Flow flow(0);
  for (auto _ : state) field.fill(flow.data());
  swarm.count(state, {}, {24 + 64 + 64, 0, 0, 0});
}

void particle_sort(benchmark::State& state) {
  Swarm swarm(state);
  for (auto _ : state) swarm.sort();
  swarm.count(state, {24 + 3 * 8, 0, 0, 0});
}

void particle_reorder(benchmark::State& state) {
  Swarm swarm(state);
  for (auto _ : state) swarm.particles.fields.permute(swarm.order.order());
  // Three positions and velocities read and written, an identifier twice, and the order for each of the seven.
  swarm.count(state, {6 * 16 + 32 + 8 * 4, 0, 0, 0});
}

// With the order that it needs.
void particle_feedback(benchmark::State& state) {
  Swarm swarm(state);
  LinearDeposition deposition(swarm.g);
  Flow force(0);
  Array<double> amounts(3 * swarm.particles.size() + 1);
  for (std::size_t i = 0; i < amounts.size(); ++i) amounts[i] = std::sin(static_cast<double>(i));
  const DepositedParticles given{swarm.particles.positions(), amounts.data(), nullptr, 1e-3};
  for (auto _ : state) {
    swarm.order_columns(deposition.cells());
    deposition.deposit<double>(swarm.order, given, 0.74,
                               {force.component[0].data(), force.component[1].data(), force.component[2].data()},
                               nullptr);
  }
  // Three numbers at eight points, read and written; the sort, positions and forces once, and the grid written.
  swarm.count(state, {48 + 48, 0, 0, 8 * 3 * 16}, {24, 0, 0, 0});
}

template <MatchingMethod method>
void particle_exclusion(benchmark::State& state) {
  Swarm swarm(state);
  const PeriodicGrid g = grid();
  Exclusion exclusion(g.lower, g.length, swarm.particles.common_diameter);
  // The state of a run: overlaps of earlier steps are solved, and motion makes new ones.
  const auto move = [&](int step) {
    parallel_for(swarm.particles.size(), [&](std::size_t i) {
      for (int c = 0; c < 3; ++c) {
        double& x = (*swarm.particles.position[c])[i];
        x = wrap_periodic(x + (step % 2 == 0 ? 0.05 : -0.05) * g.spacing(c) * (*swarm.particles.velocity[c])[i],
                          g.lower[c], g.length[c]);
      }
    });
  };
  for (int i = 0; i < 20; ++i) {
    move(i);
    exclusion.match(swarm.spheres());
    exclusion.separate(swarm.spheres());
  }
  // From the same places every time: left alone, fewer overlap from step to step.
  std::array<Array<double>, 3> settled;
  for (int c = 0; c < 3; ++c) settled[c] = *swarm.particles.position[c];
  ExclusionReport report;
  for (auto _ : state) {
    state.PauseTiming();
    for (int c = 0; c < 3; ++c) *swarm.particles.position[c] = settled[c];
    move(0);
    state.ResumeTiming();
    report = exclusion.match(swarm.spheres(), method);
    exclusion.separate(swarm.spheres());
  }
  // The sort, places and memory of partners once, and the distances (8 operations) to what lies in 27 cells of the size
  // of a particle; searches of later rounds come on top.
  const double share = std::pow(swarm.particles.common_diameter, 3) / (g.length[0] * g.length[1] * g.length[2]);
  swarm.count(state, {48 + 24 + 48, 8 * 27 * share * static_cast<double>(swarm.particles.size()), 0, 0});
  state.counters["overlapping"] = static_cast<double>(report.overlapping);
  state.counters["pairs"] = static_cast<double>(report.pairs);
  state.counters["rounds"] = report.rounds;
}

// The search alone, with the cells that it needs.
void particle_search(benchmark::State& state) {
  Swarm swarm(state);
  const PeriodicGrid g = grid();
  Exclusion exclusion(g.lower, g.length, swarm.particles.common_diameter);
  for (auto _ : state) benchmark::DoNotOptimize(overlap_histogram(exclusion, swarm.spheres(), 20));
  const double share = std::pow(swarm.particles.common_diameter, 3) / (g.length[0] * g.length[1] * g.length[2]);
  swarm.count(state, {48 + 36, 8 * 27 * share * static_cast<double>(swarm.particles.size()), 0, 0});
}

void particle_sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"particles", "arrangement", "threads"})
      ->ArgsProduct({{10000, 100000, 1000000, 2097152}, {unsorted, sorted, clustered}, thread_counts()})
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK(particle_gather<double>)->Apply(particle_sizes);
BENCHMARK(particle_gather<float>)->Apply(particle_sizes);
BENCHMARK(particle_motion<double>)->Apply(particle_sizes);
BENCHMARK(particle_motion<float>)->Apply(particle_sizes);
BENCHMARK(particle_field_records)->Apply(particle_sizes);
BENCHMARK(particle_sort)->Apply(particle_sizes);
BENCHMARK(particle_reorder)->Apply(particle_sizes);
BENCHMARK(particle_feedback)->Apply(particle_sizes);
// The matching by rounds, and the sort and purge of the paper; the search for overlaps alone, the cells included.
BENCHMARK(particle_exclusion<MatchingMethod::rounds>)->Apply(particle_sizes)->Name("particle_exclusion");
BENCHMARK(particle_exclusion<MatchingMethod::sorting>)->Apply(particle_sizes)->Name("particle_exclusion_by_sorting");
BENCHMARK(particle_search)->Apply(particle_sizes);

}  // namespace
}  // namespace spume
