// SPDX-License-Identifier: MIT
// Bubbles among particles: sums over bubbles at particles, particles found around bubbles, entrainment, births and
// deaths. One bubble per ten particles. Arguments: those of particle_cube.hpp.
#include "machine.hpp"
#include "particle_cube.hpp"
#include "spume/operators/cross_sums.hpp"
#include "spume/physics/bubbles/entrainment.hpp"
#include "spume/physics/bubbles/population.hpp"
#include "spume/physics/oxygen/transfer.hpp"

namespace spume {
namespace {

constexpr double pairs_per_bubble = 4.18879 * 2.6 * 2.6 * 2.6;  // particles in its support
constexpr double candidates_per_bubble = 27 * 2.6 * 2.6 * 2.6;  // in the cells around it

struct BubbleSwarm {
  ParticleCube particles;
  std::size_t size;
  CellOrder table;
  std::array<Array<float>, 3> place, liquid_place;
  Array<float> records, length_ratio, support_radius, inverse_support_radius;

  explicit BubbleSwarm(const benchmark::State& state) : particles(state), size(particles.n / 10) {
    const std::size_t n = particles.n;
    std::array<Array<double>, 3> at, sorted;
    for (int a = 0; a < 3; ++a) {
      at[a].resize(size);
      sorted[a].resize(size);
      place[a].resize(size + simd::pair_lanes);
      liquid_place[a].resize(n + simd::pair_lanes);
    }
    for (std::size_t b = 0; b < size; ++b) {
      const auto r = random_uniform(2, RandomPurpose::test, b, 0, 0);
      for (int a = 0; a < 3; ++a) at[a][b] = r[a];
    }
    table.build(particles.grid, at[0].data(), at[1].data(), at[2].data(), size);
    for (std::size_t b = 0; b < size; ++b)
      for (int a = 0; a < 3; ++a) sorted[a][b] = at[a][static_cast<std::size_t>(table.order()[b])];
    table.build(particles.grid, sorted[0].data(), sorted[1].data(), sorted[2].data(), size);
    records.resize(8 * size);
    for (std::size_t b = 0; b < size; ++b)
      for (int a = 0; a < 3; ++a) {
        place[a][b] = records[8 * b + a] = static_cast<float>(sorted[a][b]);
        records[8 * b + 3 + a] = static_cast<float>(a + 1);
      }
    length_ratio.resize(n);
    support_radius.resize(n);
    inverse_support_radius.resize(n + simd::pair_lanes);
    const std::array<const double*, 3> x = positions();
    for (std::size_t i = 0; i < n; ++i) {
      length_ratio[i] = 1;
      support_radius[i] = static_cast<float>(particles.rules.support_radius);
      inverse_support_radius[i] = 1 / support_radius[i];
      for (int a = 0; a < 3; ++a) liquid_place[a][i] = static_cast<float>(x[a][i]);
    }
  }
  std::array<const double*, 3> positions() const {
    return {particles.x.data(), particles.y.data(), particles.z.data()};
  }
  CrossSearch search(const CellOrder& points, std::size_t count, const std::array<Array<float>, 3>& at) const {
    const CrossSearch::Points set[] = {{&points, count}};
    return {particles.grid, {0, 0, 0}, {at[0].data(), at[1].data(), at[2].data()}, set};
  }
  void count(benchmark::State& state) const {
    state.counters["time_per_bubble"] = benchmark::Counter(
        static_cast<double>(size), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  }
};

// Force and viscosity of bubbles at particles: distance 10, kernel 7, four sums 8.
void bubble_sums(benchmark::State& state) {
  BubbleSwarm swarm(state);
  const std::size_t n = swarm.particles.n;
  Array<float> result(4 * n);
  const CrossSearch search = swarm.search(swarm.table, swarm.size, swarm.place);
  const CrossTargets targets{n,
                             swarm.positions(),
                             {0, 0, 0},
                             1.3 * swarm.particles.spacing(),
                             swarm.length_ratio.data(),
                             swarm.support_radius.data()};
  for (auto _ : state)
    sum_over_points<4, WendlandC2>(targets, search, swarm.particles.grid.support_radius(), swarm.records.data(),
                                   [&](std::size_t i, const float* sums) {
                                     for (std::size_t c = 0; c < 4; ++c)
                                       result[4 * i + c] = sums == nullptr ? 0.0F : sums[c];
                                   });
  swarm.count(state);
  const double pairs = pairs_per_bubble * static_cast<double>(swarm.size);
  count_against_machine(state, {static_cast<double>(n) * (24 + 8 + 16), 25 * pairs, 0, 0},
                        static_cast<int>(state.range(2)));
}

// Candidates are the particles of the cells that come near: distance 8 and the comparison with the reach. With lines
// also what is found: kernel 7, products and sums 32.
void around_bubbles(benchmark::State& state, bool with_lines) {
  BubbleSwarm swarm(state);
  const CrossSearch search = swarm.search(swarm.particles.table, swarm.particles.n, swarm.liquid_place);
  Array<float> lines(with_lines ? line_floats * swarm.particles.n : 0), sums(line_floats * swarm.size);
  for (std::size_t k = 0; k < lines.size(); ++k) lines[k] = static_cast<float>(k % 7);
  for (auto _ : state)
    parallel_blocks(swarm.size, 64, [&](std::size_t, std::size_t first, std::size_t last) {
      thread_local CrossSearch::Found thread_found;
      CrossSearch::Found& found = thread_found;
      for (std::size_t b = first; b < last; ++b) {
        search.near_place({swarm.place[0][b], swarm.place[1][b], swarm.place[2][b]},
                          static_cast<float>(swarm.particles.grid.support_radius()),
                          swarm.inverse_support_radius.data(), found);
        sums[line_floats * b] = static_cast<float>(found.size);
        if (!with_lines) continue;
        const auto halves = sum_of_lines<WendlandC2>(found, lines.data());
        simd::store(sums.data() + line_floats * b, halves[0]);
        simd::store(sums.data() + line_floats * b + simd::lanes, halves[1]);
      }
    });
  swarm.count(state);
  const auto bubbles = static_cast<double>(swarm.size);
  const double candidates = candidates_per_bubble * bubbles, pairs = with_lines ? pairs_per_bubble * bubbles : 0;
  count_against_machine(state, {0, 9 * candidates + 39 * pairs, 0, 16 * candidates + 64 * pairs},
                        static_cast<int>(state.range(2)));
}
void particles_around_bubbles(benchmark::State& state) {
  around_bubbles(state, false);
}
void interpolation_to_bubbles(benchmark::State& state) {
  around_bubbles(state, true);
}

// At a particle that may entrain; argument: purchases per step in tenths.
void entrainment(benchmark::State& state) {
  bubbles::EntrainmentModel model;
  model.density_ratio = 1000 / 1.2;
  model.tension = 1 / 1.98e4;
  model.smallest_radius = 6.6e-5;
  model.largest_radius = model.spacing = 0.01;
  bubbles::EntrainingParticle particle;
  particle.dissipation = 0.4;
  particle.volume = 1e-6;
  particle.kernel_peak = 21 / (16 * M_PI * std::pow(0.013, 3));
  std::vector<bubbles::NewBubble> made;
  std::uint32_t step = 0;
  std::size_t bubbles = 0;
  for (auto _ : state) {
    made.clear();
    particle.identifier = ++step % 1000;
    bubbles::entrain(model, particle, 1e-4 * static_cast<double>(state.range(0)), 1e-3, step, made);
    bubbles += made.size();
  }
  state.counters["bubbles"] = benchmark::Counter(static_cast<double>(bubbles), benchmark::Counter::kAvgIterations);
}

// Oxygen of a bubble over a step, in closed form with Higbie's coefficient; the concentration that it sees and its
// share of the return ride on the passes of the momentum exchange.
void oxygen_of_bubbles(benchmark::State& state) {
  use_threads(state, 1);
  const auto size = static_cast<std::size_t>(state.range(0));
  const oxygen::Gas gas{.diffusivity = 2e-9, .viscosity = 1e-6, .saturation = 9.1, .weight = 9810, .level = 1};
  Array<double> radius(size), height(size), slip(size), concentration(size);
  std::vector<oxygen::Exchange> found(size);
  std::vector<oxygen::Contents> contents(size);
  for (std::size_t b = 0; b < size; ++b) {
    const auto r = random_uniform(3, RandomPurpose::test, b, 0, 0);
    radius[b] = 0.001 + 0.002 * r[0];
    height[b] = r[1];
    slip[b] = 0.1 + 0.2 * r[2];
    concentration[b] = 8 * r[0];
    const double moles = gas.moles(4 * M_PI / 3 * radius[b] * radius[b] * radius[b], height[b]);
    contents[b] = {gas.fraction * moles, (1 - gas.fraction) * moles};
  }
  for (auto _ : state) {
    parallel_for(size, [&](std::size_t b) {
      found[b] =
          oxygen::exchange(gas, contents[b], oxygen::sphere(radius[b]), height[b], slip[b], concentration[b], 1e-3);
    });
    benchmark::ClobberMemory();
  }
  state.counters["time_per_bubble"] = benchmark::Counter(
      static_cast<double>(size), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Argument: bubbles, all born and all removed.
void births_and_deaths(benchmark::State& state) {
  use_threads(state, 1);
  bubbles::Population population({true, true, true});
  const auto items = static_cast<std::size_t>(state.range(0));
  Array<std::uint8_t> dead(items);
  for (auto& flag : dead) flag = 1;
  for (auto _ : state) {
    population.give_birth(items, 0, [](std::size_t, std::vector<bubbles::NewBubble>& list) {
      list.push_back({{0.5, 0.5, 0.5}, {}, {}, 1e-9, false});
    });
    population.remove(dead);
  }
  state.counters["time_per_bubble"] = benchmark::Counter(
      static_cast<double>(items), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(bubble_sums)->Apply(ParticleCube::sizes);
BENCHMARK(particles_around_bubbles)->Apply(ParticleCube::sizes);
BENCHMARK(interpolation_to_bubbles)->Apply(ParticleCube::sizes);
BENCHMARK(entrainment)->Arg(5)->Arg(15);
BENCHMARK(oxygen_of_bubbles)
    ->ArgNames({"bubbles", "threads"})
    ->ArgsProduct({{10000, 100000}, thread_counts()})
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(births_and_deaths)
    ->ArgNames({"bubbles", "threads"})
    ->ArgsProduct({{10000, 100000}, thread_counts()})
    ->UseRealTime();

}  // namespace
}  // namespace spume
