// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/particle_system.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <vector>

#include "spume/core/error.hpp"

namespace spume::test {
namespace {

PeriodicGrid small_grid() {
  PeriodicGrid grid;
  grid.lower = {0, -1, 0};
  grid.length = {1, 2, 1};
  grid.points = {12, 24, 12};
  grid.z_stride = 14;
  return grid;
}

// A cellular flow that turns with time; spline coefficients are not needed for what is tested here.
struct Flow {
  std::array<std::vector<double>, 3> u;
  Flow(const PeriodicGrid& g, double t) {
    for (int c = 0; c < 3; ++c) {
      u[c].resize(g.storage());
      for (int i = 0; i < g.points[0]; ++i)
        for (int j = 0; j < g.points[1]; ++j)
          for (int k = 0; k < g.points[2]; ++k)
            u[c][g.row(i, j) + static_cast<std::size_t>(k)] =
                std::sin(2 * M_PI * (c == 0 ? j / 24.0 : i / 12.0) + t) + std::cos(2 * M_PI * k / 12.0 - c * t);
    }
  }
  std::array<const double*, 3> data() const { return {u[0].data(), u[1].data(), u[2].data()}; }
};

PointParticleOptions bubbles(Coupling coupling) {
  PointParticleOptions options;
  options.count = 3000;
  options.placement.diameters = {0.04};
  options.motion.beta = 3;
  options.motion.response_time = 0.05;
  options.coupling = coupling;
  options.sort_every = 3;
  return options;
}

struct Suspension {
  PeriodicGrid grid = small_grid();
  ParticleSystem system;
  std::array<std::vector<double>, 3> force;
  int steps = 0;

  explicit Suspension(const PointParticleOptions& options) : system(grid, options) {
    for (auto& f : force) f.resize(grid.storage());
  }
  void take_velocity() { system.take_velocity(Flow(grid, 0.1 * steps).data()); }
  void spread_force() { system.spread_force<double>({force[0].data(), force[1].data(), force[2].data()}); }
  void begin() {
    take_velocity();
    system.sort();
    system.start();
  }
  void advance(int count) {
    for (int s = 0; s < count; ++s) {
      if (system.couples()) spread_force();
      ++steps;
      if (system.sort_due()) system.sort();
      take_velocity();
      system.move(0.01);
      if (system.collides()) system.collide();
    }
  }
  double total_force(int c) const {
    double sum = 0;
    for (int i = 0; i < grid.points[0]; ++i)
      for (int j = 0; j < grid.points[1]; ++j)
        for (int k = 0; k < grid.points[2]; ++k) sum += force[c][grid.row(i, j) + static_cast<std::size_t>(k)];
    return sum * grid.cell_volume();
  }
};

TEST(ParticleSystem, StartsWithTheVelocityOfTheFluid) {
  Suspension run(bubbles(Coupling::one_way));
  run.begin();
  SplineField<float> field(run.grid, 4);
  field.fill(Flow(run.grid, 0).data());
  std::array<std::vector<double>, 3> u;
  for (auto& v : u) v.resize(3000);
  gather(field, 3000, run.system.particles().positions(), {u[0].data(), u[1].data(), u[2].data()}, nullptr);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < 3000; ++i) ASSERT_EQ((*run.system.particles().velocity[c])[i], u[c][i]);
}

TEST(ParticleSystem, KeepsEveryParticleThroughSorting) {
  Suspension run(bubbles(Coupling::four_way));
  run.begin();
  run.advance(10);
  std::vector<int> seen(3000, 0);
  for (const std::int64_t id : *run.system.particles().identifier) ++seen[static_cast<std::size_t>(id)];
  for (const int times : seen) ASSERT_EQ(times, 1);
}

// What particle i does must not depend on how often they are sorted, nor on the number of threads.
TEST(ParticleSystem, MotionDependsNeitherOnSortingNorOnThreads) {
  const int before = omp_get_max_threads();
  std::array<std::vector<double>, 3> place;
  for (int r = 0; r < 3; ++r) {
    omp_set_num_threads(r == 1 ? 3 : 1);
    PointParticleOptions options = bubbles(Coupling::four_way);
    options.sort_every = r == 2 ? 1 : 3;
    Suspension run(options);
    run.begin();
    run.advance(7);
    place[r].resize(9000);
    for (std::size_t i = 0; i < 3000; ++i)
      for (int c = 0; c < 3; ++c)
        place[r][3 * static_cast<std::size_t>((*run.system.particles().identifier)[i]) + c] =
            (*run.system.particles().position[c])[i];
  }
  omp_set_num_threads(before);
  for (std::size_t i = 0; i < 9000; ++i) {
    ASSERT_EQ(place[0][i], place[1][i]);
    ASSERT_EQ(place[0][i], place[2][i]);
  }
}

TEST(ParticleSystem, TheGridReceivesTheForceOfTheParticles) {
  PointParticleOptions options = bubbles(Coupling::two_way);
  options.max_volume_fraction = 1e9;
  options.scheme.lead = 0;
  Suspension run(options);
  run.begin();
  run.advance(5);
  run.spread_force();
  for (int c = 0; c < 3; ++c) {
    double given = 0, size = 0;
    for (const double f : *run.system.particles().force[c]) {
      given += f;
      size += std::abs(f);
    }
    EXPECT_GT(size, 0);
    EXPECT_NEAR(run.total_force(c), given, 1e-13 * size);
  }
}

TEST(ParticleSystem, ContinuesBitForBitFromItsState) {
  Suspension whole(bubbles(Coupling::four_way)), first(bubbles(Coupling::four_way)),
      second(bubbles(Coupling::four_way));
  whole.begin();
  whole.advance(9);
  first.begin();
  first.advance(4);
  auto from = first.system.state();
  auto to = second.system.state();
  ASSERT_EQ(from.size(), to.size());
  for (std::size_t a = 0; a < from.size(); ++a) {
    ASSERT_EQ(from[a].name, to[a].name);
    if (from[a].f64 != nullptr) *to[a].f64 = *from[a].f64;
    if (from[a].i64 != nullptr) *to[a].i64 = *from[a].i64;
  }
  second.steps = first.steps;
  second.take_velocity();
  second.advance(5);
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < 3000; ++i) {
      ASSERT_EQ((*whole.system.particles().position[c])[i], (*second.system.particles().position[c])[i]);
      ASSERT_EQ((*whole.system.particles().velocity[c])[i], (*second.system.particles().velocity[c])[i]);
    }
    ASSERT_EQ(whole.force[c], second.force[c]);
  }
}

