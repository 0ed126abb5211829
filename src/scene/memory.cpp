// SPDX-License-Identifier: MIT
#include "spume/scene/memory.hpp"

#include <numbers>

#include "checks.hpp"

namespace spume {

double bytes_per_particle(const Case& options, int dimensions) {
  if (options.method == "spectral") {
    // Three components of N/2 + 1 complex modes are 3 numbers per point.
    const double number = options.spectral.precision == FieldPrecision::f64 ? 8 : 4;
    const double states = options.spectral.integrator == Integrator::ab2 ? 3 : 4;
    return 3 * number * states;
  }
  if (options.method != "les-sph") return 0;
  const double support_radius = support_ratio(options.resolution);
  const double neighbours =
      std::numbers::pi * support_radius * support_radius * (dimensions == 3 ? 4.0 / 3 * support_radius : 1);
  // `spume check` of 40 000 particles: 119.5 bytes per particle in the lists of 21 neighbours and 306 beside them and
  // the images in two dimensions, 362 in those of 74 and 369 in three.
  return (dimensions == 3 ? 388 : 328) + 4.63 * neighbours;
}

}  // namespace spume
