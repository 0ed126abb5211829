// SPDX-License-Identifier: MIT
// What this machine can do at best, measured in the same process as the routines, and how near a routine comes to it.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

namespace spume {

// All threads together.
struct MachineLimits {
  double memory_bytes = 0;  // per second, triad a = b + s c over arrays far larger than the caches
  double cache_bytes = 0;   // the same over 128 kB per thread
  double flops = 0;         // per second, fused multiply-adds of full registers of floats, two operations a lane
  double gathers = 0;       // per second, records of 16 bytes picked from 256 kB per thread and transposed
};

// Best of a fifth of a second, found once per number of threads.
const MachineLimits& machine_limits(int threads);

// What a routine must at least do in one iteration, counted by hand.
struct Work {
  double bytes = 0;  // moved to and from memory when the caches hold what is used again
  double flops = 0;
  double gathers = 0;  // records of 16 bytes from a random place near by
  double cached = 0;   // bytes moved between the nearest caches and the registers, in rows longer than a record
};

// Counters: bytes_per_second, flops_per_second, gathers_per_second, cached_per_second as far as they are given, and
// of_limit, the time that the slowest of them would take on a perfect machine over the time taken.
void count_against_machine(benchmark::State& state, const Work& work, int threads);

// One thread, and as many as the machine has.
std::vector<std::int64_t> thread_counts();
// Takes the number of threads from that argument of the benchmark: what another one left set would count else.
int use_threads(const benchmark::State& state, std::size_t argument);

}  // namespace spume
