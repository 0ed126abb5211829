// SPDX-License-Identifier: MIT
// Parallel loops and reductions whose results do not depend on the thread count.
//
// A loop over n items is cut into blocks of a fixed size; blocks are handed to threads in any order, but
// every block runs serially and block results are combined in block order. The same n gives the same bits
// on 1 or 64 threads.
#pragma once

#include <omp.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <type_traits>

#include "spume/core/block_shares.hpp"

namespace spume {

// Particles per block of a sweep: large enough that dispatch (about 0.1 us) is noise beside about 50 us of
// work, small enough that 64 threads share 1e5 particles evenly.
inline constexpr std::size_t default_block = 512;

inline std::size_t block_count(std::size_t n, std::size_t block) {
  return (n + block - 1) / block;
}

// Calls body(block_index, first, last) for every block of [0, n). Every thread begins with a contiguous run of blocks,
// so that it touches the memory that it touched first, and takes from the others' when it is done; an exception thrown
// in a block is rethrown on the caller's thread.
template <class Body>
void parallel_blocks(std::size_t n, std::size_t block, Body&& body) {
  const std::size_t blocks = block_count(n, block);
  if (blocks == 0) return;
  if (blocks == 1) {
    body(std::size_t{0}, std::size_t{0}, n);
    return;
  }
  BlockShares shares(blocks, omp_get_max_threads());
  std::exception_ptr failure;
#pragma omp parallel
  {
    const int thread = omp_get_thread_num();
    for (std::size_t b = 0; shares.next(thread, b);) {
      try {
        body(b, b * block, std::min(n, (b + 1) * block));
      } catch (...) {
#pragma omp critical(spume_parallel_blocks)
        if (!failure) failure = std::current_exception();
      }
    }
  }
  if (failure) std::rethrow_exception(failure);
}

// Calls body(i) for every i in [0, n).
template <class Body>
void parallel_for(std::size_t n, Body&& body) {
  parallel_blocks(n, default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

// The most partial results a reduction keeps: enough for 64 threads, few enough to live on the stack.
inline constexpr std::size_t max_reduction_blocks = 256;

// Combines value(first, last) of at most 256 fixed blocks in block order: result = combine(result, block).
// The block size depends on n alone.
template <class T, class Value, class Combine>
T parallel_reduce(std::size_t n, T start, Value&& value, Combine&& combine) {
  if (n == 0) return start;
  const std::size_t block = std::max(default_block, (n + max_reduction_blocks - 1) / max_reduction_blocks);
  std::array<T, max_reduction_blocks> partial;
  parallel_blocks(n, block,
                  [&](std::size_t b, std::size_t first, std::size_t last) { partial[b] = value(first, last); });
  T result = start;
  for (std::size_t b = 0; b < block_count(n, block); ++b) result = combine(result, partial[b]);
  return result;
}

// Sum of term(i) over [0, n).
template <class Term>
double parallel_sum(std::size_t n, Term&& term) {
  return parallel_reduce(
      n, 0.0,
      [&](std::size_t first, std::size_t last) {
        double sum = 0;
        for (std::size_t i = first; i < last; ++i) sum += term(i);
        return sum;
      },
      [](double a, double b) { return a + b; });
}

// The larger of two; NaN when one of them is.
inline double larger_or_nan(double a, double b) {
  return (a > b || a != a) ? a : b;
}

// Largest term(i) over [0, n), or `start` when n is zero. A NaN term is kept: it makes the result NaN.
template <class Term>
double parallel_max(std::size_t n, double start, Term&& term) {
  return parallel_reduce(
      n, start,
      [&](std::size_t first, std::size_t last) {
        double best = term(first);
        for (std::size_t i = first + 1; i < last; ++i) best = larger_or_nan(best, term(i));
        return best;
      },
      larger_or_nan);
}

// The indices i of [0, n) with chosen(i), in order: counted by blocks, then written. `chosen` is called twice.
template <class List, class Chosen>
void parallel_select(std::size_t n, List& list, Chosen&& chosen) {
  const std::size_t block = std::max<std::size_t>(4096, (n + max_reduction_blocks - 1) / max_reduction_blocks);
  std::array<std::size_t, max_reduction_blocks + 1> start{};
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) start[b + 1] += chosen(i) ? 1 : 0;
  });
  for (std::size_t b = 0; b < block_count(n, block); ++b) start[b + 1] += start[b];
  list.resize(start[block_count(n, block)]);
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::size_t slot = start[b];
    for (std::size_t i = first; i < last; ++i)
      if (chosen(i)) list[slot++] = static_cast<std::remove_reference_t<decltype(list[0])>>(i);
  });
}

// Number of threads a parallel loop will use.
inline int thread_count() {
  return omp_get_max_threads();
}

}  // namespace spume
