// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/sources.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/random.hpp"
#include "spume/scene/scene.hpp"

namespace spume::bubbles {
namespace {

// Clouds are numbered after every possible sparger.
constexpr std::uint64_t first_cloud = 1U << 20;
constexpr std::uint32_t place_draw = 1U << 20;  // radii take the draws below
constexpr std::uint32_t most_draws = 10'000;    // of a cloud with a ten thousandth outside solids

std::uint64_t stream(std::uint64_t source, std::uint64_t count) {
  return source << 40 | count;
}

Vec3 place_on(const Sparger& sparger, std::uint64_t seed, std::uint64_t source, std::uint64_t count) {
  const auto u = random_uniform(seed, RandomPurpose::bubble_source, stream(source, count), 0, place_draw);
  Vec3 r = sparger.position;
  if (sparger.shape == SpargerShape::disc) {
    const double distance = sparger.radius * std::sqrt(u[0]), angle = 2 * std::numbers::pi * u[1];
    r[0] += distance * std::cos(angle);
    r[1] += distance * std::sin(angle);
  } else if (sparger.shape == SpargerShape::line) {
    for (std::size_t a = 0; a < 3; ++a) r[a] += u[0] * (sparger.end[a] - sparger.position[a]);
  }
  return r;
}

// Places in solids are drawn again; a cloud that is all solid, which a moving body can make of it, keeps the last.
Vec3 place_in(const BubbleCloud& cloud, std::uint64_t seed, std::uint64_t source, std::uint64_t count,
              const std::function<bool(const Vec3&)>& solid) {
  const auto refused = [&](const Vec3& r, std::uint32_t draw) {
    return solid && draw < place_draw + most_draws && solid(r);
  };
  for (std::uint32_t draw = place_draw;; ++draw) {
    const auto u = random_uniform(seed, RandomPurpose::bubble_source, stream(source, count), 0, draw);
    Vec3 r;
    if (!cloud.ball) {
      for (std::size_t a = 0; a < 3; ++a) r[a] = cloud.lower[a] + u[a] * (cloud.upper[a] - cloud.lower[a]);
      if (refused(r, draw)) continue;
      return r;
    }
    double distance2 = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      r[a] = cloud.centre[a] + cloud.radius * (2 * u[a] - 1);
      distance2 += (2 * u[a] - 1) * (2 * u[a] - 1);
    }
    if (distance2 <= 1 && !refused(r, draw)) return r;
  }
}

}  // namespace

double draw_radius(const BubbleSizes& sizes, std::uint64_t seed, std::uint64_t source, std::uint64_t count) {
  if (sizes.law == SizeLaw::monodisperse) return sizes.mean;
  // The part of the law that is cut off is drawn again.
  for (std::uint32_t draw = 0; draw < place_draw; ++draw) {
    for (const double z : random_normal(seed, RandomPurpose::bubble_source, stream(source, count), 0, draw)) {
      const double radius = sizes.law == SizeLaw::truncated_gaussian ? sizes.mean + sizes.deviation * z
                                                                     : sizes.mean * std::exp(sizes.deviation * z);
      if (radius >= sizes.minimum && radius <= sizes.maximum) return radius;
    }
  }
  return sizes.mean;
}

Sources::Sources(const BubbleSources& given, std::uint64_t seed) : given_(given), seed_(seed) {
  state.pending_volume.assign(given.spargers.size(), 0.0);
  state.emitted.assign(given.spargers.size(), 0);
  state.cloud_out.assign(given.clouds.size(), 0);
}

Released Sources::release(Population& population, double t, double dt) {
  Released released;
  for (std::size_t k = 0; k < given_.spargers.size(); ++k) {
    const Sparger& sparger = given_.spargers[k];
    double& pending = state.pending_volume[k];
    pending += dt * std::max(0.0, (*sparger.rate)(0, 0, 0, t + 0.5 * dt));
    released.bubbles += population.give_birth(1, t + dt, [&](std::size_t, std::vector<NewBubble>& made) {
      for (;;) {
        const auto count = static_cast<std::uint64_t>(state.emitted[k]);
        const double volume = volume_of(draw_radius(sparger.sizes, seed_, k, count));
        if (pending < volume) break;
        NewBubble bubble;
        bubble.position = place_on(sparger, seed_, k, count);
        bubble.volume = volume;
        bubble.at_rest_in_liquid = true;
        made.push_back(bubble);
        pending -= volume;
        released.volume += volume;
        ++state.emitted[k];
      }
    });
  }
  return released;
}

Released Sources::place_clouds(Population& population, double t) {
  Released released;
  for (std::size_t k = 0; k < given_.clouds.size(); ++k) {
    const BubbleCloud& cloud = given_.clouds[k];
    if (state.cloud_out[k] != 0 || t < cloud.time) continue;
    state.cloud_out[k] = 1;
    const std::size_t before = population.size();
    released.bubbles += population.give_birth(
        static_cast<std::size_t>(cloud.number), t, [&](std::size_t item, std::vector<NewBubble>& made) {
          NewBubble bubble;
          bubble.position = place_in(cloud, seed_, first_cloud + k, item, solid_);
          bubble.volume = volume_of(draw_radius(cloud.sizes, seed_, first_cloud + k, item));
          bubble.at_rest_in_liquid = true;
          made.push_back(bubble);
        });
    released.volume +=
        parallel_sum(population.size() - before, [&](std::size_t b) { return (*population.volume)[before + b]; });
  }
  return released;
}

}  // namespace spume::bubbles
