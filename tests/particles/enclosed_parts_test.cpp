// SPDX-License-Identifier: MIT
#include "spume/particles/enclosed_parts.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>

#include "particles/walled.hpp"

namespace spume::test {
namespace {

// One particle after another, from each to all that it meets.
EnclosedParts slow_parts(const Walled& scene, const std::vector<std::uint8_t>& known) {
  const NeighbourList& list = scene.arrangement.list;
  const std::size_t n = list.particles();
  std::vector<std::vector<std::size_t>> meets(n);
  for (std::size_t i = 0; i < n; ++i)
    for (const std::int32_t point : list.of(i)) {
      const auto j = static_cast<std::size_t>(point);
      if (j >= n && scene.arrangement.images.wall_point() != nullptr &&
          scene.arrangement.images.wall_point()[j - n] >= 0)
        continue;
      const std::size_t other = j < n ? j : static_cast<std::size_t>(scene.arrangement.images.source()[j - n]);
      meets[i].push_back(other);
      meets[other].push_back(i);
    }
  EnclosedParts found;
  std::vector<std::uint8_t> seen(n, 0);
  for (std::size_t first = 0; first < n; ++first) {
    if (seen[first] != 0) continue;
    std::vector<std::size_t> members{first};
    seen[first] = 1;
    bool is_known = false;
    for (std::size_t k = 0; k < members.size(); ++k) {
      is_known = is_known || known[members[k]] != 0;
      for (const std::size_t other : meets[members[k]])
        if (seen[other] == 0) {
          seen[other] = 1;
          members.push_back(other);
        }
    }
    if (is_known) {
      found.all = false;
      continue;
    }
    std::sort(members.begin(), members.end());
    found.parts.emplace_back(members.begin(), members.end());
  }
  return found;
}

// A grid of chambers in a periodic box: walls thicker than a kernel, some with a door.
const std::string chambers =
    scene_text("lower = [0, 0]\nupper = [2, 2]\nx = \"periodic\"\nbottom = \"free-slip\"\n", 0.04,
               "[[solid]]\nlower = [0.5, 0]\nupper = [0.7, 2]\n[[solid]]\nlower = [1.4, 0]\nupper = [1.6, 1.2]\n"
               "[[solid]]\nlower = [0, 1.2]\nupper = [2, 1.4]\n");

}  // namespace

TEST(EnclosedParts, AgreeWithTheSlowTwinForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  for (const std::string& text : {chambers, scene_text(square, 0.05, disc + pipe), scene_text(cube, 0.1, ball)}) {
    Walled scene(text);
    const std::size_t n = scene.particles.size();
    for (const unsigned rare : {0U, 100U, 3U}) {
      std::vector<std::uint8_t> known(n, 0);
      for (std::size_t i = 0; i < n && rare > 0; ++i) known[i] = uniform(i, 1)[0] * rare < 1 && i % 5 == 0 ? 1 : 0;
      const EnclosedParts wanted = slow_parts(scene, known);
      for (const int count : {1, 2, 3}) {
        omp_set_num_threads(count);
        const EnclosedParts found =
            enclosed_parts(scene.arrangement.context, [&](std::size_t i) { return known[i] != 0; });
        EXPECT_EQ(found.parts, wanted.parts) << count << " threads";
        EXPECT_EQ(found.all, wanted.all);
      }
    }
  }
  omp_set_num_threads(threads);
}

TEST(EnclosedParts, OfChambersAreThree) {
  Walled scene(chambers);
  EXPECT_EQ(enclosed_parts(scene.arrangement.context, [](std::size_t) { return false; }).parts.size(), 3U);
}

}  // namespace spume::test
