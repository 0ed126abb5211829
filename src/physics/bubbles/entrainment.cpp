// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/entrainment.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/random.hpp"

namespace spume::bubbles {
namespace {
constexpr double most_rounds = 100;  // of a step far longer than the period: the volume is spent long before
}

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

void entrain(const EntrainmentModel& model, const EntrainingParticle& particle, double dt, double period,
             std::uint32_t step, std::vector<NewBubble>& made) {
  const EntrainmentBudget budget = entrainment_budget(model, particle, period);
  if (!(budget.energy > 0)) return;
  std::uint32_t draw = 0;
  const auto random = [&] {
    return random_uniform(model.seed, RandomPurpose::bubble_entrainment,
                          static_cast<std::uint64_t>(particle.identifier), step, draw++);
  };
  const auto refused = [&](double left, double cost, double u) {
    if (left >= cost) return false;
    return model.overdraft == EntrainmentOverdraft::printed ? left > u * cost : left < u * cost;
  };
  const int rounds = static_cast<int>(std::floor(std::min(dt / period, most_rounds) + random()[0]));
  double volume_left = budget.volume;
  for (int round = 0; round < rounds; ++round) {
    double energy_left = budget.energy;
    int tried = 0, created = 0;
    while (energy_left > 0 && volume_left > 0 && created < 10 && tried < created + 5) {
      const auto u = random();
      ++tried;
      const double radius = model.smallest_radius + u[0] * (model.largest_radius - model.smallest_radius);
      const double energy = surface_energy(model, radius), volume = volume_of(radius);
      if (refused(energy_left, energy, u[1]) || refused(volume_left, volume, u[2])) continue;
      const auto place = random();
      NewBubble bubble;
      for (std::size_t a = 0; a < 3; ++a) {
        bubble.position[a] = particle.position[a] + (place[a] - 0.5) * model.spacing;
        bubble.velocity[a] = particle.velocity[a];
      }
      bubble.volume = volume;
      made.push_back(bubble);
      ++created;
      energy_left -= energy;
      volume_left -= volume;
    }
  }
}

}  // namespace spume::bubbles
