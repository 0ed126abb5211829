// SPDX-License-Identifier: MIT
// Bubbles that enter by spargers and as clouds.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "spume/physics/bubbles/options.hpp"
#include "spume/physics/bubbles/population.hpp"
#include "spume/scene/expression.hpp"

namespace spume::bubbles {

// Radius number `count` of source `source`: a pure function of its arguments.
double draw_radius(const BubbleSizes& sizes, std::uint64_t seed, std::uint64_t source, std::uint64_t count);

// Progress of the sources, part of the state of a run.
struct SourceState {
  std::vector<double> pending_volume;   // per sparger: gas released but not yet enough for the next bubble
  std::vector<std::int64_t> emitted;    // per sparger
  std::vector<std::int64_t> cloud_out;  // per cloud: 1 when it has appeared
};

// Number of bubbles and volume that a step adds.
struct Released {
  std::size_t bubbles = 0;
  double volume = 0;
};

class Sources {
 public:
  // `given` outlives it.
  Sources(const BubbleSources& given, std::uint64_t seed);
  SourceState state;
  // Clouds have no bubble at places for which `solid` is true.
  void keep_clouds_out(std::function<bool(const Vec3&)> solid) { solid_ = std::move(solid); }

  // What enters in (t, t + dt]: the rate at the middle of the step, in whole bubbles; the rest waits. A bubble bigger
  // than what is pending waits too, so that the volume never runs ahead of the rate.
  Released release(Population& population, double t, double dt);
  // Calls add(place, rate) for every sparger with its gas volume per time.
  template <class Add>
  void for_rates(double t, Add&& add) const {
    for (const Sparger& sparger : given_.spargers) add(sparger.position, std::max(0.0, (*sparger.rate)(0, 0, 0, t)));
  }
  // Clouds due at time t.
  Released place_clouds(Population& population, double t);

 private:
  const BubbleSources& given_;
  const std::uint64_t seed_;
  std::function<bool(const Vec3&)> solid_;  // empty: nowhere
};

}  // namespace spume::bubbles
