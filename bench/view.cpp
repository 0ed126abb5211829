// SPDX-License-Identifier: MIT
// A frame of the live view: particles with a pressure and a velocity. Arguments: particles, and the bound of the
// viewer.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "spume/view/frame.hpp"

namespace spume {
namespace {

void view_frame(benchmark::State& state) {
  const auto size = static_cast<std::size_t>(state.range(0));
  std::vector<double> values[6];
  for (std::size_t k = 0; k < 6; ++k) {
    values[k].resize(size);
    for (std::size_t i = 0; i < size; ++i) values[k][i] = std::sin(0.1 * static_cast<double>(i * (k + 1)));
  }
  std::vector<std::int64_t> id(size);
  for (std::size_t i = 0; i < size; ++i) id[i] = static_cast<std::int64_t>(i);
  const ParticleSnapshot family{
      "fluid",
      size,
      {values[0].data(), values[1].data(), values[2].data()},
      {{"velocity", {values[3].data(), values[4].data(), values[5].data()}, {}}, {"id", {}, {id.data()}}}};
  FrameMaker frames;
  FrameWish wish;
  wish.points = static_cast<std::size_t>(state.range(1));
  std::size_t bytes = 0;
  for (auto _ : state) bytes = frames.make(0, 0, {family}, {}, wish)->size();
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(view_frame)->Args({100000, 200000})->Args({1000000, 200000})->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace spume
