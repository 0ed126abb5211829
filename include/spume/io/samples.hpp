// SPDX-License-Identifier: MIT
// What probes record of the fields of a method.
#pragma once

#include <limits>
#include <vector>

#include "spume/core/vec3.hpp"

namespace spume {

// Values of the fields at a point; outside the liquid there are none: not a number.
struct PointSample {
  std::vector<double> scalars;  // those of LoadedCase::probe_scalars, in their order
  Vec3 velocity{};
  double coverage = 0;  // kernel sum at the point: near 1 inside the liquid, 0 in air
};

// Averages over the liquid part of a plane across the domain (in two dimensions a line). Without liquid there is
// nothing to average: not a number.
struct PlaneSample {
  double area = 0;              // of the liquid part; a length in two dimensions
  std::vector<double> scalars;  // as at a point
  Vec3 velocity{nothing, nothing, nothing};

  static constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace spume
