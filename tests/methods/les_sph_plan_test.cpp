// SPDX-License-Identifier: MIT
// A scene pays for nothing it does not use: neither a stage nor an array.
#include <gtest/gtest.h>

#include <set>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

std::set<std::string> arrays_of(Simulation& run) {
  std::set<std::string> names;
  for (const ArrayInfo& array : run.method.arrays())
    if (array.bytes > 0) names.insert(array.name);
  return names;
}

bool runs(const Simulation& run, const std::string& stage) {
  for (const Stage& s : run.method.plan())
    if (s.name == stage) return s.on;
  ADD_FAILURE() << "no stage '" << stage << "'";
  return false;
}

bool any_contains(const std::set<std::string>& names, const std::string& part) {
  for (const std::string& name : names)
    if (name.find(part) != std::string::npos) return true;
  return false;
}

TEST(LesSphPlan, TwoDimensionsHaveNoThirdComponent) {
  for (const std::string& text : {taylor_green, dam_break, square_patch}) {
    Simulation run(text);
    run.steps(2, 0.004);
    for (const std::string& name : arrays_of(run)) EXPECT_FALSE(name.ends_with("_z")) << name;
  }
  Simulation run(taylor_green_3d);
  run.steps(1, 0.004);
  EXPECT_TRUE(arrays_of(run).contains("position_z"));
}

TEST(LesSphPlan, APeriodicBoxHasNoSurface) {
  Simulation run(taylor_green);
  run.steps(2, 0.004);
  const auto arrays = arrays_of(run);
  EXPECT_FALSE(runs(run, "surface"));
  EXPECT_FALSE(any_contains(arrays, "normal"));
  EXPECT_FALSE(any_contains(arrays, "eddy_viscosity"));
  EXPECT_FALSE(any_contains(arrays, "potential"));
  EXPECT_FALSE(any_contains(arrays, "average"));
  EXPECT_TRUE(runs(run, "images"));
}

// Bends behind no-slip bodies alone are left out of the change by the shift, which takes a sweep of its own.
TEST(LesSphPlan, FreeSlipBodiesHaveOneSweepOfGradients) {
  const auto gradients = [](const std::string& wall) {
    Simulation run(taylor_green + "[[body]]\nshape = \"cylinder\"\nradius = 0.15\nposition = [0.5, 0.5]\nwall = \"" +
                   wall + "\"\n");
    run.steps(2, 0.002);
    for (const Ledger::Entry& entry : run.ledger.entries())
      if (entry.stage == "gradients") return entry;
    ADD_FAILURE() << "no gradients";
    return Ledger::Entry{};
  };
  const Ledger::Entry one = gradients("free-slip"), two = gradients("no-slip");
  EXPECT_GT(one.pairs, 0);
  EXPECT_NEAR(two.pairs, 2 * one.pairs, 0.01 * one.pairs);  // the shift of the second step differs
  EXPECT_GT(two.bytes, 1.3 * one.bytes);
}

