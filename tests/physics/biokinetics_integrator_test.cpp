// SPDX-License-Identifier: MIT
// Reactions of many particles at once, against the table walked for one, and against CVODE of SUNDIALS.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "spume/core/random.hpp"
#include "spume/physics/biokinetics/asm1.hpp"
#include "spume/physics/biokinetics/integrator.hpp"
#include "support/stiff_solution.hpp"

namespace spume::biokinetics {
namespace {

using State = std::array<double, asm1::components>;

Asm1Parameters with_switches() {
  Asm1Parameters p;
  p.k_nutrient = p.k_alkalinity = 0.01;
  return p;
}

State random_state(std::uint64_t draw, double decades) {
  State c;
  for (std::uint32_t i = 0; i < c.size(); ++i) {
    const auto u = random_uniform(31, RandomPurpose::test, draw, i / 4, 0);
    c[i] = std::pow(10.0, 2 - decades * u[i % 4]);
  }
  return c;
}

// Particles one after the other in the arrays of their components.
struct Particles {
  explicit Particles(const std::vector<State>& states) : values(asm1::components) {
    for (std::size_t i = 0; i < values.size(); ++i)
      for (const State& c : states) values[i].push_back(c[i]);
    for (auto& component : values) pointers.push_back(component.data());
  }
  State at(std::size_t k) const {
    State c;
    for (std::size_t i = 0; i < c.size(); ++i) c[i] = values[i][k];
    return c;
  }
  std::vector<std::vector<double>> values;
  std::vector<double*> pointers;
};

TEST(BiokineticsIntegrator, RatesOfABlockAreThoseOfTheTable) {
  const Model model = asm1_model(with_switches());
  const Integrator integrator(model, 1e-6);
  constexpr std::size_t lanes = Integrator::lanes;
  std::vector<double> c(asm1::components * lanes), change(c.size());
  for (std::size_t l = 0; l < lanes; ++l) {
    State state = random_state(l, 6);
    if (l % 3 == 0) state[l % asm1::components] = 0;
    for (std::size_t i = 0; i < state.size(); ++i) c[i * lanes + l] = state[i];
  }
  integrator.rates(c.data(), change.data());
  for (std::size_t l = 0; l < lanes; ++l) {
    State state{}, expected{};
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = c[i * lanes + l];
    reaction(model, state, expected);
    double scale = 0;
    for (const Process& process : model.processes) scale = std::max(scale, rate(process, state));
    // Coefficients are at most 19; sums in another order differ by some roundings of the largest rate.
    for (std::size_t i = 0; i < state.size(); ++i)
      EXPECT_NEAR(change[i * lanes + l], expected[i], 20 * 19 * scale * std::numeric_limits<double>::epsilon());
  }
}

// A minute, an hour and a day in one call: oxygen is used up within seconds of it.
TEST(BiokineticsIntegrator, ConcentrationsAreThoseOfCvode) {
  const Model model = asm1_model(with_switches());
  const Integrator integrator(model, 1e-8);
  std::vector<State> start{{30, 0.889, 1149, 49.3, 2559, 150, 452, 0.491, 10.4, 1.73, 0.688, 3.53, 4.13},
                           {30, 69.5, 51.2, 202.32, 280.17, 20, 0, 8, 0, 31.56, 6.95, 10.59, 7}};
  for (std::uint64_t draw = 0; draw < 6; ++draw) start.push_back(random_state(draw, 3));
  for (const double days : {60.0 / 86400, 1.0 / 24, 1.0}) {
    Particles particles(start);
    integrator.advance(particles.pointers, 0, start.size(), days);
    for (std::size_t k = 0; k < start.size(); ++k) {
      std::vector<double> exact(start[k].begin(), start[k].end());
      test::integrate_stiff(
          [&](const double* c, double* change) {
            State state;
            for (std::size_t i = 0; i < state.size(); ++i) state[i] = std::max(c[i], 0.0);
            reaction(model, state, {change, asm1::components});
          },
          exact, days);
      const State found = particles.at(k);
      for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_NEAR(found[i], exact[i], 1e-6 * (std::abs(exact[i]) + 1)) << model.components[i] << " after " << days;
    }
  }
}

// Linear invariants: every step adds the rounding of its largest terms.
TEST(BiokineticsIntegrator, CodNitrogenAndChargeStayAndNothingBecomesNegative) {
  const Asm1Parameters parameters = with_switches();
  const Integrator integrator(asm1_model(parameters), 1e-4);
  std::vector<State> start;
  for (std::uint64_t draw = 0; draw < 200; ++draw) {
    start.push_back(random_state(draw, 8));
    for (std::size_t i = 0; i < asm1::components; ++i)
      if ((draw >> (i % 7)) % 3 == 0) start.back()[i] = 0;
  }
  Particles particles(start);
  const auto total = [](const Asm1Content& content, const State& c) {
    double sum = 0;
    for (std::size_t i = 0; i < c.size(); ++i) sum += content[i] * c[i];
    return sum;
  };
  const Integrator::Work work = integrator.advance(particles.pointers, 0, start.size(), 10);
  const double tolerance = 1e-13 * static_cast<double>(work.steps);
  for (std::size_t k = 0; k < start.size(); ++k) {
    const State after = particles.at(k);
    for (std::size_t i = 0; i < after.size(); ++i) EXPECT_GE(after[i], 0);
    // What denitrification takes out of the components is dinitrogen with its own COD.
    const double dinitrogen = total(asm1_nitrogen(parameters), start[k]) - total(asm1_nitrogen(parameters), after);
    EXPECT_GE(dinitrogen, -tolerance);
    EXPECT_NEAR(total(asm1_cod(), after) + dinitrogen_cod * dinitrogen, total(asm1_cod(), start[k]), tolerance);
  }
}

// Lanes are filled from a queue: who shares a block must not matter.
TEST(BiokineticsIntegrator, AParticleDoesNotDependOnItsNeighbours) {
  const Integrator integrator(asm1_model(with_switches()), 1e-6);
  std::vector<State> start;
  for (std::uint64_t draw = 0; draw < 100; ++draw) start.push_back(random_state(draw, 4));
  Particles together(start), apart(start);
  integrator.advance(together.pointers, 0, start.size(), 0.02);
  for (std::size_t k = 0; k < start.size(); ++k) integrator.advance(apart.pointers, k, k + 1, 0.02);
  EXPECT_EQ(together.values, apart.values);
}

// The published model grows without ammonia: no step, however short, keeps it above zero.
TEST(BiokineticsIntegrator, AModelThatTakesFromNothingIsRefused) {
  State c;
  c.fill(1);
  c[asm1::s_nh] = c[asm1::s_nd] = 0;
  c[asm1::s_o] = 8;
  Particles published({c}), switched({c});
  EXPECT_THROW(Integrator(asm1_model({}), 1e-6).advance(published.pointers, 0, 1, 1), std::runtime_error);
  Integrator(asm1_model(with_switches()), 1e-6).advance(switched.pointers, 0, 1, 1);
  EXPECT_GE(switched.at(0)[asm1::s_nh], 0);
}

}  // namespace
}  // namespace spume::biokinetics
