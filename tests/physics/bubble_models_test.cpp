// SPDX-License-Identifier: MIT
// Stochastic models of bubbles against their laws: fluctuations, breakup, entrainment, sources.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "spume/core/random.hpp"
#include "spume/physics/bubbles/breakup.hpp"
#include "spume/physics/bubbles/entrainment.hpp"
#include "spume/physics/bubbles/fluctuations.hpp"
#include "spume/physics/bubbles/sources.hpp"
#include "spume/physics/bubbles/statistics.hpp"

namespace spume::bubbles {
namespace {

constexpr std::uint64_t seed = 11;

Vec3 noise(std::uint64_t walker, std::uint32_t step) {
  const auto z = random_normal(seed, RandomPurpose::test, walker, step, 0);
  return {z[0], z[1], z[2]};
}

TEST(Fluctuations, HaveTheVarianceAndBothCorrelationTimes) {
  // Slip along a diagonal: parallel and normal parts are mixtures of the components.
  const Vec3 slip{0.3, 0.3, 0};
  const double energy = 0.06, sigma2 = 0.04, width = 0.02, dt = 0.02;
  const double tau = width / std::sqrt(sigma2), ratio = 0.18 / sigma2;
  const double along = tau / std::sqrt(1 + ratio), across = tau / std::sqrt(1 + 4 * ratio);
  constexpr int walkers = 40000, warm_up = 30;
  double variance[2] = {0, 0}, product[2] = {0, 0};
  for (int w = 0; w < walkers; ++w) {
    Vec3 u{};
    for (std::uint32_t k = 0; k < warm_up; ++k)
      u = advance_fluctuation(u, slip, energy, width, 1, dt, noise(static_cast<std::uint64_t>(w), k));
    const Vec3 next = advance_fluctuation(u, slip, energy, width, 1, dt, noise(static_cast<std::uint64_t>(w), warm_up));
    const double a = (u[0] + u[1]) / std::sqrt(2), a_next = (next[0] + next[1]) / std::sqrt(2);
    variance[0] += a * a / walkers;
    product[0] += a * a_next / walkers;
    variance[1] += u[2] * u[2] / walkers;
    product[1] += u[2] * next[2] / walkers;
  }
  const double error = 4 * std::sqrt(2.0 / walkers);  // four deviations of a variance estimate
  EXPECT_NEAR(variance[0], sigma2, error * sigma2);
  EXPECT_NEAR(variance[1], sigma2, error * sigma2);
  EXPECT_NEAR(product[0], sigma2 * std::exp(-dt / along), error * sigma2);
  EXPECT_NEAR(product[1], sigma2 * std::exp(-dt / across), error * sigma2);
}

TEST(Fluctuations, VanishWithoutUnresolvedEnergyAndAreIsotropicWithoutSlip) {
  EXPECT_EQ(advance_fluctuation({1, 2, 3}, {1, 0, 0}, 0, 0.1, 1, 0.1, {1, 1, 1}), (Vec3{}));
  const Vec3 u = advance_fluctuation({1, 1, 1}, {0, 0, 0}, 0.06, 0.02, 1, 0.02, {0.5, 0.5, 0.5});
  EXPECT_EQ(u[0], u[1]);
  EXPECT_EQ(u[1], u[2]);
}

// King (3.27), after Martinez-Bazan et al. (2010), written out once more.
double printed_child_density(double v, double ratio) {
  const double limit = std::pow(ratio, 5.0 / 3);
  const double own = std::pow(v, 2.0 / 9) - limit, other = std::pow(1 - v, 2.0 / 9) - limit;
  return std::pow(v, -2.0 / 3) * std::pow(1 - v, -2.0 / 3) * own * other;
}

// Equal-probability bins from a quadrature independent of the table; 40 bins: chi-square beyond 39 + 5 sqrt(78) would
// happen once in a million.
TEST(ChildSizes, FollowTheLawByChiSquare) {
  const ChildSizeTable table;
  for (const double ratio : {0.1, 0.4, 0.7, 0.9}) {
    const double low = smallest_child(ratio), high = 1 - low;
    constexpr int points = 400000, bins = 40, draws = 400000;
    std::vector<double> edge{low};
    // Uniform in log-odds, so that both ends are resolved.
    const auto at = [&](double s) {
      const double from = std::log(low / high);
      return 1 / (1 + std::exp(-from * (1 - 2 * s)));
    };
    const auto weight = [&](double s) {
      const double v = at(s);
      return std::max(0.0, printed_child_density(v, ratio)) * v * (1 - v);
    };
    double total = 0;
    for (int k = 0; k < points; ++k) total += weight((k + 0.5) / points);
    double sum = 0;
    for (int k = 0; k < points; ++k) {
      const double next = sum + weight((k + 0.5) / points);
      while (static_cast<int>(edge.size()) < bins && next >= total * static_cast<double>(edge.size()) / bins) {
        const double part = (total * static_cast<double>(edge.size()) / bins - sum) / (next - sum);
        edge.push_back(std::clamp(at((k + part) / points), low, high));
      }
      sum = next;
    }
    edge.push_back(high);
    if (edge[0] > edge[1]) std::reverse(edge.begin(), edge.end());
    std::vector<int> count(bins, 0);
    for (std::uint64_t k = 0; k < draws / 4; ++k)
      for (const double u : random_uniform(seed, RandomPurpose::test, k, 1, 0)) {
        const double v = table(u, ratio);
        ASSERT_GE(v, low * (1 - 1e-9));
        ASSERT_LE(v, high * (1 + 1e-9));
        const auto bin = std::upper_bound(edge.begin(), edge.end(), v) - edge.begin() - 1;
        ++count[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(bin, 0, bins - 1))];
      }
    const double expected = static_cast<double>(draws) / bins;
    double chi2 = 0;
    for (const int c : count) chi2 += (c - expected) * (c - expected) / expected;
    EXPECT_LT(chi2, 39 + 5 * std::sqrt(78.0)) << "Lambda = " << ratio;
  }
}

TEST(ChildSizes, AtTheCriticalRatioAreHalves) {
  const ChildSizeTable table;
  for (const double u : {0.0, 0.2, 0.7, 0.999}) EXPECT_NEAR(table(u, critical_ratio() * (1 - 1e-9)), 0.5, 1e-6);
}

TEST(Breakup, ChildrenHoldTheVolumeAndItsCentre) {
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const auto u = random_uniform(seed, RandomPurpose::test, k, 2, 0);
    const double volume = 1e-9 * (1 + u[3]), fraction = 1e-3 + 0.998 * u[0];
    const Children children = split(volume, fraction, u[1], u[2]);
    EXPECT_NEAR(children.first_volume + children.second_volume, volume, 2.3e-16 * volume);
    double apart = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double moment =
          children.first_volume * children.first_offset[a] + children.second_volume * children.second_offset[a];
      EXPECT_NEAR(moment, 0, 1e-12 * volume * 1e-3);
      apart += std::pow(children.first_offset[a] - children.second_offset[a], 2);
    }
    EXPECT_NEAR(std::sqrt(apart), radius_of(children.first_volume) + radius_of(children.second_volume), 1e-12);
  }
}

