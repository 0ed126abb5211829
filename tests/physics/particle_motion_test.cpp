// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <complex>
#include <functional>
#include <vector>

#include "spume/core/random.hpp"
#include "spume/physics/point_particles/motion.hpp"

namespace spume::test {
namespace {

using Vector = std::array<double, 3>;

PeriodicGrid grid_of(int n) {
  PeriodicGrid grid;
  grid.length = {2 * M_PI, 2 * M_PI, 2 * M_PI};
  grid.points = {n, n, n};
  grid.z_stride = static_cast<std::size_t>(n);
  return grid;
}

void fill_uniform(SplineField<double>& field, const Vector& u) {
  std::array<std::vector<double>, 3> c;
  for (int i = 0; i < 3; ++i) c[i].assign(field.grid().storage(), u[i]);
  field.fill(std::array<const double*, 3>{c[0].data(), c[1].data(), c[2].data()});
}

Particles particles_of(std::size_t n, bool force = false) {
  Particles particles(ParticleArrays{force, false});
  particles.fields.resize(n);
  particles.common_diameter = 0.1;
  for (std::size_t i = 0; i < n; ++i) (*particles.identifier)[i] = static_cast<std::int64_t>(i);
  return particles;
}

TEST(RelaxationCoefficientsOfAStep, AreAccurateOnBothSidesOfTheSeries) {
  for (const double h : {0.0, 1e-9, 1e-3, 0.2499999999, 0.25, 1.0, 30.0, 1e4}) {
    const auto c = relaxation_coefficients(h);
    EXPECT_NEAR(c.decay, std::exp(-h), 1e-15);
    const long double l = h;
    const long double phi1 = h == 0 ? 1 : -std::expm1(-l) / l;
    EXPECT_NEAR(c.phi1, static_cast<double>(phi1), 5e-16);
    // In long double the cancellation costs 1e-19 / h.
    if (h > 1e-4) {
      EXPECT_NEAR(c.phi2, static_cast<double>((1 - phi1) / l), 3e-15);
    }
  }
  EXPECT_EQ(relaxation_coefficients(0).phi2, 0.5);
}

// In a uniform steady flow with gravity the step is exact: V - V_end = (V_0 - V_end) exp(-t / tau).
TEST(ParticleMotion, RelaxationAndSettlingAreExactForAnyStep) {
  for (const double beta : {0.0, 1.0, 3.0})
    for (const double tau : {1e-3, 0.4, 1e3}) {
      SplineField<double> field(grid_of(4), 4);
      const Vector u{0.3, -0.2, 0.1};
      fill_uniform(field, u);
      MotionModel model;
      model.beta = beta;
      model.response_time = tau;
      model.gravity = {0, 0, -0.5};
      Particles particles = particles_of(1);
      const Vector start{-1, 2, 0.5}, place{1, 2, 3};
      for (int c = 0; c < 3; ++c) {
        (*particles.velocity[c])[0] = start[c];
        (*particles.position[c])[0] = place[c];
      }
      const double dt = 0.37;
      for (int step = 0; step < 8; ++step) move_particles(model, field, dt, particles);
      const double t = 8 * dt;
      for (int c = 0; c < 3; ++c) {
        const double end = u[c] + tau * (1 - beta) * model.gravity[c];
        const double scale = 1 + std::abs(end);
        EXPECT_NEAR((*particles.velocity[c])[0], end + (start[c] - end) * std::exp(-t / tau), 1e-14 * scale);
        const double moved = end * t - (start[c] - end) * tau * std::expm1(-t / tau);
        const double x = (*particles.position[c])[0];
        EXPECT_NEAR(std::remainder(x - place[c] - moved, 2 * M_PI), 0, 1e-13 * scale * (1 + std::abs(moved)))
            << beta << " " << tau;
      }
    }
}

// u = cos(w t): V = Re((1 + i beta w tau) / (1 + i w tau) exp(i w t)). The rate of u over a step is a difference, good
// to (w dt)^2 / 24 of it, and the midpoint to (w dt)^2 / 8.
TEST(ParticleMotion, FollowsAnOscillatingFlowInAmplitudeAndPhase) {
  const double w = 2, dt = 0.02;
  for (const double beta : {0.0, 0.5, 1.0, 3.0})
    for (const double tau : {1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3}) {
      const std::complex<double> i(0, 1);
      const std::complex<double> response = (1.0 + i * beta * w * tau) / (1.0 + i * w * tau);
      MotionModel model;
      model.beta = beta;
      model.response_time = tau;
      SplineField<double> field(grid_of(4), 4);
      Particles particles = particles_of(1);
      fill_uniform(field, {1, 0, 0});
      (*particles.velocity[0])[0] = response.real();
      double worst = 0;
      for (int step = 1; step <= 400; ++step) {
        const double t = step * dt;
        fill_uniform(field, {std::cos(w * t), 0, 0});
        move_particles(model, field, dt, particles);
        worst = std::max(worst, std::abs((*particles.velocity[0])[0] - (response * std::exp(i * w * t)).real()));
      }
      EXPECT_LT(worst, (1 + beta) / 4 * w * w * dt * dt) << beta << " " << tau;
    }
}

// An unsteady cellular flow on a fine grid.
struct Cellular {
  PeriodicGrid grid = grid_of(20);
  Vector at(const Vector& x, double t) const {
    const double s = std::sin(1.3 * t), c = std::cos(0.7 * t);
    return {std::sin(x[2] + s) + 0.7 * std::cos(x[1]) * c, 0.6 * std::sin(x[0]) + std::cos(x[2] - t),
            0.7 * std::sin(x[1] + 0.5 * t) + 0.8 * std::cos(x[0] + s)};
  }
  void fill(SplineField<double>& field, double t) const {
    // Every mode has one wave number 1, so that one factor is its prefilter.
    const double factor = b_spline_prefilter(field.order(), 1, grid.points[0]);
    std::array<std::vector<double>, 3> c;
    for (auto& v : c) v.resize(grid.storage());
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 20; ++j)
        for (int k = 0; k < 20; ++k) {
          const Vector u = at({i * grid.spacing(0), j * grid.spacing(1), k * grid.spacing(2)}, t);
          for (int a = 0; a < 3; ++a) c[a][grid.row(i, j) + static_cast<std::size_t>(k)] = factor * u[a];
        }
    field.fill(std::array<const double*, 3>{c[0].data(), c[1].data(), c[2].data()});
  }
};

Particles started(const Cellular& flow, std::size_t n) {
  Particles particles = particles_of(n);
  for (std::size_t p = 0; p < n; ++p) {
    const auto r = random_uniform(2, RandomPurpose::test, p, 0, 0);
    Vector x;
    for (int c = 0; c < 3; ++c) x[c] = (*particles.position[c])[p] = 2 * M_PI * r[c];
    const Vector u = flow.at(x, 0);
    for (int c = 0; c < 3; ++c) (*particles.velocity[c])[p] = u[c];
  }
  return particles;
}

Particles moved(const MotionModel& model, int steps, double end) {
  const Cellular flow;
  SplineField<double> field(flow.grid, 6);
  Particles particles = started(flow, 40);
  flow.fill(field, 0);
  const double dt = end / steps;
  for (int step = 1; step <= steps; ++step) {
    flow.fill(field, step * dt);
    move_particles(model, field, dt, particles);
  }
  return particles;
}

double distance(const Particles& a, const Particles& b, bool velocity) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    for (std::size_t p = 0; p < a.size(); ++p) {
      const auto& u = velocity ? *a.velocity[c] : *a.position[c];
      const auto& v = velocity ? *b.velocity[c] : *b.position[c];
      sum += std::pow(std::remainder(u[p] - v[p], 2 * M_PI), 2);
    }
  return std::sqrt(sum);
}

