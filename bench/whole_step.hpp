// SPDX-License-Identifier: MIT
// Whole steps of a method as a routine to time. Arguments of the state: particles per unit of length, threads.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/methods/registry.hpp"

namespace spume {

template <class Method>
void time_steps(benchmark::State& state, const char* path, int warming, std::vector<std::string> set = {}) {
  omp_set_num_threads(static_cast<int>(state.range(1)));
  char spacing[60];
  std::snprintf(spacing, sizeof spacing, "resolution.spacing=%.17g", 1.0 / static_cast<double>(state.range(0)));
  set.emplace_back(spacing);
  const LoadedCase loaded = load_case(path, set);
  Method method(loaded);
  Ledger ledger;
  const double dt = method.step_limit().dt;
  for (int step = 0; step < warming; ++step) method.step(dt, ledger);
  for (auto _ : state) method.step(dt, ledger);
  state.counters["time_per_particle"] =
      benchmark::Counter(static_cast<double>(method.particle_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  double bytes = 0;
  for (const ArrayInfo& array : method.arrays()) bytes += array.bytes;
  state.counters["bytes_per_particle"] = bytes / static_cast<double>(method.particle_count());
}

}  // namespace spume
