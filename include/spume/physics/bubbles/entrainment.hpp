// SPDX-License-Identifier: MIT
// Entrainment at one surface particle of the liquid (King et al. 2022, section 3.4.1): dissipation pays for the
// surface of new bubbles, as long as the liquid does not become too light.
#pragma once

#include <vector>

#include "spume/physics/bubbles/options.hpp"
#include "spume/physics/bubbles/population.hpp"
#include "spume/scene/scene.hpp"

namespace spume::bubbles {

struct EntrainmentModel {
  double constant = BubbleOptions{}.entrainment_constant;    // C_eps
  double threshold = BubbleOptions{}.entrainment_threshold;  // least dissipation
  double density_ratio = 0;
  double tension = 0;  // over the density of the liquid
  double smallest_radius = 0, largest_radius = 0;
  double spacing = 0;
  std::uint64_t seed = 1;
  EntrainmentOverdraft overdraft = BubbleOptions{}.entrainment_overdraft;
};

struct EntrainingParticle {
  Vec3 position{}, velocity{};
  double dissipation = 0;      // unresolved part, Shepard-smoothed
  double volume_fraction = 1;  // alpha
  double volume = 0;           // V_i, bubbles included
  double kernel_peak = 0;      // W(0)
  std::int64_t identifier = 0;
};

struct EntrainmentBudget {
  double energy = 0;  // over the density of the liquid, King (3.19) as printed: a calibration, not a share of energy
  double volume = 0;  // King (3.21): what takes alpha to 2/3 by (3.1)
};
EntrainmentBudget entrainment_budget(const EntrainmentModel& model, const EntrainingParticle& particle, double dt);
// King (3.20) over the density of the liquid: 4 pi a^2 tension.
double surface_energy(const EntrainmentModel& model, double radius);

// Appends the bubbles that the particle entrains in a step. King buys them once in a step of (3.18), and the length of
// that step decides which radius the energy pays: here each purchase has the budget of one `period`, whatever dt is,
// and there are dt / period of them (a part of one: as its probability), so that neither number nor sizes follow the
// step of the run. A bubble that costs more than what is left is made with the probability left/cost (or, as
// printed, 1 - left/cost, which favours the least affordable), so that only the last bubble of a
// purchase overdraws its budget. As up to five radii are tried for each bubble, a budget that pays for less than one
// bubble buys more than its mean: 2.3 times its energy where eps = 0.4 in a wave at 1/100, 1.3 times at eps = 2.
// Offsets are zeta - 1/2 spacings.
void entrain(const EntrainmentModel& model, const EntrainingParticle& particle, double dt, double period,
             std::uint32_t step, std::vector<NewBubble>& made);

}  // namespace spume::bubbles
