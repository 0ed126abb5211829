// SPDX-License-Identifier: MIT
#include "spume/scene/enclosed_liquid.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "spume/scene/solid_union.hpp"

namespace spume {
namespace {

using Chamber = std::vector<std::array<Vec3, 2>>;

// The particles of a chamber by cells of a spacing.
class Occupied {
 public:
  Occupied(const Scene& scene, const Chamber& chamber) : scene_(scene) {
    const auto holds = [&](const std::array<Vec3, 2>& box, const Vec3& place) {
      for (int axis = 0; axis < scene.domain.dimensions; ++axis)
        if (place[axis] < box[0][axis] || place[axis] > box[1][axis]) return false;
      return true;
    };
    for (std::size_t i = 0; i < scene.particles.size(); ++i) {
      Vec3 place{};
      for (int axis = 0; axis < scene.domain.dimensions; ++axis) place[axis] = scene.particles.position[axis][i];
      if (std::any_of(chamber.begin(), chamber.end(), [&](const auto& box) { return holds(box, place); }))
        cells_[code(cell_of(place))].push_back(place);
    }
  }
  bool near(const Vec3& place, double reach) const {
    const std::array<std::int64_t, 3> own = cell_of(place);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find(code({own[0] + k % 3 - 1, own[1] + k / 3 % 3 - 1, own[2] + k / 9 - 1}));
      if (found == cells_.end()) continue;
      for (const Vec3& p : found->second) {
        double square = 0;
        for (std::size_t a = 0; a < 3; ++a) square += (p[a] - place[a]) * (p[a] - place[a]);
        if (square < reach * reach) return true;
      }
    }
    return false;
  }

 private:
  std::array<std::int64_t, 3> cell_of(const Vec3& place) const {
    std::array<std::int64_t, 3> cell{};
    for (int axis = 0; axis < scene_.domain.dimensions; ++axis)
      cell[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::floor((place[axis] - scene_.domain.lower[axis]) / scene_.spacing));
    return cell;
  }
  // 2^21 cells along an axis.
  static std::int64_t code(const std::array<std::int64_t, 3>& cell) {
    constexpr std::int64_t some = std::int64_t{1} << 20;
    return ((cell[2] + some) << 42) | ((cell[1] + some) << 21) | (cell[0] + some);
  }

  const Scene& scene_;
  std::unordered_map<std::int64_t, std::vector<Vec3>> cells_;
};

// Whether there is a particle near every place: below a surface that stands a layer below the ceiling some are a
// spacing away from all.
bool is_full(const Chamber& chamber, const Scene& scene, const Occupied& occupied) {
  constexpr double near = 0.95;  // spacings
  const auto d = static_cast<std::size_t>(scene.domain.dimensions);
  for (const auto& [lower, upper] : chamber) {
    std::array<std::size_t, 3> count{1, 1, 1};
    for (std::size_t a = 0; a < d; ++a)
      count[a] = static_cast<std::size_t>(std::max(1.0, std::round((upper[a] - lower[a]) / scene.spacing)));
    for (std::size_t n = 0; n < count[0] * count[1] * count[2]; ++n) {
      const std::array<std::size_t, 3> at{n % count[0], n / count[0] % count[1], n / (count[0] * count[1])};
      Vec3 place{};
      for (std::size_t a = 0; a < d; ++a)
        place[a] =
            lower[a] + (static_cast<double>(at[a]) + 0.5) / static_cast<double>(count[a]) * (upper[a] - lower[a]);
      if (!occupied.near(place, near * scene.spacing)) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<Vec3> enclosed_liquid(const Scene& scene) {
  if (scene.domain.boxes.empty()) return std::nullopt;
  SolidUnion::Planes sides{};
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    sides[axis] = {scene.domain.lower[axis], scene.domain.upper[axis]};
  const std::vector<Chamber> chambers = SolidUnion(scene.domain, sides, scene.spacing).chambers();
  if (chambers.empty() || (chambers.size() == 1 && !scene.free_surface)) return std::nullopt;
  std::size_t full = 0;
  std::optional<Vec3> found;
  for (const Chamber& chamber : chambers) {
    if (!is_full(chamber, scene, Occupied(scene, chamber))) continue;
    ++full;
    const auto& [lower, upper] = chamber.front();
    found = Vec3{(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, (lower[2] + upper[2]) / 2};
  }
  return full > (scene.free_surface ? 0U : 1U) ? found : std::nullopt;
}

}  // namespace spume
