// SPDX-License-Identifier: MIT
#include "spume/run/body_report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/run/report.hpp"

namespace spume {
namespace {

std::string bounds_text(const Bounds& bounds, int dimensions) {
  std::string text;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a) {
    text += a == 0 ? "[" : " x [";
    text += short_number(bounds.lower[a]);
    text += ", ";
    text += short_number(bounds.upper[a]);
    text += "]";
  }
  return text;
}

// Particles of the scene's spacing that a solid has room for in the domain; `exact`: its distance changes by no more
// than the way.
double room(const Scene& scene, bool exact, const std::function<double(const Vec3&)>& distance_of) {
  constexpr double most = 1e6;
  const auto dimensions = static_cast<std::size_t>(scene.domain.dimensions);
  double volume = 1;
  for (std::size_t a = 0; a < dimensions; ++a) volume *= scene.domain.upper[a] - scene.domain.lower[a];
  const double spacing = std::max(scene.spacing, std::pow(volume / most, 1.0 / static_cast<double>(dimensions)));
  std::array<std::size_t, 3> count{1, 1, 1};
  Vec3 width{};
  double cell = 1;
  for (std::size_t a = 0; a < dimensions; ++a) {
    const double length = scene.domain.upper[a] - scene.domain.lower[a];
    count[a] = static_cast<std::size_t>(std::max(1.0, std::round(length / spacing)));
    width[a] = length / static_cast<double>(count[a]);
    cell *= width[a];
  }
  // Along a row the next places within the distance lie on the same side, which spares most questions to a mesh.
  // Distances that are interpolated do not promise that.
  const double found = parallel_sum(count[1] * count[2], [&](std::size_t row) {
    const std::size_t j = row % count[1], k = row / count[1];
    Vec3 p{0, scene.domain.lower[1] + (static_cast<double>(j) + 0.5) * width[1],
           scene.domain.lower[2] + (static_cast<double>(k) + 0.5) * width[2]};
    if (dimensions == 2) p[2] = 0;
    double inside = 0;
    for (std::size_t i = 0; i < count[0];) {
      p[0] = scene.domain.lower[0] + (static_cast<double>(i) + 0.5) * width[0];
      const double distance = distance_of(p);
      const double alike = exact ? 1 + std::max(0.0, std::floor(std::abs(distance) / width[0] - 0.5)) : 1;
      const auto next = static_cast<std::size_t>(std::min(alike, static_cast<double>(count[0] - i)));
      // Of a cell that the surface passes the part behind it, as if it were flat and across an axis.
      const double share = std::clamp(0.5 - distance / width[0], 0.0, 1.0);
      inside += share * static_cast<double>(next);
      i += next;
    }
    return inside;
  });
  return found * cell / std::pow(scene.spacing, static_cast<double>(dimensions));
}

std::string released(const Release& release) {
  const auto copies = static_cast<double>(release.copies);
  return "\n    released from t = " + short_number(release.first) + " on every " +
         short_number(release.cycle / copies) + ", on its way for " + short_number(release.duration) + ": " +
         std::to_string(release.copies) + " copies" +
         (release.growth > 0 ? ", which grow for " + short_number(release.growth) : "") +
         (release.shrinkage > 0 ? ", which shrink for " + short_number(release.shrinkage) + " at last" : "");
}

}  // namespace

std::string body_table(const Scene& scene) {
  const int dimensions = scene.domain.dimensions;
  const std::string measure = dimensions == 3 ? "volume " : "area ";
  std::string text;
  for (const Body& body : scene.bodies) {
    const Release* release =
        body.motion && scene.motions[*body.motion].release ? &*scene.motions[*body.motion].release : nullptr;
    if (release != nullptr && release->copy > 0) continue;
    text += "  " + body.name + "  " + body.kind;
    text += body.inside ? "" : " with the solid outside";
    text += body.wall == BoundaryKind::open        ? ", a shape to fill"
            : body.wall == BoundaryKind::free_slip ? ", free-slip wall"
                                                   : ", no-slip wall";
    if (body.subtract) text += ", subtracted";
    text += "\n    bounds " + bounds_text(body.shape->bounds(), dimensions) + ", " + measure +
            short_number(body.shape->volume());
    if (release != nullptr) {
      text += released(*release) + "\n";
      continue;
    }
    if (body.shape->error() > 0) text += ", distances within " + short_number(body.shape->error());
    text +=
        "\n    room in the domain for about " +
        short_number(room(scene, body.solid->error() == 0, [&](const Vec3& p) { return body.solid->distance(p); })) +
        " particles\n";
  }
  const bool exact =
      std::all_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) { return body.solid->error() == 0; });
  if (!scene.walls.empty())
    text += "  all walls together: room in the domain for about " +
            short_number(room(scene, exact, [&](const Vec3& p) { return scene.walls.distance(p); })) + " particles\n";
  return text;
}

}  // namespace spume
