// SPDX-License-Identifier: MIT
#include "machine.hpp"

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/random.hpp"
#include "spume/core/simd.hpp"

namespace spume {
namespace {

using simd::f32n;

f32n load(const float* p) {
  f32n v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
void store(float* p, f32n v) {
  std::memcpy(p, &v, sizeof v);
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Largest rate of `work`, which returns what it did, over about 50 ms. Every thread runs it; the first run warms up.
template <class Body>
double best_rate(Body&& work) {
  double best = 0;
  const double end = now() + 0.05;
  for (int run = 0; run < 3 || now() < end; ++run) {
    const double begin = now(), amount = work();
    if (run > 0) best = std::max(best, amount / (now() - begin));
  }
  return best;
}

double triad(int threads, std::size_t size, int repeats) {
  std::vector<Array<float>> a(static_cast<std::size_t>(threads)), b = std::vector<Array<float>>(a.size()),
                                                                  c = std::vector<Array<float>>(a.size());
#pragma omp parallel num_threads(threads)
  {
    const auto t = static_cast<std::size_t>(omp_get_thread_num());
    for (auto* set : {&a, &b, &c}) {
      (*set)[t].resize(size);
      std::fill((*set)[t].begin(), (*set)[t].end(), 1.0F);
    }
  }
  return best_rate([&] {
#pragma omp parallel num_threads(threads)
    {
      const auto t = static_cast<std::size_t>(omp_get_thread_num());
      float* x = a[t].data();
      const float *y = b[t].data(), *z = c[t].data();
      for (int repeat = 0; repeat < repeats; ++repeat) {
        for (std::size_t i = 0; i < size; i += simd::pair_lanes) store(x + i, load(y + i) + 1e-3F * load(z + i));
        benchmark::ClobberMemory();
      }
    }
    return 12.0 * static_cast<double>(size) * repeats * threads;
  });
}

double multiply_add(int threads) {
  constexpr int chains = 10, length = 100000;  // enough to hide the latency of a fused multiply-add
  return best_rate([&] {
#pragma omp parallel num_threads(threads)
    {
      f32n sum[chains];
      for (int k = 0; k < chains; ++k) sum[k] = simd::splat<f32n>(static_cast<float>(k));
      f32n x = simd::splat<f32n>(0.999F), y = simd::splat<f32n>(1e-3F);
      benchmark::DoNotOptimize(x);
      benchmark::DoNotOptimize(y);
      for (int i = 0; i < length; ++i)
        for (int k = 0; k < chains; ++k) sum[k] = sum[k] * x + y;
      for (int k = 0; k < chains; ++k) benchmark::DoNotOptimize(sum[k]);
    }
    return 2.0 * simd::pair_lanes * chains * length * threads;
  });
}

double gather(int threads) {
  constexpr std::size_t records = 256 * 1024 / 16, picks = 1 << 14;
  constexpr int repeats = 200;  // a millisecond: to wake a thread takes a tenth of one
  std::vector<float> table(4 * records, 1.0F);
  std::vector<std::int32_t> entry(picks);
  for (std::size_t i = 0; i < picks; ++i)
    entry[i] = 4 * static_cast<std::int32_t>(random_uniform(1, RandomPurpose::test, i, 0, 0)[0] * records);
  return best_rate([&] {
#pragma omp parallel num_threads(threads)
    {
      f32n sum = simd::splat<f32n>(0);
      for (int repeat = 0; repeat < repeats; ++repeat)
        for (std::size_t i = 0; i < picks; i += simd::pair_lanes) {
          f32n out[4];
          simd::load_records<4>(table.data(), entry.data() + i, 0, out);
          sum = sum + ((out[0] + out[1]) + (out[2] + out[3]));
        }
      benchmark::DoNotOptimize(sum);
    }
    return static_cast<double>(repeats) * static_cast<double>(picks) * threads;
  });
}

// The limits as benchmarks of their own, so that a table of results holds them. Argument: threads.
void machine(benchmark::State& state) {
  const MachineLimits& limits = machine_limits(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(&limits);
  state.counters["memory_bytes_per_second"] = limits.memory_bytes;
  state.counters["cache_bytes_per_second"] = limits.cache_bytes;
  state.counters["flops_per_second"] = limits.flops;
  state.counters["gathers_per_second"] = limits.gathers;
}
BENCHMARK(machine)->ArgName("threads")->ArgsProduct({thread_counts()})->Iterations(1);

}  // namespace

const MachineLimits& machine_limits(int threads) {
  static std::map<int, MachineLimits> known;
  const auto found = known.find(threads);
  if (found != known.end()) return found->second;
  MachineLimits limits;
  limits.memory_bytes = triad(threads, 8 << 20, 1);
  limits.cache_bytes = triad(threads, 128 * 1024 / 12 / simd::pair_lanes * simd::pair_lanes, 100);
  limits.flops = multiply_add(threads);
  limits.gathers = gather(threads);
  return known[threads] = limits;
}

std::vector<std::int64_t> thread_counts() {
  const int all = omp_get_num_procs();
  return all > 1 ? std::vector<std::int64_t>{1, all} : std::vector<std::int64_t>{1};
}

int use_threads(const benchmark::State& state, std::size_t argument) {
  const int threads = static_cast<int>(state.range(argument));
  omp_set_num_threads(threads);
  return threads;
}

void count_against_machine(benchmark::State& state, const Work& work, int threads) {
  const MachineLimits& limits = machine_limits(threads);
  const auto rate = [&](const char* name, double amount) {
    if (amount > 0) state.counters[name] = benchmark::Counter(amount, benchmark::Counter::kIsIterationInvariantRate);
  };
  rate("bytes_per_second", work.bytes);
  rate("flops_per_second", work.flops);
  rate("gathers_per_second", work.gathers);
  rate("cached_per_second", work.cached);
  rate("of_limit", std::max({work.bytes / limits.memory_bytes, work.flops / limits.flops, work.gathers / limits.gathers,
                             work.cached / limits.cache_bytes}));
}

}  // namespace spume
