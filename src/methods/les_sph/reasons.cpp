// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/step.hpp"
#include "spume/scene/document.hpp"

namespace spume::les_sph {
namespace {

const char* closure_name(TurbulenceModel model) {
  switch (model) {
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
}

std::string events_of(const LoadedCase& loaded) {
  const BubbleOptions& gas = loaded.options.get<BubbleOptions>();
  std::string events;
  const auto event = [&](bool on, const char* name) {
    if (on) events.append(events.empty() ? "" : ", ").append(name);
  };
  event(gas.entrainment, "entrainment");
  event(gas.breakup, "breakup");
  event(!loaded.options.get<BubbleSources>().spargers.empty(), "spargers");
  event(!loaded.options.get<BubbleSources>().clouds.empty(), "clouds");
  event(gas.surface_interaction && loaded.scene.free_surface, "bursting");
  return events;
}

}  // namespace

Reasons::Reasons(const LoadedCase& loaded, const Features& has, bool force_has_potential) {
  const Case& options = loaded.options;
  const std::string no_bubbles = "no section [bubbles]";
  bubbles = has.bubbles ? "positions, volume fraction, sizes of particles" : no_bubbles;
  integrator = !has.bubbles                                                          ? no_bubbles
               : options.get<BubbleOptions>().integrator == BubbleIntegrator::stable ? "stable integrator"
                                                                                     : "explicit sub-steps";
  events = has.bubbles ? events_of(loaded) : no_bubbles;
  oxygen = has.bubbles ? "transfer from bubbles and through the surface" : oxygen::in_words(loaded.scene);
  images = has.images ? has.openings ? "sides, solids, points behind openings" : "periodic sides, walls or solids"
                      : "every side is open";
  surface = has.free_surface ? "the liquid has a free surface" : "the liquid fills the domain";
  ripples = !has.free_surface ? "the liquid fills the domain"
            : has.potential   ? "the surface is pressed where it will be"
                              : "no gravity, no body force";
  openings = has.openings ? "particles enter and leave" : "no inflow, no outflow";
  absorption = has.absorbing_walls ? "the elevation at walls that take up waves" : "no wavemaker absorbs";
  impulse = has.openings ? "the liquid moves with what enters" : "no inflow, no outflow";
  const bool lattice = loaded.scene.domain.boxes.empty() && !has.bodies;
  level = !has.free_surface ? "the liquid fills the domain"
          : lattice         ? "no solids: columns are those of the lattice"
                            : "columns beside solids and bodies end on the surface";
  balance = has.starts_at_rest ? "liquid at rest beside solids is in equilibrium as it stands"
                               : "no liquid at rest beside solid boxes, or bubbles";
  packing = has.bodies ? "particles beside bodies evened out"
            : lattice  ? "no solids, no walls of bodies"
                       : "where cells between solids are of other sizes";
  shift = has.shifting ? "Fickian shifting" : "shifting.on = false";
  gradients = has.eddy_viscosity      ? "strain of the closure"
              : has.bubbles           ? "vorticity at the bubbles"
              : has.shift_correction  ? "velocity correction of the shift"
              : has.velocity_gradient ? "divergence half a step ahead"
                                      : "no stage reads them";
  curvature = has.shift_curvature ? "second-order velocity correction of the shift" : "shifting.velocity_correction";
  closure = closure_name(options.get<TurbulenceOptions>().model);
  forces = !has.potential           ? "neither gravity nor forces.body"
           : !has.body_force        ? "gravity"
           : has.uniform_body_force ? "gravity and forces.body, uniform"
           : force_has_potential    ? "gravity, and forces.body by its potential"
                                    : "gravity; forces.body has no potential";
  viscosity = has.viscous_stress ? "div(2 nu S)" : has.viscosity ? "div(nu grad u)" : "inviscid";
  bends = has.wall_bends       ? "friction of boundary layers that the first rows resolve"
          : !has.viscosity     ? "inviscid"
          : has.eddy_viscosity ? "unresolved at walls: a closure"
          : has.bubbles        ? "unresolved at walls: bubbles"
                               : "no no-slip sides";
  sponges = has.sponges ? "velocity damped in layers beside sides" : "no section [[sponge]]";
  divergence = loaded.scene.fluid.sound_speed > 0 ? "right-hand side of the Helmholtz equation"
                                                  : "right-hand side of the Poisson equation";
  const bool centred = options.get<SchemeOptions>().centred;
  advection = centred ? "velocity half a step ahead" : "time.centred = false: velocity of the step before";
  centring = centred ? "free of divergence half a step ahead" : "time.centred = false";
  relaxation = has.density_relaxation ? "the pressure evens out the number density"
                                      : "pressure.density_relaxation = " + shortest(never_relaxed);
  const bool direct = options.get<PressureOptions>().solver == PressureSolver::direct;
  factorisation = direct ? "UMFPACK" : "the solver is iterative";
  preconditioner = direct ? "the solver is direct"
                   : options.get<PressureOptions>().preconditioner == PreconditionerKind::multigrid
                       ? "Jacobi and a V-cycle on cells"
                       : "pressure.preconditioner = \"jacobi\"";
  pressure = has.closed    ? "closed domain: the constant is removed"
             : has.outflow ? "given pressure at outflows"
                           : "zero pressure at the free surface";
}

}  // namespace spume::les_sph
