// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "spume/methods/les_sph/flow.hpp"
#include "spume/methods/stage.hpp"

namespace spume::les_sph {

// The stages of a flow. The flow outlives the plan.
Plan make_plan(Flow& flow);

// Why a stage runs in this scene, or why it does not.
struct Reasons {
  Reasons(const LoadedCase& loaded, const Features& has, bool force_has_potential);
  std::string openings, impulse, advection, bubbles, images, surface, shift, gradients, curvature, closure, integrator,
      forces, viscosity, sponges, divergence, centring, relaxation, preconditioner, factorisation, pressure, events,
      level, balance, packing, oxygen, ripples, bends, absorption;
};

}  // namespace spume::les_sph
