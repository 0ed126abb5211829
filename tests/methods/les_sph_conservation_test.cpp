// SPDX-License-Identifier: MIT
// What a step conserves and what it leaves alone: mass, momentum, a uniform motion, the threads' bits.
#include <gtest/gtest.h>
#include <omp.h>

#include <numeric>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

TEST(LesSphConservation, MassIsExact) {
  for (const std::string& text : {taylor_green, taylor_green_3d, closed_box, dam_break, dam_break_3d, square_patch}) {
    Simulation run(text);
    const double before = run.series()["mass"];
    run.steps(3, std::min(run.method.step_limit().dt, 0.005));
    EXPECT_EQ(run.series()["mass"], before);
    EXPECT_EQ(run.method.step_count(), 3);
  }
}

// A particle that has left through an open side is lost.
TEST(LesSphConservation, MassIsThatOfTheParticlesInTheDomain) {
  Simulation run(square_patch, {"liquid.0.velocity=[\"10\", \"0\"]"});
  const double before = run.series()["mass"];
  EXPECT_NEAR(before, 1, 1e-12);
  run.steps(16, 0.005);  // to 1.3, of which 0.3 lies beyond the side
  EXPECT_NEAR(run.series()["mass"], 0.7, 0.06);
}

TEST(LesSphConservation, LiquidAboveAnOpenTopIsNotLost) {
  Simulation run(wave_tank + "[[liquid]]\nwhere = \"-y\"\n[[liquid]]\ncentre = [0.5, 0.35]\nradius = 0.1\n" +
                 "velocity = [\"0\", \"4\"]\n[time]\nend = 1\n");
  const double before = run.series()["mass"];
  run.steps(20, 0.0025);  // by 0.2: half of the drop stands above the top, at 0.5
  EXPECT_EQ(run.series()["mass"], before);
}

// The kernel sums tell the volume: all of them 1.08 times those of the lattice, the liquid takes 1 / 1.08 of it.
TEST(LesSphConservation, VolumeIsThatOfTheKernelSums) {
  for (const std::string& text : {taylor_green, taylor_green_3d}) {
    StagedFlow staged(text);
    staged.run_before("density relaxation", 0.004);
    for (float& sum : staged.flow.moments.kernel_sum)
      sum = static_cast<float>(1.08 * staged.flow.resolution.lattice.kernel_sum);
    staged.flow.relax_density(0.004);
    EXPECT_NEAR(staged.flow.volume, 1 / 1.08, 1e-6);
  }
  Simulation run(taylor_green);
  EXPECT_NEAR(run.series()["volume"], 1, 1e-12);
}

// On the lattice every pair has its mirror image in the field: forces cancel to rounding.
TEST(LesSphConservation, MomentumOfSymmetricVorticesStaysZeroToRounding) {
  for (const std::string& text : {taylor_green, taylor_green_3d}) {
    Simulation run(text);
    run.steps(1, 0.005);
    const State s = run.state();
    for (int axis = 0; axis < s.dimensions; ++axis) {
      double sum = 0, size = 0;
      for (const Vec3& u : s.velocity) {
        sum += u[axis];
        size += std::abs(u[axis]);
      }
      EXPECT_LE(std::abs(sum), 1e-6 * size + 1e-12) << "axis " << axis;
    }
  }
}

// The corrected gradient is not antisymmetric in a disordered arrangement: momentum drifts by its truncation error.
// Over ten steps of 0.005 that is below 1e-3 of the sum of moduli.
TEST(LesSphConservation, MomentumOfAnAsymmetricFlowDriftsLittle) {
  Simulation run(taylor_green, {"liquid.0.velocity=[\"0.3+sin(2*pi*y)+0.5*cos(4*pi*y)\", \"cos(2*pi*x)-0.2\"]"});
  const State before = run.state();
  run.steps(10, 0.005);
  const State after = run.state();
  for (int axis = 0; axis < 2; ++axis) {
    double drift = 0, size = 0;
    for (std::size_t i = 0; i < after.velocity.size(); ++i) {
      drift += after.velocity[i][axis] - before.velocity[i][axis];
      size += std::abs(before.velocity[i][axis]);
    }
    RecordProperty("drift_" + std::to_string(axis), std::to_string(drift / size));
    EXPECT_LE(std::abs(drift), 1e-3 * size);
  }
}

