// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/plan.hpp"

#include <algorithm>
#include <string>

namespace spume::les_sph {

Plan make_plan(const LoadedCase& loaded) {
  const Scene& scene = loaded.scene;
  const Case& options = loaded.options;
  Plan plan;
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    for (const Side& side : scene.domain.sides[axis]) {
      plan.images = plan.images || side.kind != BoundaryKind::open;
      plan.no_slip = plan.no_slip || side.kind == BoundaryKind::no_slip;
      if (!side.velocity) continue;
      plan.moving_walls = true;
      plan.displaced_walls = plan.displaced_walls || side.velocity->component[axis] != nullptr;
    }
  plan.images = plan.images || !scene.domain.boxes.empty();
  for (const SolidBox& box : scene.domain.boxes) plan.no_slip = plan.no_slip || box.kind == BoundaryKind::no_slip;
  plan.free_surface = scene.free_surface;
  plan.shifting = options.get<ShiftingOptions>().on;
  const TurbulenceModel model = options.get<TurbulenceOptions>().model;
  plan.eddy_viscosity = model != TurbulenceModel::none;
  plan.test_filter = plan.eddy_viscosity && model != TurbulenceModel::smagorinsky;
  plan.bubbles = options.get<BubbleOptions>().on;
  plan.mixture_pressure = plan.bubbles && options.get<BubbleOptions>().momentum_form == MomentumForm::mixture_pressure;
  plan.test_filter = plan.test_filter || (plan.bubbles && options.get<BubbleOptions>().fluctuations);
  plan.drift_removal = plan.shifting && options.get<ShiftingOptions>().remove_drift;
  plan.density_relaxation = options.get<PressureOptions>().density_relaxation < never_relaxed;
  plan.shift_correction = plan.shifting && options.get<ShiftingOptions>().velocity_correction != ShiftCorrection::none;
  plan.shift_curvature =
      plan.shifting && options.get<ShiftingOptions>().velocity_correction == ShiftCorrection::second_order;
  plan.velocity_gradient =
      plan.eddy_viscosity || plan.shift_correction || options.get<SchemeOptions>().centred || plan.bubbles;
  const bool dynamic = model == TurbulenceModel::dynamic_shepard || model == TurbulenceModel::dynamic_lagrangian;
  plan.stored_gradient = dynamic || plan.shift_curvature || plan.bubbles;
  plan.viscosity = plan.eddy_viscosity || scene.fluid.kinematic_viscosity > 0;
  const DiffusionForm form = options.get<TurbulenceOptions>().diffusion;
  plan.viscous_stress =
      plan.viscosity && (form == DiffusionForm::stress || (form == DiffusionForm::automatic && scene.free_surface));
  plan.gravity = std::any_of(scene.fluid.gravity.begin(), scene.fluid.gravity.end(), [](double g) { return g != 0; });
  plan.body_force = scene.body_force.has_value();
  plan.compressible = scene.fluid.sound_speed > 0;
  plan.closed = !scene.free_surface;
  return plan;
}

std::vector<Stage> Plan::stages(const LoadedCase& loaded) const {
  const auto model = [&] {
    switch (loaded.options.get<TurbulenceOptions>().model) {
      case TurbulenceModel::mixed_scale:
        return "mixed-scale closure";
      case TurbulenceModel::smagorinsky:
        return "Smagorinsky closure";
      case TurbulenceModel::dynamic_shepard:
        return "dynamic closure, Shepard averages";
      case TurbulenceModel::dynamic_lagrangian:
        return "dynamic closure, Lagrangian averages";
      case TurbulenceModel::none:
        break;
    }
    return "no closure: turbulence.model = \"none\"";
  };
  std::vector<Stage> list;
  const auto add = [&list](std::string name, bool on, std::string reason) {
    list.push_back({.name = std::move(name), .reason = std::move(reason), .on = on});
  };
  add("move", true, "particles to their intermediate positions");
  add("sort", true, "particles in cell order");
  add("images", images, images ? "periodic sides, walls or solids" : "every side is open");
  const BubbleOptions& gas = loaded.options.get<BubbleOptions>();
  add("bubble volume", bubbles, bubbles ? "volume fraction and sizes of particles" : "no section [bubbles]");
  add("neighbours", true, "lists within the kernel support");
  add("geometry", true, "gradient correction, div r, concentration");
  add("surface", free_surface, free_surface ? "the liquid has a free surface" : "the liquid fills the domain");
  add("shift", shifting, shifting ? "Fickian shifting" : "shifting.on = false");
  add("gradients", velocity_gradient,
      eddy_viscosity      ? "strain of the closure"
      : bubbles           ? "vorticity at the bubbles"
      : shift_correction  ? "velocity correction of the shift"
      : velocity_gradient ? "divergence half a step ahead"
                          : "nobody needs them");
  add("shift curvature", shift_curvature,
      shift_curvature ? "second-order velocity correction of the shift" : "shifting.velocity_correction");
  add("eddy viscosity", eddy_viscosity, model());
  add("bubble forces", bubbles,
      !bubbles                                     ? "no section [bubbles]"
      : gas.integrator == BubbleIntegrator::stable ? "stable integrator"
                                                   : "explicit sub-steps");
  add("viscosity", viscosity, viscous_stress ? "div(2 nu S)" : viscosity ? "div(nu grad u)" : "inviscid");
  add("body force", body_force, body_force ? "forces.body" : "none given");
  add("divergence", true,
      compressible ? "right-hand side of the Helmholtz equation" : "right-hand side of the Poisson equation");
  add("density relaxation", density_relaxation,
      density_relaxation ? "the pressure evens out the number density" : "pressure.density_relaxation = 1e6");
  add("pressure", true, closed ? "closed domain: the constant is removed" : "zero pressure at the free surface");
  add("project", true, "pressure gradient and final positions");
  std::string events;
  const auto event = [&](bool on, const char* name) {
    if (on) events += (events.empty() ? "" : ", ") + std::string(name);
  };
  event(gas.entrainment, "entrainment");
  event(gas.breakup, "breakup");
  event(!loaded.scene.spargers.empty(), "spargers");
  event(!loaded.scene.bubble_clouds.empty(), "clouds");
  event(gas.surface_interaction && free_surface, "bursting");
  add("bubble events", bubbles, bubbles ? events : "no section [bubbles]");
  return list;
}

}  // namespace spume::les_sph
