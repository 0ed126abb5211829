// SPDX-License-Identifier: MIT
// One bubble and step: cost of the two integrators against the radius, their error against their cost, and the other
// models of a bubble.
#include <benchmark/benchmark.h>

#include <cmath>

#include "spume/core/random.hpp"
#include "spume/physics/bubbles/breakup.hpp"
#include "spume/physics/bubbles/fluctuations.hpp"
#include "spume/physics/bubbles/forces.hpp"

namespace spume {
namespace {

constexpr double spacing = 0.01, step = 2e-3;

bubbles::Gas gas() {
  bubbles::Gas gas;
  gas.viscosity = 1 / 4e4;
  gas.gravity = {0, 0, -1};
  return gas;
}

// A swirling liquid: velocity, vorticity and acceleration change over a time of about one.
bubbles::Surroundings liquid_at(double t) {
  return {{std::sin(3 * t), std::cos(2 * t), 0.3 * std::sin(5 * t)},
          {1, 4 * std::cos(t), -2},
          {3 * std::cos(3 * t), -2 * std::sin(2 * t), 1.5 * std::cos(5 * t)}};
}

Vec3 travel(bool stable, double radius, double end, int steps) {
  const bubbles::Gas g = gas();
  Vec3 u{};
  const double dt = end / steps;
  for (int k = 0; k < steps; ++k)
    u = stable ? bubbles::advance_stable(g, radius, liquid_at((k + 0.5) * dt), u, dt, {})
               : bubbles::advance_substepped(g, radius, liquid_at((k + 0.5) * dt), u, dt, spacing, {});
  return u;
}

// Argument: radius in millionths of the unit of length; from the smallest to the largest that a wave entrains.
template <bool stable>
void advance(benchmark::State& state) {
  const double radius = 1e-6 * static_cast<double>(state.range(0));
  const bubbles::Gas g = gas();
  Vec3 u{};
  double t = 0;
  for (auto _ : state) {
    t += step;
    const bubbles::Surroundings liquid = liquid_at(t);
    u = stable ? bubbles::advance_stable(g, radius, liquid, u, step, {})
               : bubbles::advance_substepped(g, radius, liquid, u, step, spacing, {});
    benchmark::DoNotOptimize(u);
  }
}
BENCHMARK(advance<true>)->RangeMultiplier(2)->Range(16, 8192)->Name("stable integrator, radius in 1e-6");
BENCHMARK(advance<false>)->RangeMultiplier(2)->Range(16, 8192)->Name("substepped integrator, radius in 1e-6");

// Arguments: radius, number of steps to t = 0.5. The error is that of the final velocity against 2^18 stable steps.
template <bool stable>
void precision(benchmark::State& state) {
  const double radius = 1e-6 * static_cast<double>(state.range(0));
  const int steps = static_cast<int>(state.range(1));
  Vec3 u{};
  for (auto _ : state) {
    u = travel(stable, radius, 0.5, steps);
    benchmark::DoNotOptimize(u);
  }
  const Vec3 exact = travel(true, radius, 0.5, 1 << 18);
  state.counters["error"] = std::hypot(u[0] - exact[0], u[1] - exact[1], u[2] - exact[2]);
}
void radii_and_steps(benchmark::internal::Benchmark* benchmark) {
  for (const int radius : {100, 1000, 5000})
    for (const int steps : {32, 128, 512, 2048}) benchmark->Args({radius, steps});
}
BENCHMARK(precision<true>)->Apply(radii_and_steps)->Name("stable work-precision, radius/steps");
BENCHMARK(precision<false>)->Apply(radii_and_steps)->Name("substepped work-precision, radius/steps");

void fluctuation(benchmark::State& state) {
  Vec3 u{};
  std::uint32_t k = 0;
  for (auto _ : state) {
    const auto z = random_normal(1, RandomPurpose::test, 7, ++k, 0);
    u = bubbles::advance_fluctuation(u, {0.1, 0.02, 0.2}, 1e-3, spacing, 1, step, {z[0], z[1], z[2]});
    benchmark::DoNotOptimize(u);
  }
}
BENCHMARK(fluctuation)->Name("fluctuation, its random numbers included");

void child_size(benchmark::State& state) {
  const bubbles::ChildSizeTable table;
  double u = 0;
  for (auto _ : state) {
    u += 0.618033988749895;
    u -= std::floor(u);
    benchmark::DoNotOptimize(table(u, 0.3 + 0.5 * u));
  }
}
BENCHMARK(child_size)->Name("child size");

void child_table(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(bubbles::ChildSizeTable());
}
BENCHMARK(child_table)->Name("table of child sizes")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spume
