// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/entrainment.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/random.hpp"

namespace spume::bubbles {
namespace {
// Rounds of a step far longer than the period. A bubble takes volume from what all rounds share: the volume is spent
// long before.
constexpr double most_rounds = 100;
// King (3.23c) and (3.23d): bubbles of a round, and tries beyond those that made one.
constexpr int most_created = 10, most_failures = 5;
// King (3.21): particles with less liquid entrain nothing, and those with more no further than to this.
constexpr double least_volume_fraction = 2.0 / 3;
}  // namespace

EntrainmentBudget entrainment_budget(const EntrainmentModel& model, const EntrainingParticle& particle, double dt) {
  EntrainmentBudget budget;
  if (!(particle.dissipation > model.threshold) || !(particle.volume_fraction > least_volume_fraction)) return budget;
  budget.energy =
      model.constant * model.density_ratio * particle.volume_fraction * particle.dissipation * particle.volume * dt;
  budget.volume = (1 / least_volume_fraction - 1 / particle.volume_fraction) / particle.kernel_peak;
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
    while (energy_left > 0 && volume_left > 0 && created < most_created && tried < created + most_failures) {
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