TEST(LesSphPlan, EveryStageHasItsArraysOnlyWhenItRuns) {
  Simulation plain(taylor_green, {"shifting.on=false", "time.centred=false"});
  plain.steps(2, 0.004);
  const auto without = arrays_of(plain);
  EXPECT_FALSE(runs(plain, "shift"));
  EXPECT_FALSE(runs(plain, "gradients"));
  EXPECT_FALSE(runs(plain, "shift curvature"));
  EXPECT_FALSE(any_contains(without, "shift"));
  EXPECT_FALSE(any_contains(without, "velocity_gradient"));
  EXPECT_FALSE(any_contains(without, "strain"));

  const auto leases = [](const std::string& change, auto array) {
    StagedFlow staged(taylor_green, {change});
    staged.run_before("prediction", 0.004);
    return !array(staged.flow).empty();
  };
  const auto shift_velocity = [](const les_sph::Flow& flow) -> const auto& {
    return flow.shift_velocity[0];
  };
  const auto filtered_velocity = [](const les_sph::Flow& flow) -> const auto& {
    return flow.filtered_velocity[0];
  };
  const auto velocity_gradient = [](const les_sph::Flow& flow) -> const auto& {
    return flow.velocity_gradient[0];
  };
  EXPECT_FALSE(leases("shifting.velocity_correction=\"none\"", shift_velocity));
  EXPECT_TRUE(leases("shifting.velocity_correction=\"first-order\"", shift_velocity));

  Simulation first_order(taylor_green);
  EXPECT_FALSE(runs(first_order, "shift curvature"));

  Simulation smagorinsky(taylor_green, {"turbulence.model=\"smagorinsky\""});
  smagorinsky.steps(2, 0.004);
  EXPECT_TRUE(any_contains(arrays_of(smagorinsky), "eddy_viscosity"));
  EXPECT_FALSE(leases("turbulence.model=\"smagorinsky\"", filtered_velocity));
  EXPECT_TRUE(leases("turbulence.model=\"mixed-scale\"", filtered_velocity));

  Simulation lagrangian(taylor_green, {"turbulence.model=\"dynamic-lagrangian\""});
  lagrangian.steps(2, 0.004);
  EXPECT_TRUE(any_contains(arrays_of(lagrangian), "average"));

  // Components of the gradient are kept for those alone who read them.
  for (const auto& [change, kept] : {std::pair{"turbulence.model=\"smagorinsky\"", false},
                                     {"turbulence.model=\"mixed-scale\"", false},
                                     {"turbulence.model=\"dynamic-shepard\"", true},
                                     {"turbulence.model=\"dynamic-lagrangian\"", true},
                                     {"shifting.velocity_correction=\"second-order\"", true}})
    EXPECT_EQ(leases(change, velocity_gradient), kept) << change;
}

TEST(LesSphPlan, AnOpenInviscidPatchNeedsNeitherImagesNorViscosityNorPotential) {
  Simulation run(square_patch);
  run.steps(2, 0.004);
  EXPECT_FALSE(runs(run, "images"));
  EXPECT_FALSE(runs(run, "viscosity"));
  EXPECT_FALSE(runs(run, "forces"));
  EXPECT_TRUE(runs(run, "surface"));
  const auto arrays = arrays_of(run);
  EXPECT_FALSE(arrays.contains("images"));
  EXPECT_FALSE(any_contains(arrays, "potential"));
}

// Its own array: the divergence is that of a step.
TEST(LesSphPlan, TheFirstPressureHasItsOwnSource) {
  StagedFlow before(square_patch), after(square_patch);  // without forces, which add their divergence
  before.start_before("first source");
  after.start_before("matrix");
  EXPECT_TRUE(after.flow.divergence.empty());
  ASSERT_EQ(after.flow.first_source.size(), after.flow.size());
  for (std::size_t i = 0; i < after.flow.size(); ++i)
    EXPECT_EQ(after.flow.first_source[i], double{before.flow.gradient_trace[i]});
}

// What is printed as the plan is what ran, in its order, and the ledger knows what each stage reads and writes.
TEST(LesSphPlan, IsWhatTheLedgerTimes) {
  const std::vector<std::pair<std::string, Overrides>> scenes{
      {taylor_green, {}},
      {taylor_green, {"shifting.on=false", "time.centred=false", "pressure.density_relaxation=1e6"}},
      {taylor_green, {"turbulence.model=\"dynamic-lagrangian\"", "shifting.velocity_correction=\"second-order\""}},
      {cavity, {"pressure.preconditioner=\"jacobi\""}},
      {dam_break, {}},
      {dam_break_3d, {}},
      {square_patch, {}}};
  for (const auto& [text, overrides] : scenes) {
    Simulation run(text, overrides);
    run.steps(1, 0.002);
    std::vector<std::string> planned, timed;
    for (const Stage& stage : run.method.plan())
      if (stage.on) planned.push_back(stage.name);
    for (const auto& entry : run.ledger.entries()) timed.push_back(entry.stage);
    EXPECT_EQ(timed, planned) << text;
    EXPECT_EQ(uncounted_stages(run.method, run.ledger), "") << text;
    for (const Stage& stage : run.method.plan()) EXPECT_FALSE(stage.reason.empty()) << stage.name;
  }
}

}  // namespace
}  // namespace spume::test
