// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/entrainment.hpp"

#include "spume/core/random.hpp"

namespace spume::bubbles {

EntrainmentBudget entrainment_budget(const EntrainmentModel& model, const EntrainingParticle& particle, double dt) {
  EntrainmentBudget budget;
  if (!(particle.dissipation > model.threshold) || !(particle.volume_fraction > 2.0 / 3)) return budget;
  budget.energy =
      model.constant * model.density_ratio * particle.volume_fraction * particle.dissipation * particle.volume * dt;
  budget.volume = (1.5 - 1 / particle.volume_fraction) / particle.kernel_peak;
  return budget;
}

double surface_energy(const EntrainmentModel& model, double radius) {
  return 4 * std::numbers::pi * radius * radius * model.tension;
}

void entrain(const EntrainmentModel& model, const EntrainingParticle& particle, double dt, std::uint32_t step,
             std::vector<NewBubble>& made) {
  EntrainmentBudget left = entrainment_budget(model, particle, dt);
  const auto random = [&](std::uint32_t draw) {
    return random_uniform(model.seed, RandomPurpose::bubble_entrainment,
                          static_cast<std::uint64_t>(particle.identifier), step, draw);
  };
  int tried = 0, created = 0;
  while (left.energy > 0 && left.volume > 0 && created < 10 && tried < created + 5) {
    const auto u = random(static_cast<std::uint32_t>(2 * tried));
    ++tried;
    const double radius = model.smallest_radius + u[0] * (model.largest_radius - model.smallest_radius);
    const double energy = surface_energy(model, radius), volume = volume_of(radius);
    if (left.energy < u[1] * energy || left.volume < u[2] * volume) continue;
    const auto place = random(static_cast<std::uint32_t>(2 * tried - 1));
    NewBubble bubble;
    for (std::size_t a = 0; a < 3; ++a) {
      bubble.position[a] = particle.position[a] + (place[a] - 0.5) * model.spacing;
      bubble.velocity[a] = particle.velocity[a];
    }
    bubble.volume = volume;
    made.push_back(bubble);
    ++created;
    left.energy -= energy;
    left.volume -= volume;
  }
}

}  // namespace spume::bubbles