TEST(Breakup, DeformationBalancesStressAndTension) {
  const BreakupModel model{1 / 1.98e4, 8.2};
  const double a = 2e-3;
  const double balance = std::pow(6 * model.tension / (a * 8.2), 1.5) / (2 * a);  // 8.2 (2 eps a)^(2/3) = 6 tension / a
  EXPECT_NEAR(deformation_velocity(model, a, balance), 0, 1e-8);
  EXPECT_GT(deformation_velocity(model, a, 2 * balance), 0);
  EXPECT_LT(deformation_velocity(model, a, 0.5 * balance), 0);
  EXPECT_NEAR(deformation_velocity(model, a, 0), -std::sqrt(6 * model.tension / a), 1e-15);
  // King (3.28) as printed.
  EXPECT_NEAR(stable_ratio(model, a, 0.3), std::pow(12 / (8.2 * 1.98e4), 0.6) * std::pow(0.3, -0.4) / (2 * a), 1e-14);
  EXPECT_NEAR(critical_ratio(), 0.912, 5e-4);
}

EntrainmentModel wave_model() {
  EntrainmentModel model;
  model.density_ratio = 1000 / 1.2;
  model.tension = 1 / 1.98e4;
  model.smallest_radius = std::pow(1.98e4, -0.6) / 40;
  model.largest_radius = model.spacing = 0.01;
  return model;
}

EntrainingParticle wave_particle(double dissipation, std::int64_t identifier) {
  EntrainingParticle particle;
  particle.dissipation = dissipation;
  particle.volume = 1e-6;
  particle.kernel_peak = 21 / (16 * M_PI * std::pow(0.013, 3));
  particle.identifier = identifier;
  return particle;
}

