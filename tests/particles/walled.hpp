// SPDX-License-Identifier: MIT
// A scene with walls of bodies, as the tests of what stands on them take it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "neighbours/neighbourhood.hpp"
#include "reference/wall_sums.hpp"
#include "scene/helpers.hpp"
#include "spume/particles/boundary.hpp"

namespace spume::test {

inline std::string scene_text(const std::string& domain, double spacing, const std::string& bodies,
                              const std::string& liquid = "") {
  return "method = \"les-sph\"\n[time]\nend = 1\n[domain]\n" + domain +
         "[resolution]\nspacing = " + std::to_string(spacing) + "\n[fluid]\nreynolds = 100\n[[liquid]]\n" + liquid +
         bodies;
}

struct Layout {
  const char* name;
  std::string text;
};

// A scene with its particles jittered, in cell order, with images and lists.
struct Walled {
  LoadedCase loaded;
  Resolution resolution;
  ParticleStore particles;
  Boundary boundary;
  Arrangement arrangement;

  explicit Walled(const std::string& text, double jitter = 0.2)
      : loaded(load_text(text)),
        resolution(scene().domain.dimensions, scene().spacing, KernelKind::wendland_c2, 1.3),
        particles(scene().domain.dimensions, scene().particles),
        boundary(scene().domain, scene().spacing, std::make_unique<BodyWalls>(scene(), resolution, particles.volume)),
        arrangement(scene().domain, resolution, particles.volume, particles.size()) {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      Vec3 r = vector_at(particles.position, particles.dimensions, i);
      for (int axis = 0; axis < particles.dimensions; ++axis)
        r[axis] += jitter * scene().spacing * (uniform(i, 3)[static_cast<std::size_t>(axis)] - 0.5);
      boundary.apply_walls(boundary.walls, r, nullptr);
      for (int axis = 0; axis < particles.dimensions; ++axis) (*particles.position[axis])[i] = r[axis];
    }
    arrangement.sort(particles, particles.position);
    boundary.make_images(arrangement, particles, particles.position, 1, {});
    arrangement.find_neighbours(particles, particles.position, {});
  }
  const Scene& scene() const { return loaded.scene; }
  Vec3 place(std::size_t i) const { return vector_at(particles.position, particles.dimensions, i); }
  reference::WallSums twin(const std::function<reference::Carried(const Vec3&)>& value) const {
    reference::WallSums sums{scene(), resolution.smoothing_length, resolution.support_radius, particles.volume, {}, {}};
    for (std::size_t i = 0; i < particles.size(); ++i) {
      sums.particle.push_back(place(i));
      sums.value.push_back(value(place(i)));
    }
    return sums;
  }
};

}  // namespace spume::test
