// SPDX-License-Identifier: MIT
#include "spume/particles/thin_bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/scene/plates.hpp"
#include "wall_shells.hpp"

namespace spume {
namespace {

// Of the curvature of a flat surface, times a spacing, at most.
constexpr double flat = 0.2;

bool is_flat(const Scene& scene, const Body& body, double spacing, double reach) {
  const int d = scene.domain.dimensions;
  const ShapePointer& solid = body.motion ? body.alone : body.solid;
  const Combination alone({{solid, false}});
  const Bounds window = window_around(scene, body, reach);
  const double step = spacing / 2;
  std::array<std::size_t, 3> count{1, 1, 1};
  for (int axis = 0; axis < d; ++axis)
    count[axis] = static_cast<std::size_t>(std::ceil((window.upper[axis] - window.lower[axis]) / step)) + 1;
  struct Places {
    std::size_t flat = 0, curved = 0;
  };
  const Places all = parallel_reduce(
      count[1] * count[2], Places{},
      [&](std::size_t first, std::size_t last) {
        Places found;
        for (std::size_t row = first; row < last; ++row) {
          Vec3 place{window.lower[0], window.lower[1] + step * static_cast<double>(row % count[1]),
                     d == 3 ? window.lower[2] + step * static_cast<double>(row / count[1]) : 0.0};
          while (place[0] <= window.upper[0] + step) {
            const double distance = solid->distance(place);
            if (distance > 0.25 * spacing && distance < 0.75 * spacing) {
              const NearestPoint near = solid->nearest(place);
              const MirroredShare share = mirrored_share(alone, near, place, spacing, d);
              if (!share.edge)
                ++(std::abs(share.share - 1) < 2 * flat * distance / spacing ? found.flat : found.curved);
            }
            place[0] += std::max(step, distance - 0.75 * spacing);  // the surface is not nearer
          }
        }
        return found;
      },
      [](const Places& a, const Places& b) {
        return Places{a.flat + b.flat, a.curved + b.curved};
      });
  return all.flat > all.curved;
}

}  // namespace

std::vector<std::uint8_t> find_thin_bodies(const Scene& scene, const Resolution& resolution) {
  std::vector<std::uint8_t> thin(scene.bodies.size(), 0);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.wall == BoundaryKind::open || (body.motion && scene.motions[*body.motion].release)) continue;
    const bool cut = std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& other) {
      return other.subtract && other.wall != BoundaryKind::open && other.motion == body.motion;
    });
    const double spacing = resolution.spacing, reach = resolution.support_radius;
    thin[b] = !cut && is_plate(scene, body, spacing, reach) && is_flat(scene, body, spacing, reach) ? 1 : 0;
  }
  return thin;
}

}  // namespace spume
