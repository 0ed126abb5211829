// SPDX-License-Identifier: MIT
// Writing a checkpoint of twelve arrays to the folder for temporary files. Argument: particles.
#include "spume/io/checkpoint.hpp"

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

namespace spume {
namespace {

void checkpoint_write(benchmark::State& state) {
  constexpr int arrays = 12;
  const auto n = static_cast<std::size_t>(state.range(0));
  Array<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = std::sin(0.1 * static_cast<double>(i));
  const auto path = std::filesystem::temp_directory_path() / ("spume-bench-" + std::to_string(::getpid()) + ".spume");
  for (auto _ : state) {
    CheckpointWriter writer(path, {"bench", "none", "title = 'bench'"});
    for (int k = 0; k < arrays; ++k) writer.f64(std::to_string(k), values);
    writer.commit();
  }
  std::filesystem::remove(path);
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * arrays *
                          static_cast<std::int64_t>(n * sizeof(double)));
}
BENCHMARK(checkpoint_write)->Arg(10000)->Arg(100000)->Arg(1000000)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spume
