// SPDX-License-Identifier: MIT
#include "spume/core/array.hpp"

#include <sys/mman.h>

#include <atomic>
#include <cstdlib>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

std::atomic<std::int64_t> held_bytes{0};
std::atomic<std::int64_t> peak_bytes{0};
std::atomic<std::int64_t> allocations{0};
constexpr std::size_t huge_page = std::size_t{1} << 21;

}  // namespace

ArrayStatistics array_statistics() {
  return {held_bytes.load(), peak_bytes.load(), allocations.load()};
}

namespace detail {

void* allocate_aligned(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  const std::size_t rounded = (bytes + 63) / 64 * 64;
  const bool large = rounded >= 2 * huge_page;
  // Not aligned_alloc: its sizes are multiples of the alignment.
  void* pointer = nullptr;
  if (posix_memalign(&pointer, large ? huge_page : 64, rounded) != 0) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  // Strided passes over large fields miss the address cache at every line otherwise. The last, incomplete page stays
  // small, so that no memory is wasted; a kernel without huge pages ignores the wish.
  if (large) madvise(pointer, rounded / huge_page * huge_page, MADV_HUGEPAGE);
#endif
  auto* raw = static_cast<unsigned char*>(pointer);
  parallel_blocks(rounded, std::size_t{1} << 16,
                  [&](std::size_t, std::size_t first, std::size_t last) { std::memset(raw + first, 0, last - first); });
  const std::int64_t now = held_bytes += static_cast<std::int64_t>(bytes);
  std::int64_t peak = peak_bytes.load();
  while (now > peak && !peak_bytes.compare_exchange_weak(peak, now)) {
  }
  ++allocations;
  return pointer;
}

void release_aligned(void* pointer, std::size_t bytes) noexcept {
  if (pointer == nullptr) return;
  held_bytes -= static_cast<std::int64_t>(bytes);
  std::free(pointer);
}

}  // namespace detail
}  // namespace spume