// The energy ends the purchases at the smaller dissipations, the volume at the largest: in each, bubbles that do not
// end it are made as well, so that a budget left unspent would show.
TEST(Entrainment, OverdrawsABudgetByTheBubbleThatEndsItAlone) {
  const EntrainmentModel model = wave_model();
  std::vector<NewBubble> made;
  for (const double dissipation : {0.4, 2.0, 20.0}) {
    int ended_by_energy = 0, ended_by_volume = 0, several = 0;
    for (std::int64_t k = 0; k < 20000; ++k) {
      const EntrainingParticle particle = wave_particle(dissipation, k);
      const EntrainmentBudget budget = entrainment_budget(model, particle, 0.002);
      made.clear();
      entrain(model, particle, 0.002, 0.002, 3, made);
      EXPECT_LE(made.size(), 10U);
      several += made.size() > 1 ? 1 : 0;
      double energy = 0, own_volume = 0;
      for (const NewBubble& bubble : made) {
        const double radius = radius_of(bubble.volume);
        EXPECT_GE(radius, model.smallest_radius * (1 - 1e-12));
        EXPECT_LE(radius, model.largest_radius * (1 + 1e-12));
        for (const double x : bubble.position) EXPECT_LE(std::abs(x), 0.5 * model.spacing);
        // Before each bubble something was left of both.
        EXPECT_LT(energy, budget.energy);
        EXPECT_LT(own_volume, budget.volume);
        energy += surface_energy(model, radius);
        own_volume += bubble.volume;
      }
      ended_by_energy += energy >= budget.energy ? 1 : 0;
      ended_by_volume += own_volume >= budget.volume ? 1 : 0;
    }
    EXPECT_GT(several, 1000) << dissipation;
    EXPECT_GT(dissipation < 10 ? ended_by_energy : ended_by_volume, 1000) << dissipation;
  }
}

// The radii of the first bubbles of particles: tried uniformly, so flat up to the radius whose surface the energy pays,
// as its inverse square beyond, and another inverse cube where the volume ends; as printed, what that leaves of one.
class FirstEntrained : public ::testing::TestWithParam<EntrainmentOverdraft> {};

TEST_P(FirstEntrained, IsFlatUpToTheRadiusThatTheEnergyPays) {
  EntrainmentModel model = wave_model();
  model.overdraft = GetParam();
  const auto chance = [](double left_over_cost) {
    if (left_over_cost >= 1) return 1.0;
    return GetParam() == EntrainmentOverdraft::printed ? 1 - left_over_cost : left_over_cost;
  };
  const double dissipation = 0.4, dt = 0.002;
  const EntrainmentBudget budget = entrainment_budget(model, wave_particle(dissipation, 0), dt);
  const double paid = std::sqrt(budget.energy / (4 * M_PI * model.tension)), room = radius_of(budget.volume);
  EXPECT_NEAR(paid, 3.24e-3, 1e-5);
  constexpr int bins = 20;
  std::array<double, bins> count{}, expected{};
  const double span = model.largest_radius - model.smallest_radius;
  double total = 0, weight = 0;
  std::vector<NewBubble> made;
  for (std::int64_t k = 0; k < 20000; ++k) {
    made.clear();
    entrain(model, wave_particle(dissipation, k), dt, dt, 5, made);
    if (made.empty()) continue;
    ++count[static_cast<std::size_t>((radius_of(made[0].volume) - model.smallest_radius) / span * bins)];
    ++total;
  }
  for (int k = 0; k < 100 * bins; ++k) {
    const double radius = model.smallest_radius + (k + 0.5) / (100 * bins) * span;
    const double accepted = chance(std::pow(paid / radius, 2)) * chance(std::pow(room / radius, 3));
    expected[static_cast<std::size_t>(k / 100)] += accepted;
    weight += accepted;
  }
  double chi2 = 0;
  for (int k = 0; k < bins; ++k) {
    const double mean = total * expected[k] / weight;
    chi2 += (count[k] - mean) * (count[k] - mean) / mean;
  }
  EXPECT_LT(chi2, bins - 1 + 5 * std::sqrt(2.0 * (bins - 1)));
}

