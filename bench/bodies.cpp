// SPDX-License-Identifier: MIT
// Walls of bodies in bench/cases/drum.toml, a round tank with a free surface: values at wall points, the points
// themselves, and a whole step, beside that of a tank of walls along the axes that holds as many particles.
// Arguments: spacings along the tank, threads; of the step, 1 for the round tank.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>
#include <cstdio>

#include "machine.hpp"
#include "spume/methods/les_sph/les_sph.hpp"
#include "spume/methods/registry.hpp"
#include "spume/particles/body_walls.hpp"

namespace spume {
namespace {

std::string scene_spacing(const benchmark::State& state) {
  char text[60];
  std::snprintf(text, sizeof text, "resolution.spacing=%.17g", 1.0 / static_cast<double>(state.range(0)));
  return text;
}

// The tank after a step.
struct Tank {
  LoadedCase loaded;
  les_sph::LesSph method;
  explicit Tank(const LoadedCase& of) : loaded(of), method(loaded) {
    Ledger ledger;
    method.step(method.step_limit().dt, ledger);
  }
  explicit Tank(const benchmark::State& state)
      : Tank(load_case(SPUME_BENCH_CASES "/drum.toml", {scene_spacing(state)})) {}
};

void wall_stencils(benchmark::State& state) {
  use_threads(state, 1);
  const Tank tank(state);
  const les_sph::Flow& flow = tank.method.flow();
  BodyWalls walls(flow.scene, flow.resolution, flow.particles.volume);
  for (auto _ : state)
    walls.find_stencils(flow.arrangement, flow.particles.position, flow.particles.volume, flow.time, flow.time);
  state.counters["wet_points"] = static_cast<double>(walls.stencils().size());
  state.counters["time_per_wet_point"] =
      benchmark::Counter(static_cast<double>(walls.stencils().size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(wall_stencils)
    ->ArgNames({"per_axis", "threads"})
    ->ArgsProduct({{24, 48}, thread_counts()})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void wall_points(benchmark::State& state) {
  use_threads(state, 1);
  const Tank tank(state);
  const les_sph::Flow& flow = tank.method.flow();
  std::size_t points = 0;
  for (auto _ : state)
    points = make_wall_points(flow.scene.walls, flow.scene.domain, flow.resolution, flow.particles.volume).size();
  state.counters["time_per_point"] = benchmark::Counter(
      static_cast<double>(points), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(wall_points)
    ->ArgNames({"per_axis", "threads"})
    ->ArgsProduct({{24}, thread_counts()})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// A box of the same volume: sides of sqrt(pi) 0.45.
LoadedCase box_or_drum(const benchmark::State& state) {
  if (state.range(2) == 1) return load_case(SPUME_BENCH_CASES "/drum.toml", {scene_spacing(state)});
  const std::string half = std::to_string(0.45 * std::sqrt(M_PI) / 2);
  return load_case(
      SPUME_BENCH_CASES "/drum.toml",
      {scene_spacing(state), "body=[]", "liquid=[{upper=[" + half + ", " + half + ", 0.6]}]",
       "domain.lower=[-" + half + ", -" + half + ", 0]", "domain.upper=[" + half + ", " + half + ", 1]",
       "domain.left=free-slip", "domain.right=free-slip", "domain.front=free-slip", "domain.back=free-slip"});
}

void round_tank_step(benchmark::State& state) {
  use_threads(state, 1);
  Tank tank(box_or_drum(state));
  Ledger ledger;
  const double dt = tank.method.step_limit().dt;
  for (auto _ : state) tank.method.step(dt, ledger);
  state.counters["particles"] = static_cast<double>(tank.method.particle_count());
  state.counters["time_per_particle"] =
      benchmark::Counter(static_cast<double>(tank.method.particle_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(round_tank_step)
    ->ArgNames({"per_axis", "threads", "round"})
    ->Args({24, 1, 0})
    ->Args({24, 1, 1})
    ->Args({48, 1, 0})
    ->Args({48, 1, 1})
    ->Iterations(10)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spume
