// SPDX-License-Identifier: MIT
#include "full_tanks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "spume/core/error.hpp"
#include "spume/core/golden_ratio.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/expected_speed.hpp"
#include "spume/particles/surface_pieces.hpp"
#include "spume/scene/document.hpp"

namespace spume::les_sph {
namespace {

// Spacings: a gap that one layer of particles fits in.
constexpr double one_layer = 1;
constexpr double far_too_fast = 10;  // as in particles/energy_guard.cpp
// At walls during a run.
constexpr int looks = 1000;
constexpr const char* leave_a_surface = "end [[liquid]] two spacings below the lid, which leaves a surface";

bool floats_there(const Flow& flow, const Body& body) {
  return body.wall != BoundaryKind::open && body.motion && flow.scene.motions[*body.motion].floats;
}

// Of places of its surface the least way to another wall that is not touched there.
std::optional<double> narrowest_gap(const Flow& flow, const Body& body) {
  std::optional<double> least;
  for (const SurfacePiece& piece : surface_pieces(flow.scene.domain, body, flow.scene.spacing)) {
    const double size = length(piece.area);
    if (!(size > 0)) continue;
    const std::optional<double> gap =
        flow.boundary.bodies()->gap_before(piece.middle, multiply(1 / size, piece.area), flow.boundary.walls);
    if (gap && *gap > 0) least = std::min(*gap, least.value_or(*gap));
  }
  return least;
}

}  // namespace

std::string remark_on_gaps_in_full_tank(const Flow& flow) {
  if (!flow.features.closed || flow.floating == nullptr) return "";
  for (const Body& body : flow.scene.bodies) {
    if (!floats_there(flow, body)) continue;
    const std::optional<double> gap = narrowest_gap(flow, body);
    if (!gap || *gap >= one_layer * flow.scene.spacing) continue;
    return "the body '" + body.name + "' floats in liquid that fills its domain and starts " +
           brief(*gap / flow.scene.spacing) +
           " spacings from a wall, where no particle stands: as it leaves the wall a void opens that has the pressure "
           "around it, and below a flat face the run may fail; " +
           leave_a_surface + ", or start the body two spacings from the wall";
  }
  return "";
}

double speed_of_bodies(const Scene& scene, double end) {
  const Domain& domain = scene.domain;
  const double fall = std::sqrt(2 * length(scene.fluid.gravity) * length(subtract(domain.upper, domain.lower)));
  if (fall == 0) return infinite;
  double fastest = std::max(fall, expected_speed(scene, end));
  const Vec3 middle = multiply(0.5, add(domain.lower, domain.upper));
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (const Side& side : domain.sides[axis])
      for (int n = 0; n < looks && side.velocity; ++n)
        fastest = std::max(fastest, length((*side.velocity)(middle, end * golden_part(n))));
  return fastest;
}

void refuse_runaway_bodies(const Flow& flow) {
  if (flow.floating == nullptr) return;
  const double speed = flow.floating->largest_speed();
  if (speed <= far_too_fast * flow.speed_of_bodies) return;
  StepFailure::Details details;
  details.cause = "a body that floats moves ten times as fast as anything in the scene may drive it";
  if (flow.features.closed) details.cause += ": where it leaves a wall in liquid that fills its domain a void opens";
  details.option = flow.features.closed ? std::string("the scene: ") + leave_a_surface : "resolution.spacing";
  details.value = speed;
  throw StepFailure(details);
}

}  // namespace spume::les_sph