INSTANTIATE_TEST_SUITE_P(Entrainment, FirstEntrained,
                         ::testing::Values(EntrainmentOverdraft::affordable, EntrainmentOverdraft::printed),
                         [](const auto& overdraft) {
                           return overdraft.param == EntrainmentOverdraft::printed ? "printed" : "affordable";
                         });

// Over the same time steps of any length make as many bubbles of the same mean radius, where there is room for all.
TEST(Entrainment, DoesNotDependOnTheLengthOfTheStep) {
  const EntrainmentModel model = wave_model();
  const double period = 0.002, time = 40 * period;
  struct Count {
    double bubbles = 0, squares = 0, radii = 0, radii2 = 0;
  };
  const auto entrained = [&](int steps) {
    Count count;
    std::vector<NewBubble> made;
    for (std::int64_t k = 0; k < 2000; ++k) {
      made.clear();
      for (int step = 0; step < steps; ++step)
        entrain(model, wave_particle(0.4, k), time / steps, period, static_cast<std::uint32_t>(step), made);
      const auto number = static_cast<double>(made.size());
      count.bubbles += number;
      count.squares += number * number;
      for (const NewBubble& bubble : made) {
        const double radius = radius_of(bubble.volume);
        count.radii += radius;
        count.radii2 += radius * radius;
      }
    }
    return count;
  };
  const Count expected = entrained(40);
  for (const int steps : {25, 33, 100, 400}) {
    const Count count = entrained(steps);
    const double number_error = std::sqrt(count.squares - count.bubbles * count.bubbles / 2000 + expected.squares -
                                          expected.bubbles * expected.bubbles / 2000);
    EXPECT_NEAR(count.bubbles, expected.bubbles, 5 * number_error) << steps;
    const double mean = count.radii / count.bubbles, expected_mean = expected.radii / expected.bubbles;
    const double variance = expected.radii2 / expected.bubbles - expected_mean * expected_mean;
    EXPECT_NEAR(mean, expected_mean, 5 * std::sqrt(variance * (1 / count.bubbles + 1 / expected.bubbles))) << steps;
  }
}

TEST(Entrainment, NeedsDissipationAndRoom) {
  const EntrainmentModel model = wave_model();
  std::vector<NewBubble> made;
  for (std::int64_t k = 0; k < 200; ++k) {
    entrain(model, wave_particle(0.19, k), 1, 1, 1, made);
    EntrainingParticle full = wave_particle(100, k);
    full.volume_fraction = 2.0 / 3;
    entrain(model, full, 1, 1, 1, made);
  }
  EXPECT_TRUE(made.empty());
  // King (3.21): filling the budget takes alpha to 2/3 by (3.1).
  const auto budget = entrainment_budget(model, wave_particle(1, 0), 1);
  EXPECT_NEAR(1 / (1 + wave_particle(1, 0).kernel_peak * budget.volume), 2.0 / 3, 1e-12);
}

TEST(Population, GivesIdentifiersInOrderAndRemovesWithoutHoles) {
  Population population({true, true, true});
  const auto make = [](std::size_t item, std::vector<NewBubble>& made) {
    for (std::size_t k = 0; k < item % 3; ++k) {
      NewBubble bubble;
      bubble.volume = static_cast<double>(item);
      made.push_back(bubble);
    }
  };
  EXPECT_EQ(population.give_birth(1000, 2.5, make), 999U);
  std::int64_t next = 0;
  double last = 0;
  for (std::size_t b = 0; b < population.size(); ++b) {
    EXPECT_EQ((*population.identifier)[b], next++);
    EXPECT_GE((*population.volume)[b], last);
    last = (*population.volume)[b];
    EXPECT_EQ((*population.birth_time)[b], 2.5);
    EXPECT_EQ((*population.merge_time)[b], not_merging);
  }
  Array<std::uint8_t> dead(population.size());
  double left = 0;
  for (std::size_t b = 0; b < dead.size(); ++b) {
    dead[b] = b % 7 == 3 ? 1 : 0;
    if (dead[b] == 0) left += (*population.volume)[b];
  }
  population.remove(dead);
  EXPECT_EQ(population.total_volume(), left);
  for (std::size_t b = 1; b < population.size(); ++b)
    EXPECT_LT((*population.identifier)[b - 1], (*population.identifier)[b]);
  EXPECT_EQ(population.give_birth(3, 3, make), 3U);
  EXPECT_EQ((*population.identifier)[population.size() - 1], 1001);
}

