// SPDX-License-Identifier: MIT
#include "spume/particles/enclosed_parts.hpp"

#include <algorithm>

#include "spume/neighbours/images.hpp"
#include "spume/neighbours/neighbour_list.hpp"

namespace spume {

EnclosedParts enclosed_parts(const SweepContext& context, const std::function<bool(std::size_t)>& is_known) {
  const NeighbourList& list = *context.list;
  const auto n = static_cast<std::int32_t>(list.particles());
  const std::int32_t* source = context.images == nullptr ? nullptr : context.images->source();
  const std::int32_t* wall_point = context.walls == nullptr ? nullptr : context.images->wall_point();
  std::vector<std::uint8_t> seen(list.particles(), 0);
  EnclosedParts found;
  std::vector<std::int32_t> ahead;
  for (std::int32_t first = 0; first < n; ++first) {
    if (seen[static_cast<std::size_t>(first)] != 0) continue;
    std::vector<std::int32_t> members;
    bool known = false;
    const auto reach = [&](std::int32_t i) {
      if (seen[static_cast<std::size_t>(i)] != 0) return;
      seen[static_cast<std::size_t>(i)] = 1;
      ahead.push_back(i);
    };
    reach(first);
    while (!ahead.empty()) {
      const std::int32_t i = ahead.back();
      ahead.pop_back();
      members.push_back(i);
      known = known || is_known(static_cast<std::size_t>(i));
      for (const std::int32_t point : list.of(static_cast<std::size_t>(i))) {
        if (point < n)
          reach(point);
        else if (wall_point == nullptr || wall_point[point - n] < 0)
          reach(source[point - n]);
      }
    }
    if (known) {
      found.all = false;
      continue;
    }
    std::sort(members.begin(), members.end());
    found.parts.push_back(std::move(members));
  }
  return found;
}

}  // namespace spume
