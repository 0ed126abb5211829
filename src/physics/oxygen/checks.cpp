// SPDX-License-Identifier: MIT
#include "spume/physics/oxygen/checks.hpp"

#include <cmath>

#include "spume/physics/oxygen/options.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/option.hpp"
#include "spume/scene/scene.hpp"

namespace spume {
namespace {

// Places along the way of a body that are looked at.
constexpr int places_on_way = 50;

// Whether some particle is within `reach` of the surface of a body there.
bool meets_liquid(const Scene& scene, const Shape& shape, const RigidPlace& place, double reach) {
  const InitialParticles& particles = scene.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Vec3 r{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(scene.domain.dimensions); ++a) {
      r[a] = particles.position[a][i];
      if (scene.domain.periodic(static_cast<int>(a))) {
        const double period = scene.domain.upper[a] - scene.domain.lower[a];
        r[a] -= period * std::round((r[a] - place.position[a]) / period);
      }
    }
    if (place.scale > 0 && place.scale * shape.distance(place.start(r)) < reach) return true;
  }
  return false;
}

}  // namespace

void check_released_gas(const Draft& draft, const Scene& scene, Problems& problems) {
  const OxygenOptions& options = draft.options.get<OxygenOptions>();
  if (!options.on || options.bubble_coefficient == oxygen::Coefficient::none) return;
  const double reach = support_ratio(draft.options.resolution) * scene.spacing;
  for (const BodyMotion& motion : scene.motions) {
    if (!motion.release || motion.release->copy > 0) continue;
    const std::size_t k = motion.bodies.front();
    const Node* node = draft.node("body." + std::to_string(k) + ".release_interval");
    const Release& release = *motion.release;
    bool meets = false;
    for (int n = 0; n < places_on_way && !meets; ++n) {
      const double age = (n + 0.5) / places_on_way * release.duration;
      meets = meets_liquid(scene, *scene.bodies[k].alone, given_place(motion, release.first + age), reach);
    }
    if (meets || node == nullptr) continue;
    problems.add_key(*node, "the body '" + scene.bodies[k].name +
                                "' is released as a bubble of gas, and nowhere on its way is liquid within the kernel "
                                "support " +
                                brief(reach) +
                                " of it; set its position below the surface, or "
                                "oxygen.bubble_coefficient = \"none\"");
  }
}

}  // namespace spume