TEST(Sources, ReleaseTheVolumeOfTheRateInWholeBubbles) {
  class Linear final : public Expression {
   public:
    double operator()(double, double, double, double t) const override { return 2e-5 * t; }
    std::unique_ptr<Expression> clone() const override { return std::make_unique<Linear>(); }
  };
  Sparger sparger;
  sparger.shape = SpargerShape::disc;
  sparger.position = {0.1, 0.2, 0.3};
  sparger.radius = 0.05;
  sparger.sizes = {SizeLaw::truncated_gaussian, 1e-3, 1e-3, 1e-4, 0.02};
  sparger.rate = std::make_shared<Linear>();
  const BubbleSources given{{sparger}, {}};
  Sources sources(given, 1);
  Population population({});
  double released = 0;
  for (int k = 0; k < 100; ++k) released += sources.release(population, 0.02 * k, 0.02).volume;
  const double exact = 1e-5 * 4;  // integral of 2e-5 t to t = 2
  EXPECT_NEAR(released + sources.state.pending_volume[0], exact, 1e-15);
  EXPECT_NEAR(population.total_volume(), released, 1e-12 * released);
  EXPECT_GT(population.size(), 500U);
  double outer = 0;
  for (std::size_t b = 0; b < population.size(); ++b) {
    const double r = std::hypot((*population.position[0])[b] - 0.1, (*population.position[1])[b] - 0.2);
    EXPECT_LE(r, 0.05);
    EXPECT_EQ((*population.position[2])[b], 0.3);
    outer += r > 0.05 / std::sqrt(2) ? 1 : 0;
  }
  // Half of the disc's area lies beyond r / sqrt(2).
  const auto n = static_cast<double>(population.size());
  EXPECT_NEAR(outer / n, 0.5, 4 * 0.5 / std::sqrt(n));
}

TEST(Sources, RadiiFollowTheirLaws) {
  const BubbleSizes gaussian{SizeLaw::truncated_gaussian, 1e-3, 1e-3, 1e-4, 3e-3};
  const BubbleSizes log_normal{SizeLaw::log_normal, 1e-3, 0.5, 1e-6, 1};
  constexpr int n = 20000;
  double mean = 0, mean_log = 0, square_log = 0;
  for (std::uint64_t k = 0; k < n; ++k) {
    const double a = draw_radius(gaussian, seed, 0, k), b = std::log(draw_radius(log_normal, seed, 1, k) / 1e-3);
    EXPECT_GE(a, 1e-4);
    EXPECT_LE(a, 3e-3);
    mean += a / n;
    mean_log += b / n;
    square_log += b * b / n;
  }
  // Mean of the normal law cut at -0.9 and 2 deviations: mu + sigma (phi(-0.9) - phi(2)) / (Phi(2) - Phi(-0.9)).
  const double phi_low = std::exp(-0.405) / std::sqrt(2 * M_PI), phi_high = std::exp(-2.0) / std::sqrt(2 * M_PI);
  const double inside = 0.5 * (std::erf(std::sqrt(2.0)) + std::erf(0.9 / std::sqrt(2.0)));
  EXPECT_NEAR(mean, 1e-3 * (1 + (phi_low - phi_high) / inside), 4 * 0.7e-3 / std::sqrt(n));
  EXPECT_NEAR(mean_log, 0, 4 * 0.5 / std::sqrt(n));
  EXPECT_NEAR(square_log, 0.25, 4 * 0.25 * std::sqrt(2.0 / n));
}

TEST(Statistics, CountAboutTheHinzeRadiusAndIntegrateToOne) {
  Population population({});
  population.give_birth(1000, 0, [](std::size_t item, std::vector<NewBubble>& made) {
    NewBubble bubble;
    bubble.volume = volume_of(1e-4 * std::pow(100.0, static_cast<double>(item) / 999));  // 1e-4 to 1e-2
    made.push_back(bubble);
  });
  const auto counts = count_about(population, 1e-3 * (1 + 1e-9));
  EXPECT_EQ(counts.above, 500U);
  EXPECT_EQ(counts.below, 500U);
  const auto sizes = size_distribution(population, 1e-3);
  EXPECT_EQ(sizes.total(), 1000);
  double integral = 0;
  for (int k = 0; k < SizeDistribution::bins; ++k)
    integral += sizes.density(k) * (SizeDistribution::edge(k + 1) - SizeDistribution::edge(k));
  EXPECT_NEAR(integral, 1, 1e-12);
}

}  // namespace
}  // namespace spume::bubbles
