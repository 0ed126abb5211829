// SPDX-License-Identifier: MIT
#include "spume/particles/still_liquid.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/particles/column_pressure.hpp"
#include "spume/particles/phase_law.hpp"
#include "spume/particles/start_at_rest.hpp"

namespace spume {
namespace {

template <class Number>
void subtract_linear(const Vec3& gradient, const Vec3& from_there, const std::array<const double*, 3>& place,
                     std::size_t n, Number* pressure) {
  if (gradient == Vec3{}) return;
  parallel_blocks(n, default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (gradient[axis] == 0) continue;
      const double slope = gradient[axis], from = from_there[axis];
      for (std::size_t i = first; i < last; ++i)
        pressure[i] = static_cast<Number>(pressure[i] - slope * (place[axis][i] - from));
    }
  });
}

}  // namespace

StillLiquid still_liquid(const Scene& scene, bool shifting) {
  const Vec3 gravity = gravity_across_sides(scene);
  if (scene.free_surface || !scene.openings.empty() || gravity == Vec3{}) return {};
  if (scene.phases.size() > 1 ? scene.surface_tension > 0 : !shifting) return {};
  const auto [lightest, heaviest] = std::minmax_element(
      scene.phases.begin(), scene.phases.end(), [](const Phase& a, const Phase& b) { return a.density < b.density; });
  if (lightest->density < gas_density_ratio * heaviest->density) return {};
  StillLiquid still{.density = lightest->density, .gravity = gravity};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    still.highest[axis] = gravity[axis] < 0 ? scene.domain.upper[axis] : scene.domain.lower[axis];
    still.range += (heaviest->density - still.density) * std::abs(gravity[axis]) *
                   (scene.domain.upper[axis] - scene.domain.lower[axis]);
  }
  return still;
}

bool liquids_flow(const Scene& scene, bool driven) {
  const StillLiquid still = still_liquid(scene, false);
  return still && scene.phases.size() > 1 &&
         (driven || still.range == 0 || starts_moving(scene) || !lie_in_layers(scene));
}

void StillLiquid::subtract(const std::array<const double*, 3>& place, std::size_t n, float* pressure) const {
  subtract_linear(pressure_gradient(), highest, place, n, pressure);
}

void StillLiquid::subtract(const std::array<const double*, 3>& place, std::size_t n, double* pressure) const {
  subtract_linear(pressure_gradient(), highest, place, n, pressure);
}

}  // namespace spume
