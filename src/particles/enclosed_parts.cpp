// SPDX-License-Identifier: MIT
#include "spume/particles/enclosed_parts.hpp"

#include <atomic>
#include <map>
#include <utility>

#include "spume/core/parallel.hpp"
#include "spume/neighbours/images.hpp"
#include "spume/neighbours/neighbour_list.hpp"

namespace spume {
namespace {

// A forest over the particles: each points to one before it in its tree, the first of a tree to itself. Trees are
// joined from any number of threads; whatever their order, the first of what meets is the root of it in the end.
class Forest {
 public:
  explicit Forest(std::size_t n) : before_(n) {
    parallel_for(n, [&](std::size_t i) { before_[i] = static_cast<std::int32_t>(i); });
  }

  std::int32_t root(std::int32_t i) {
    for (;;) {
      const std::int32_t before = get(i), next = get(before);
      if (before == next) return before;
      at(i).store(next, std::memory_order_relaxed);  // ways are halved as they are gone
      i = next;
    }
  }
  void join(std::int32_t i, std::int32_t j) {
    if (get(i) == get(j)) return;
    for (std::int32_t a = root(i), b = root(j); a != b; a = root(a), b = root(b)) {
      if (a < b) std::swap(a, b);
      std::int32_t own = a;
      if (at(a).compare_exchange_strong(own, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::atomic_ref<std::int32_t> at(std::int32_t i) {
    return std::atomic_ref<std::int32_t>(before_[static_cast<std::size_t>(i)]);
  }
  std::int32_t get(std::int32_t i) { return at(i).load(std::memory_order_relaxed); }

  std::vector<std::int32_t> before_;
};

}  // namespace

EnclosedParts enclosed_parts(const SweepContext& context, const std::function<bool(std::size_t)>& is_known) {
  const NeighbourList& list = *context.list;
  const std::size_t particles = list.particles();
  const auto n = static_cast<std::int32_t>(particles);
  const std::int32_t* source = context.images == nullptr ? nullptr : context.images->source();
  const std::int32_t* wall_point = context.walls == nullptr ? nullptr : context.images->wall_point();
  Forest forest(particles);
  parallel_for(particles, [&](std::size_t k) {
    const auto i = static_cast<std::int32_t>(k);
    for (const std::int32_t point : list.of(k)) {
      if (point < n)
        forest.join(i, point);
      else if (wall_point == nullptr || wall_point[point - n] < 0)
        forest.join(i, source[point - n]);
    }
  });
  std::vector<std::uint8_t> known(particles, 0);
  parallel_for(particles, [&](std::size_t k) {
    if (!is_known(k)) return;
    const auto root = static_cast<std::size_t>(forest.root(static_cast<std::int32_t>(k)));
    std::atomic_ref<std::uint8_t>(known[root]).store(1, std::memory_order_relaxed);
  });
  EnclosedParts found;
  std::map<std::int32_t, std::size_t> part_of;
  std::int32_t last_root = -1;
  std::size_t part = 0;
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t root = forest.root(i);
    if (known[static_cast<std::size_t>(root)] != 0) {
      found.all = false;
      continue;
    }
    if (root != last_root) {
      const auto [entry, fresh] = part_of.try_emplace(root, found.parts.size());
      if (fresh) found.parts.emplace_back();
      last_root = root;
      part = entry->second;
    }
    found.parts[part].push_back(i);
  }
  return found;
}

}  // namespace spume