TEST(ParticleMotion, IsOfSecondOrderForAnyResponseTime) {
  for (const double beta : {0.0, 1.0, 3.0})
    for (const double tau : {1e-3, 0.03, 0.5, 100.0}) {
      MotionModel model;
      model.beta = beta;
      model.response_time = tau;
      const Particles coarse = moved(model, 20, 1), middle = moved(model, 40, 1), fine = moved(model, 80, 1);
      for (const bool velocity : {false, true}) {
        const double order = std::log2(distance(coarse, middle, velocity) / distance(middle, fine, velocity));
        // Steps of 0.05 against times of about 1: the next order adds about a tenth.
        EXPECT_GT(order, 1.75) << beta << " " << tau << (velocity ? " velocity" : " position");
      }
    }
}

// V = u + tau (beta - 1) Du/Dt + O(tau^2), whatever the step is to tau.
TEST(ParticleMotion, BecomesThatOfTracersAsTheResponseTimeVanishes) {
  const Cellular flow;
  for (const double tau : {1e-8, 1e-4}) {
    MotionModel model;
    model.beta = 3;
    model.response_time = tau;
    const Particles particles = moved(model, 200, 1);
    double worst = 0;
    for (std::size_t p = 0; p < particles.size(); ++p) {
      Vector x;
      for (int c = 0; c < 3; ++c) x[c] = (*particles.position[c])[p];
      const Vector u = flow.at(x, 1);
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs((*particles.velocity[c])[p] - u[c]));
    }
    // The slip itself, and (dt / 2)^2 times second derivatives of about 4.
    EXPECT_LT(worst, 2 * tau * 4 + 6.25e-6 * 4) << tau;
  }
}