TEST(ParticleSystem, FrozenParticlesStayWhereTheyAreWhateverTheirCoupling) {
  for (const Coupling coupling : {Coupling::two_way, Coupling::four_way, Coupling::colliding}) {
    PointParticleOptions options = bubbles(coupling);
    options.motion.frozen = true;
    options.sort_every = 1000;
    Suspension run(options);
    run.begin();
    const auto before = run.system.particles().positions();
    std::array<std::vector<double>, 3> at;
    for (int c = 0; c < 3; ++c) at[c].assign(before[c], before[c] + run.system.size());
    run.advance(3);
    // 3000 spheres fill 5 %: many overlap, and collisions would part them.
    const auto after = run.system.particles().positions();
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < run.system.size(); ++i) ASSERT_EQ(after[c][i], at[c][i]);
  }
}

TEST(ParticleSystem, AllocatesNothingInASteadyStep) {
  Suspension run(bubbles(Coupling::four_way));
  run.begin();
  run.advance(8);
  const auto before = array_statistics().allocations;
  run.advance(8);
  EXPECT_EQ(array_statistics().allocations, before);
}

TEST(ParticleSystem, HoldsNoArraysThatItsCouplingDoesNotNeed) {
  Suspension alone(bubbles(Coupling::one_way));
  EXPECT_FALSE(alone.system.particles().fields.has("force_x"));
  EXPECT_FALSE(alone.system.particles().fields.has("diameter"));
  EXPECT_EQ(alone.system.arrays().size(), 3U);
  // 200 bytes a particle with everything on, beside the fields.
  Suspension all(bubbles(Coupling::four_way));
  all.begin();
  all.advance(4);
  double bytes = 0;
  for (const auto& array : all.system.arrays())
    if (array.name != "velocity records") bytes += array.bytes;
  // Planes of the deposition, and cells: those of the grid or of the collisions, and of the blocks of the sort.
  const double per_thread = 2 * 8.0 * 4 * (12 + 4) * 24 * omp_get_max_threads();
  const double cells = 4.0 * (2 * 12 * 24 * 12 + 3 * 24 + 100);
  EXPECT_LT((bytes - per_thread - cells) / 3000, 200);
  EXPECT_NEAR(ParticleSystem::estimated_bytes(all.grid, bubbles(Coupling::four_way)),
              bytes - per_thread + 32.0 * (15 * 27 * 15), 0.1 * bytes);
}

TEST(ParticleSystem, ExtremeResponseTimesStayFinite) {
  for (const double tau : {1e-8, 1e6}) {
    PointParticleOptions options = bubbles(Coupling::four_way);
    options.motion.response_time = tau;
    Suspension run(options);
    run.begin();
    run.advance(30);
    EXPECT_TRUE(std::isfinite(run.system.motion().max_speed)) << tau;
    EXPECT_LT(run.system.motion().max_speed, 20) << tau;
  }
}

TEST(ParticleSystem, PlacesOnALatticeInClustersOrAsGiven) {
  PointParticleOptions options = bubbles(Coupling::one_way);
  options.placement.kind = Placement::lattice;
  options.count = 2 * 5 * 5 * 5;
  ParticleSystem lattice(small_grid(), options);
  EXPECT_EQ((*lattice.particles().position[1])[7], -1 + 0.2);
  EXPECT_EQ((*lattice.particles().position[2])[7], 0.4);
  options.count = 251;
  EXPECT_THROW(ParticleSystem(small_grid(), options), InputError);
  options.placement.kind = Placement::file;
  options.count = 2;
  options.placement.given = {{0.5, 1.5, 0.25}, {-0.25, 0, 0}};
  ParticleSystem given(small_grid(), options);
  EXPECT_EQ((*given.particles().position[1])[0], -0.5);
  EXPECT_EQ((*given.particles().position[0])[1], 0.75);
  options.count = 3;
  EXPECT_THROW(ParticleSystem(small_grid(), options), InputError);
}

TEST(ParticleSystem, DrawsDiametersByTheirShares) {
  PointParticleOptions options = bubbles(Coupling::one_way);
  options.placement.diameters = {0.02, 0.04};
  options.placement.shares = {3, 1};
  ParticleSystem system(small_grid(), options);
  int large = 0;
  for (const double d : *system.particles().diameter) large += d == 0.04 ? 1 : 0;
  // A quarter of 3000, with a standard deviation of 24.
  EXPECT_NEAR(large, 750, 4 * 24);
}

}  // namespace
}  // namespace spume::test