// A frame that moves by whole spacings a step sees the same arrangement: what differs is the rounding of float
// velocities, 2^-24 (u + U) over a spacing in a derivative, taken up by the projection within a factor of some tens.
TEST(LesSphConservation, AMovingFrameSeesTheSameFlow) {
  const double dt = 0.005, frame = 1;
  const Overrides tight{"pressure.tolerance=1e-10"};
  Simulation rest(taylor_green, tight);
  Overrides moving_frame = tight;
  moving_frame.push_back("liquid.0.velocity=[\"1-cos(2*pi*x)*sin(2*pi*y)\", \"sin(2*pi*x)*cos(2*pi*y)\"]");
  Simulation moving(taylor_green, moving_frame);
  const int steps = 5;
  rest.steps(steps, dt);
  moving.steps(steps, dt);
  const State a = rest.state(), b = moving.state();
  double worst_velocity = 0, worst_position = 0, worst_pressure = 0;
  for (std::size_t i = 0; i < a.velocity.size(); ++i) {
    worst_velocity = std::max({worst_velocity, std::abs(b.velocity[i][0] - frame - a.velocity[i][0]),
                               std::abs(b.velocity[i][1] - a.velocity[i][1])});
    double dx = b.position[i][0] - a.position[i][0] - frame * dt * steps;
    dx -= std::round(dx);
    worst_position = std::max({worst_position, std::abs(dx), std::abs(b.position[i][1] - a.position[i][1])});
    worst_pressure = std::max(worst_pressure, std::abs(b.pressure[i] - a.pressure[i]));
  }
  RecordProperty("velocity", std::to_string(worst_velocity * 1e6) + "e-6");
  EXPECT_LT(worst_velocity, 1e-5);
  EXPECT_LT(worst_position, 1e-6);
  EXPECT_LT(worst_pressure, 1e-3);  // an error of a divergence over dt
}

TEST(LesSphConservation, OneAndTwoThreadsGiveTheSameBits) {
  const int threads = omp_get_max_threads();
  for (const std::string& text : {taylor_green, taylor_green_3d, dam_break}) {
    const auto run = [&](int count) {
      omp_set_num_threads(count);
      Simulation r(text);
      r.steps(4, 0.004);
      return r.state();
    };
    const State one = run(1), two = run(2);
    omp_set_num_threads(threads);
    EXPECT_TRUE(one == two);
  }
}

std::string invariants_of(const std::string& text, const Overrides& overrides = {}) {
  std::string names;
  for (const Invariant& one : Simulation(text, overrides).method.invariants()) names += one.quantity + " ";
  return names;
}

// Energy has a bound where the work of all forces is known.
TEST(LesSphInvariants, AreStatedWhereTheyHold) {
  const std::string momentum = "momentum_x_change momentum_y_change ";
  EXPECT_EQ(invariants_of(taylor_green), "mass_drift volume_drift " + momentum + "energy_growth pressure_residual ");
  EXPECT_EQ(invariants_of(taylor_green, {"pressure.density_relaxation=1e6"}),
            "mass_drift " + momentum + "energy_growth pressure_residual ");
  EXPECT_EQ(invariants_of(dam_break), "mass_drift volume_drift energy_growth pressure_residual ");
  EXPECT_EQ(invariants_of(cavity), "mass_drift volume_drift pressure_residual ");
  for (const char* obstacle : {"[[solid]]\nlower = [0.4, 0.4]\nupper = [0.6, 0.6]\n",
                               "[[body]]\nshape = \"ball\"\nradius = 0.2\nposition = [0.5, 0.5]\nwall = \"no-slip\"\n"})
    EXPECT_EQ(invariants_of(taylor_green + obstacle).find("momentum"), std::string::npos);
  for (const char* forced : {"forces.body=[\"1\", \"0\"]", "forces.body=[\"sin(2*pi*y)\", \"0\"]", "fluid.froude=1"})
    EXPECT_EQ(invariants_of(taylor_green, {forced}), "mass_drift volume_drift energy_growth pressure_residual ");
}

// A compressible liquid stores energy in its pressure, p^2 / (2 rho c^2), which the columns leave out.
TEST(LesSphInvariants, CountTheEnergyThatThePressureStores) {
  Simulation run(dam_break), incompressible(dam_break, {"fluid.mach=0"});
  run.steps(2, 0.002);
  double squares = 0;
  for (const double p : run.state().pressure) squares += p * p;
  const Invariant energy = run.method.invariants().at(2);
  ASSERT_EQ(energy.quantity, "energy_growth");
  EXPECT_NEAR(energy.beside(), squares * 0.05 * 0.05 / (2 * 20 * 20), 1e-12);
  EXPECT_FALSE(incompressible.method.invariants().at(2).beside);
}

}  // namespace
}  // namespace spume::test
