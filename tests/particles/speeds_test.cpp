// SPDX-License-Identifier: MIT
// What refuses a step and bounds the next one, taken a block of particles at a time, against loops over all of them.
#include <gtest/gtest.h>

#include "particles/walled.hpp"
#include "spume/core/parallel.hpp"
#include "spume/particles/energy_guard.hpp"
#include "spume/particles/number_density.hpp"
#include "spume/particles/step_limits.hpp"

namespace spume::test {
namespace {

// More than two blocks, the last of which is not full; one particle alone far from the others, which is the fastest.
struct Spray : Walled {
  std::size_t alone = 0;
  Spray() : Walled(scene_text(square, 0.05, disc, "where = \"0.9 - x\"\n")) {
    const std::size_t n = particles.size();
    for (std::size_t i = 0; i < n; ++i)
      if (place(i)[0] > place(alone)[0]) alone = i;
    (*particles.position[0])[alone] += 0.5;
    for (std::size_t i = 0; i < n; ++i)
      for (int axis = 0; axis < 2; ++axis)
        (*particles.velocity[axis])[i] = uniform(i, 4)[static_cast<std::size_t>(axis)] - 0.5;
    (*particles.velocity[0])[alone] = 3;
    const auto identifier = (*particles.identifier)[alone];
    arrangement.sort(particles, particles.position);
    boundary.make_images(arrangement, particles, particles.position, 1, {});
    arrangement.find_neighbours(particles, particles.position, {});
    alone = 0;
    while ((*particles.identifier)[alone] != identifier) ++alone;
  }
};

TEST(Speeds, SprayCountsToTheLargestAlone) {
  Spray spray;
  ParticleStore& particles = spray.particles;
  ASSERT_GT(particles.size(), 2 * default_block);
  ASSERT_NE(particles.size() % default_block, 0U);
  double limiting = 0;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (i != spray.alone) limiting = std::max(limiting, std::sqrt(squared_norm(particles.velocity, 2, i)));
  const Speeds speeds = find_speeds(spray.arrangement, particles);
  EXPECT_DOUBLE_EQ(speeds.largest, std::sqrt(squared_norm(particles.velocity, 2, spray.alone)));
  EXPECT_DOUBLE_EQ(speeds.limiting, limiting);
  // As far as the fastest of the liquid goes against the mean of all.
  const double h = spray.resolution.smoothing_length, dt = 1e-3;
  Vec3 mean{};
  for (std::size_t i = 0; i < particles.size(); ++i)
    for (int axis = 0; axis < 2; ++axis)
      mean[axis] += (*particles.velocity[axis])[i] / static_cast<double>(particles.size());
  double relative = 0;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (i != spray.alone)
      relative =
          std::max(relative, std::hypot((*particles.velocity[0])[i] - mean[0], (*particles.velocity[1])[i] - mean[1]));
  EXPECT_NEAR(displacement_fraction(spray.arrangement, particles, spray.resolution, dt),
              relative * dt / (full_displacement * h), 1e-12);
  (*particles.velocity[1])[7] = NAN;
  EXPECT_TRUE(std::isnan(find_speeds(spray.arrangement, particles).largest));
  EXPECT_TRUE(std::isnan(find_speeds(spray.arrangement, particles).limiting));
}

TEST(Speeds, OneParticleInManyRefusesAStep) {
  Spray spray;
  ParticleStore& particles = spray.particles;
  VectorScratch velocity;
  particles.scratch().lease(velocity, 2, particles.size());
  for (int axis = 0; axis < 2; ++axis)
    for (std::size_t i = 0; i < particles.size(); ++i) velocity[axis][i] = (*particles.velocity[axis])[i];
  const double reach = spray.resolution.support_radius, dt = 0.49 * reach / 3;
  EXPECT_NO_THROW(refuse_long_strides(particles, particles.position, velocity, reach, dt));
  const auto blamed = [&] {
    try {
      refuse_long_strides(particles, particles.position, velocity, reach, 1.1 * dt);
    } catch (const StepFailure& failure) {
      return failure.details().particle;
    }
    return std::int64_t{-1};
  };
  EXPECT_EQ(blamed(), (*particles.identifier)[spray.alone]);
  const std::size_t nan = spray.alone == 5 ? 6 : 5;
  velocity[1][nan] = NAN;
  velocity[0][spray.alone] = 0;
  EXPECT_EQ(blamed(), (*particles.identifier)[nan]);
}

TEST(Steps, ADensityOffByHalfAndAForceThatIsNotFiniteAlongAnyAxisBlameTheirParticle) {
  const Walled walled(scene_text(channel, 0.05, turned));
  const ParticleStore& particles = walled.particles;
  const std::size_t n = particles.size();
  Array<double> excess(n);
  FloatVectorScratch force;
  for (int axis = 0; axis < 2; ++axis) force[axis].resize(n);
  for (std::size_t i = 0; i < n; ++i) excess[i] = 0.49 * uniform(i, 5)[0], force[0][i] = force[1][i] = 1;
  const auto blamed = [&]() -> std::pair<std::int64_t, double> {
    try {
      refuse_burst(particles, {particles.position, excess.data(), force}, "time.courant");
    } catch (const StepFailure& failure) {
      return {failure.details().particle, failure.details().value};
    }
    return {-1, 0};
  };
  const auto of = [&](std::size_t i) { return (*particles.identifier)[i]; };
  EXPECT_EQ(blamed().first, -1);
  excess[7] = -0.6;
  EXPECT_EQ(blamed(), (std::pair{of(7), 0.6}));
  excess[7] = 0;
  for (const int axis : {0, 1}) {
    force[axis][9] = NAN;
    EXPECT_EQ(blamed().first, of(9)) << "axis " << axis;
    force[axis][9] = 1;
  }
}

// Along the periodic axis there is no height.
TEST(EnergyGuard, HoldsKineticEnergyAndHeightAcrossSides) {
  const Walled walled(scene_text(channel, 0.05, turned));
  const ParticleStore& particles = walled.particles;
  EnergyGuard guard(walled.scene().domain, walled.resolution);
  EnergyBalance balance;
  balance.particle_mass = 0.7;
  balance.gravity = {-4, -9, 0};
  double kinetic = 0, potential = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) (*particles.velocity[axis])[i] = uniform(i, 4)[static_cast<std::size_t>(axis)];
    kinetic += 0.7 * squared_norm(particles.velocity, 2, i) / 2;
    potential += 0.7 * 9 * (*particles.position[1])[i];
  }
  EXPECT_NEAR(guard.held(balance, particles), kinetic + potential, 1e-12 * kinetic);
  guard.start(balance, particles, 2.5);
  EXPECT_NEAR(guard.supply, kinetic + potential + 2.5, 1e-12 * kinetic);
}

}  // namespace
}  // namespace spume::test
