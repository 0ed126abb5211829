// SPDX-License-Identifier: MIT
// Writing a checkpoint of twelve arrays to the folder for temporary files, against writing as many bytes there in one
// piece and waiting for the disk, as a checkpoint does. Argument: particles.
#include "spume/io/checkpoint.hpp"

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>

namespace spume {
namespace {

// Seconds, the best of three.
double write_in_one_piece(const std::filesystem::path& path, const void* data, std::size_t bytes) {
  double best = INFINITY;
  for (int round = 0; round < 3; ++round) {
    const auto start = std::chrono::steady_clock::now();
    std::FILE* file = std::fopen(path.c_str(), "wb");
    const bool whole = file != nullptr && std::fwrite(data, 1, bytes, file) == bytes && std::fflush(file) == 0 &&
                       ::fsync(::fileno(file)) == 0;
    if (file != nullptr) std::fclose(file);
    if (!whole) return INFINITY;
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::filesystem::remove(path);
  return best;
}

void checkpoint_write(benchmark::State& state) {
  constexpr int arrays = 12;
  const auto n = static_cast<std::size_t>(state.range(0));
  Array<double> all(arrays * n);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = std::sin(0.1 * static_cast<double>(i));
  const std::span<const double> values(all.data(), n);
  const auto path = std::filesystem::temp_directory_path() / ("spume-bench-" + std::to_string(::getpid()) + ".spume");
  const double floor = write_in_one_piece(path, all.data(), all.size() * sizeof(double));
  for (auto _ : state) {
    CheckpointWriter writer(path, {"bench", "none", "title = 'bench'"});
    for (int k = 0; k < arrays; ++k) writer.f64(std::to_string(k), values);
    writer.commit();
  }
  std::filesystem::remove(path);
  state.counters["of_limit"] = benchmark::Counter(floor, benchmark::Counter::kIsIterationInvariantRate);
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * arrays *
                          static_cast<std::int64_t>(n * sizeof(double)));
}
BENCHMARK(checkpoint_write)->Arg(10000)->Arg(100000)->Arg(1000000)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spume
