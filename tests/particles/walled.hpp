// SPDX-License-Identifier: MIT
// A scene with walls of bodies, as the tests of what stands on them take it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

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

inline const std::string square =
    "lower = [-1, -1]\nupper = [1, 1]\nleft = \"open\"\nright = \"open\"\nbottom = \"open\"\n";
inline const std::string disc = "[[body]]\nshape = \"cylinder\"\nradius = 0.4\nposition = [0.03, -0.02]\n";
inline const std::string pipe =
    "[[body]]\nshape = \"cylinder\"\nradius = 0.8\ninside = false\nwall = \"no-slip\"\nvelocity = [\"-y\", \"x\"]\n";
inline const std::string turned = "[[body]]\nshape = \"box\"\nsize = [0.9, 0.7]\nrotation = [30]\nwall = \"no-slip\"\n";
inline const std::string channel =
    "lower = [-1, -1]\nupper = [1, 1]\nx = \"periodic\"\nbottom = \"no-slip\"\ntop = \"free-slip\"\n";
inline const std::string cube =
    "lower = [-0.6, -0.6, -0.6]\nupper = [0.6, 0.6, 0.6]\nx = \"periodic\"\ny = \"periodic\"\nbottom = \"no-slip\"\n";
inline const std::string ball =
    "[[body]]\nshape = \"ball\"\nradius = 0.3\nposition = [0.4, 0.05, 0.02]\nwall = \"no-slip\"\n";

inline reference::Carried smooth(const Vec3& r) {
  return {std::sin(3 * r[0]) + r[1] * r[1] + r[2],
          {std::cos(2 * r[1]) + r[2], r[0] * r[1] - 0.3, r[0] * r[0] + 0.4 * r[2]}};
}

inline std::vector<Layout> wall_layouts() {
  return {{"disc", scene_text(square, 0.05, disc)},
          {"pipe", scene_text(square, 0.05, pipe)},
          {"ring", scene_text(square, 0.05, disc + pipe)},
          {"box, turned, in a periodic channel", scene_text(channel, 0.05, turned)},
          {"disc through the floor of a channel",
           scene_text(channel, 0.05, "[[body]]\nshape = \"cylinder\"\nradius = 0.5\nposition = [0.92, -1]\n")},
          {"ball across a periodic side", scene_text(cube, 0.1, ball)}};
}

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
  // Those that take part, and what they carry as walls hold liquid back along their normals, and with friction.
  struct WetPoints {
    std::vector<WallPoint> points;
    std::array<std::vector<reference::Carried>, 2> carried;
  };
  WetPoints wet_points(const reference::WallSums& twin) const {
    WetPoints found;
    const WallPointView wet = boundary.bodies()->wet();
    const std::vector<WallPoint> all = make_wall_points(scene().walls, scene().domain, resolution, particles.volume);
    for (std::size_t g = 0; g < wet.size; ++g) {
      Vec3 place{};
      for (int axis = 0; axis < particles.dimensions; ++axis) place[axis] = wet.position[axis][g];
      const WallPoint& point =
          *std::find_if(all.begin(), all.end(), [&](const WallPoint& p) { return p.position == place; });
      const Body* nearest = nullptr;
      for (const Body& body : scene().bodies)
        if (nearest == nullptr ||
            std::abs(body.solid->distance(point.foot)) < std::abs(nearest->solid->distance(point.foot)))
          nearest = &body;
      found.points.push_back(point);
      for (const bool friction : {false, true}) found.carried[friction].push_back(twin.at(point, *nearest, friction));
    }
    return found;
  }
};

}  // namespace spume::test