TEST(ParticleMotion, SettlesAtTheSpeedOfTheSchillerNaumannLaw) {
  MotionModel model;
  model.beta = 0.1;
  model.response_time = 0.5;
  model.viscosity = 0.01;
  model.drag = DragLaw::schiller_naumann;
  model.gravity = {0, 0, -20};
  SplineField<double> field(grid_of(4), 2);
  fill_uniform(field, {0, 0, 0});
  Particles particles = particles_of(1);
  for (int step = 0; step < 400; ++step) move_particles(model, field, 0.1, particles);
  const double speed = -(*particles.velocity[2])[0];
  const double drag = speed * (1 + 0.15 * std::pow(speed * 0.1 / 0.01, 0.687)) / 0.5;
  EXPECT_NEAR(drag, 0.9 * 20, 1e-9);
}

TEST(ParticleMotion, LargerParticlesRespondWithTheSquareOfTheirDiameter) {
  Particles particles(ParticleArrays{false, true});
  particles.fields.resize(2);
  particles.common_diameter = 0.1;
  for (int p = 0; p < 2; ++p) {
    (*particles.diameter)[p] = 0.1 * (p + 1);
    (*particles.velocity[0])[p] = 1;
  }
  MotionModel model;
  model.response_time = 0.5;
  SplineField<double> field(grid_of(4), 4);
  fill_uniform(field, {0, 0, 0});
  move_particles(model, field, 0.2, particles);
  EXPECT_NEAR((*particles.velocity[0])[0], std::exp(-0.4), 1e-15);
  EXPECT_NEAR((*particles.velocity[0])[1], std::exp(-0.1), 1e-15);
}

// Over a run the fluid receives what the particles lose: sum of F dt = -rho_p / rho_f volume (V_end - V_start), for a
// flow without acceleration; F is extrapolated from the last two.
TEST(ParticleMotion, GivesTheFluidTheMomentumThatParticlesLose) {
  MotionModel model;
  model.beta = 0.3;
  model.response_time = 0.5;
  SplineField<double> field(grid_of(4), 4);
  fill_uniform(field, {1, 0, 0});
  Particles particles = particles_of(1, true);
  Array<double> amounts(3);
  const double volume = sphere_volume(0.1), ratio = model.density_ratio();
  double given = 0, before = 0;
  for (int step = 0; step < 10; ++step) {
    move_particles(model, field, 0.1, particles, {amounts.data(), 0.5});
    const double force = (*particles.force[0])[0];
    EXPECT_NEAR(amounts[0], force + 0.5 * (force - before), 1e-18);
    given += 0.1 * force;
    before = force;
  }
  EXPECT_NEAR(given, -ratio * volume * (*particles.velocity[0])[0], 1e-15 * volume * ratio);
}

TEST(ParticleMotion, FrozenBubblesFeelTheAccelerationOfTheFluid) {
  MotionModel model;
  model.beta = 3;
  model.frozen = true;
  SplineField<double> field(grid_of(4), 4);
  fill_uniform(field, {1, 0, 0});
  fill_uniform(field, {1.5, 0, 0});
  Particles particles = particles_of(1, true);
  Array<double> amounts(3);
  move_particles(model, field, 0.1, particles, {amounts.data(), 0});
  EXPECT_EQ((*particles.position[0])[0], 0);
  EXPECT_EQ((*particles.velocity[0])[0], 0);
  EXPECT_NEAR(amounts[0], sphere_volume(0.1) * 5, 1e-16);
}

TEST(ParticleMotion, IsTheSameForAnyNumberOfThreads) {
  MotionModel model;
  model.beta = 3;
  model.response_time = 0.1;
  const Cellular flow;
  const int before = omp_get_max_threads();
  std::array<Particles, 2> runs;
  std::array<MotionStatistics, 2> statistics;
  for (int r = 0; r < 2; ++r) {
    omp_set_num_threads(r == 0 ? 1 : 3);
    SplineField<double> field(flow.grid, 4);
    flow.fill(field, 0);
    flow.fill(field, 0.1);
    runs[r] = started(flow, 5000);
    statistics[r] = move_particles(model, field, 0.1, runs[r]);
  }
  omp_set_num_threads(before);
  for (int c = 0; c < 3; ++c)
    for (std::size_t p = 0; p < 5000; ++p) ASSERT_EQ((*runs[0].position[c])[p], (*runs[1].position[c])[p]);
  EXPECT_EQ(statistics[0].mean_square_slip, statistics[1].mean_square_slip);
}

}  // namespace
}  // namespace spume::test
