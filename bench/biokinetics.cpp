// SPDX-License-Identifier: MIT
// Activated sludge in many particles: cost per particle and step of the flow, and over longer times at once.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/physics/biokinetics/asm1.hpp"
#include "spume/physics/biokinetics/integrator.hpp"

namespace spume {
namespace {

constexpr std::size_t particles = 100'000, block = 512;

// The last tank of the IWA benchmark plant, with oxygen between nothing and saturation.
void react(benchmark::State& state) {
  const double days = 1e-3 * static_cast<double>(state.range(0)) / 86400;
  biokinetics::Asm1Parameters parameters;
  parameters.k_nutrient = parameters.k_alkalinity = 0.01;
  const biokinetics::Integrator integrator(biokinetics::asm1_model(parameters), 1e-6);
  constexpr std::array<double, biokinetics::asm1::components> sludge{30,    0.889, 1149, 49.3,  2559, 150, 452,
                                                                     0.491, 10.4,  1.73, 0.688, 3.53, 4.13};
  std::vector<std::vector<double>> values;
  std::vector<double*> pointers;
  for (const double c : sludge) values.emplace_back(particles, c);
  const auto refill = [&] {
    for (std::size_t i = 0; i < values.size(); ++i) std::fill(values[i].begin(), values[i].end(), sludge[i]);
    for (std::size_t k = 0; k < particles; ++k)
      values[biokinetics::asm1::s_o][k] = 8 * static_cast<double>(k % 97) / 96;
  };
  for (auto& component : values) pointers.push_back(component.data());
  for (auto _ : state) {
    state.PauseTiming();
    refill();
    state.ResumeTiming();
    parallel_blocks(particles, block, [&](std::size_t, std::size_t first, std::size_t last) {
      integrator.advance(pointers, first, last, days);
    });
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(particles));
}
BENCHMARK(react)->Arg(10)->Arg(1000)->Arg(60'000)->Name("ASM1, ms of reaction")->UseRealTime();

}  // namespace
}  // namespace spume
