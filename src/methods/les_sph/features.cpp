// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/features.hpp"

#include <algorithm>

#include "spume/particles/wall_bends.hpp"
#include "spume/physics/bubbles/options.hpp"

namespace spume::les_sph {
namespace {

// Whether a vector expression has the same value everywhere: sampled at points that share no coordinate.
bool uniform(const VectorExpression& expression, const Domain& domain) {
  for (const double t : {0.0, 0.37, 1.9}) {
    const Vec3 first = expression(domain.lower, t);
    for (int k = 1; k <= 7; ++k) {
      Vec3 r{};
      for (int axis = 0; axis < 3; ++axis) {
        const double fraction = 0.0917 + 0.1287 * ((k * (axis + 2)) % 7);
        r[axis] = domain.lower[axis] + fraction * (domain.upper[axis] - domain.lower[axis]);
      }
      if (expression(r, t) != first) return false;
    }
  }
  return true;
}

bool corrects_shift(const Case& options) {
  const ShiftingOptions& shifting = options.get<ShiftingOptions>();
  return shifting.on && shifting.velocity_correction != ShiftCorrection::none;
}

}  // namespace

bool has_closure(const Case& options) {
  return options.get<TurbulenceOptions>().model != TurbulenceModel::none;
}

bool has_bubbles(const Case& options) {
  return options.get<BubbleOptions>().on;
}

bool needs_velocity_gradient(const Case& options) {
  return has_closure(options) || corrects_shift(options) || options.get<SchemeOptions>().centred ||
         has_bubbles(options);
}

Features::Features(const LoadedCase& loaded)
    : BoundaryFeatures(loaded.scene.domain, loaded.scene.bodies, loaded.scene.openings),
      SoluteFeatures(loaded.options) {
  const Scene& scene = loaded.scene;
  const Case& options = loaded.options;
  free_surface = scene.free_surface;
  sponges = !scene.sponges.empty();
  closed = !scene.free_surface && !outflow;
  moves_in_full_tank = closed && std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                             [](const Body& body) { return body.motion && body.inside; });
  shifting = options.get<ShiftingOptions>().on;
  removes_drift = shifting && options.get<ShiftingOptions>().remove_drift && !moves_in_full_tank;
  shift_correction = corrects_shift(options);
  shift_curvature = shifting && options.get<ShiftingOptions>().velocity_correction == ShiftCorrection::second_order;
  const TurbulenceModel model = options.get<TurbulenceOptions>().model;
  const bool dynamic = model == TurbulenceModel::dynamic_shepard || model == TurbulenceModel::dynamic_lagrangian;
  eddy_viscosity = has_closure(options);
  bubbles = has_bubbles(options);
  test_filter = (eddy_viscosity && model != TurbulenceModel::smagorinsky) ||
                (bubbles && options.get<BubbleOptions>().fluctuations);
  velocity_gradient = needs_velocity_gradient(options);
  stored_gradient = dynamic || shift_curvature || bubbles;
  density_relaxation = options.get<PressureOptions>().density_relaxation < never_relaxed;
  viscosity = eddy_viscosity || scene.fluid.kinematic_viscosity > 0;
  const DiffusionForm form = options.get<TurbulenceOptions>().diffusion;
  viscous_stress =
      viscosity && (form == DiffusionForm::stress || (form == DiffusionForm::automatic && scene.free_surface));
  no_slip_bodies = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                               [](const Body& body) { return body.wall == BoundaryKind::no_slip; });
  wall_bends = has_no_slip_sides(scene.domain) && viscosity && !eddy_viscosity && !bubbles;
  held_by_bodies = no_slip_bodies && viscosity && !eddy_viscosity && !bubbles;
  body_force = scene.body_force.has_value();
  uniform_body_force = body_force && uniform(*scene.body_force, scene.domain);
  const Vec3& gravity = scene.fluid.gravity;
  working_forces = body_force;
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    working_forces = working_forces || (scene.domain.periodic(axis) && gravity[axis] != 0);
  potential = body_force || std::any_of(gravity.begin(), gravity.end(), [](double g) { return g != 0; });
  // Bubbles rearrange the liquid without moving it far.
  const auto up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  starts_at_rest = free_surface && !scene.domain.boxes.empty() && !body_force && !bubbles && gravity[up] < 0 &&
                   std::count(gravity.begin(), gravity.end(), 0.0) == 2;
}

}  // namespace spume::les_sph
