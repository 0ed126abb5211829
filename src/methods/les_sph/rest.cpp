// SPDX-License-Identifier: MIT
// Liquid that starts at rest beside solid boxes, in equilibrium as it stands.
//
// The hydrostatic pressure is part of q exactly, so all that can move liquid at rest is the surface rule, which finds
// p = 0 at other heights over particles that stand in other ways: over films of no whole number of layers by 0.4
// spacings, in gaps, where particles lack neighbours below solids, by the whole depth. What the rule errs by at the
// start is known where the surface is level, and is taken back as long as a particle stands as it did: `lift`, in
// spacings of height, for q to be one constant. It fades, linearly, over a spacing of the particle's way; what is in
// motion is as it would be without. So do shift and density relaxation come in, which would feed on what stands
// unevenly: both are in proportion to the speed, so that rounding grew by e in 0.07 s. Of 60 tanks with one to three
// boxes of random size and place 14 moved by more than 1e-3 sqrt(g H) without this, at 0.004 to 1; two do with it.
//
// A region is at rest if it has no velocity and if its particles that take themselves for a surface stand at its level
// or before a solid: the free side of a column that is to collapse does neither.
#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/methods/les_sph/flow.hpp"

namespace spume::les_sph {
namespace {

// Those that lie in the liquid leave the surface rule, and with them go depths that others shared.
constexpr int most_balancing_rounds = 5;

}  // namespace

void Flow::balance_rest() {
  const int up = dimensions - 1;
  std::vector<std::uint8_t> at_rest(start_columns->regions, 1);
  const auto region_of = [&](std::size_t i) {
    return static_cast<std::size_t>(start_columns->region[static_cast<std::size_t>((*particles.identifier)[i])]);
  };
  for (std::size_t i = 0; i < size(); ++i)
    if (squared_norm(particles.velocity, dimensions, i) != 0) at_rest[region_of(i)] = 0;
  // A surface particle may see no more than half the support radius to a solid; those inside lack what they lack.
  const auto stands_free = [&](std::size_t i) {
    return surface->at_surface[i] != 0 &&
           !boundary.obstacle_near(vector_at(intermediate_position, dimensions, i), 0.5 * resolution.support_radius);
  };
  bool again = true;
  for (int round = 0; again && round < most_balancing_rounds; ++round) {
    again = false;
    const auto take_back = [&](std::size_t i, double height) {
      const std::size_t region = region_of(i);
      if (at_rest[region] == 0) return;
      const double error = start_columns->level[region] - height;
      (*rest.lift)[i] = static_cast<float>(error);
      if (!std::isfinite(error) || (surface->is_covered(i) && stands_free(i))) at_rest[region] = 0;
      again = again || surface->is_covered(i);
    };
    for (std::size_t k = 0; k < surface->near_surface.size(); ++k) {
      const auto i = static_cast<std::size_t>(surface->near_surface[k]);
      const double upwards = (*moments.normal[up])[i], normal = std::sqrt(squared_norm(moments.normal, dimensions, i));
      const double height = (*intermediate_position[up])[i];
      take_back(i, normal > 0 ? height + surface->depth[k] * upwards / normal : height);
    }
    for (std::size_t i = 0; i < size(); ++i)
      if (surface->pressure_fixed[i] != 0) take_back(i, (*intermediate_position[up])[i]);
    parallel_for(size(), [&](std::size_t i) {
      if (at_rest[region_of(i)] == 0) (*rest.lift)[i] = 0;
    });
    if (again) find_surface();
  }
  parallel_for(size(), [&](std::size_t i) { (*rest.share)[i] = at_rest[region_of(i)] != 0 ? 1.0F : 0.0F; });
  start_columns.reset();
}

void Flow::forget_rest(std::size_t i, double way) {
  const float share = (*rest.share)[i];
  if (share == 0) return;
  const float left = std::max(0.0F, share - static_cast<float>(way / resolution.spacing));
  (*rest.lift)[i] *= left / share;
  (*rest.share)[i] = left;
}

}  // namespace spume::les_sph
