// SPDX-License-Identifier: MIT
// What the ledger tells of a step: the traffic of its stages, held against counts by hand.
#include <gtest/gtest.h>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

double bytes_of(const Ledger& ledger, const std::string& stage) {
  for (const auto& entry : ledger.entries())
    if (entry.stage == stage) return entry.bytes;
  ADD_FAILURE() << "no stage " << stage;
  return -1;
}

// Sizes of a flat flow: particles, points with the sentinel, entries of the lists.
struct Counts {
  explicit Counts(const les_sph::Flow& flow)
      : n(static_cast<double>(flow.size())),
        points(static_cast<double>(flow.arrangement.list.points() + 1)),
        lists(flow.arrangement.list.list_bytes() + (4 + 8) * n) {}
  double n, points;
  double lists;  // bytes: entries of 4, a size of 4 and a beginning of 8 per particle
};

TEST(LesSphLedger, CountsWhatTheStagesOfAPeriodicFlowStream) {
  Simulation run(taylor_green);
  run.steps(1, 0.004);
  run.ledger.clear();  // of the start too
  run.steps(1, 0.004);
  const Counts c(run.method.flow());
  // The intermediate position, and per image a place, a source and a path.
  EXPECT_EQ(bytes_of(run.ledger, "images"),
            16 * c.n + 24 * static_cast<double>(run.method.flow().arrangement.images.size()));
  // Position, velocity and intermediate position, two doubles each.
  EXPECT_EQ(bytes_of(run.ledger, "move"), 48 * c.n);
  // Records of two coordinates in four floats, from two arrays. Out: correction (3), div r, diagonal, kernel sum and
  // concentration gradient (2) in float, a byte.
  EXPECT_EQ(bytes_of(run.ledger, "kernel moments"),
            c.lists + c.points * (8 + 8 + 16) + c.n * (4 * (3 + 1 + 1 + 1 + 2) + 1));
  // Records with a velocity. In: velocity in double, correction, shift. Out: strain, trace, what the
  // shift adds to the velocity.
  EXPECT_EQ(bytes_of(run.ledger, "gradients"), c.lists + c.points * (8 + 16) + c.n * (16 + 12 + 4 + 4 + 8 + 8));
  // Records with one value. In: q, correction, u*; out: u^{n+1}.
  EXPECT_EQ(bytes_of(run.ledger, "projection"), c.lists + c.points * (4 + 16) + c.n * (8 + 12 + 16 + 16));
}

// A residual streams q twice, r twice and b in double and the diagonal in float; a product x twice, w, y and the
// diagonal in float; records of the one take two payloads, of the other one.
TEST(LesSphLedger, CountsEveryApplicationOfThePressureMatrix) {
  Simulation run(taylor_green);
  run.steps(1, 0.004);
  const Counts c(run.method.flow());
  const double applications = run.method.flow().solver.report().applications;
  ASSERT_GE(applications, 3);
  const double product = c.lists + c.points * (4 + 16) + 20 * c.n;
  const double residual = c.lists + c.points * (8 + 16) + 44 * c.n;
  const double bytes = bytes_of(run.ledger, "pressure");
  EXPECT_GE(bytes, (applications - 1) * product + residual);
  EXPECT_LE(bytes, applications * residual);
}

TEST(LesSphLedger, CountsEveryStageInEveryStep) {
  for (const std::string model : {"mixed-scale", "dynamic-shepard", "dynamic-lagrangian"}) {
    Simulation run(dam_break, {"turbulence.model=\"" + model + "\"", "shifting.velocity_correction=\"second-order\""});
    run.steps(1, 0.002);
    const Ledger first = run.ledger;
    run.steps(1, 0.002);
    for (const Stage& stage : run.method.plan()) {
      if (!stage.on) continue;
      EXPECT_GT(bytes_of(first, stage.name), 0) << stage.name;
      if (stage.part != StagePart::start) {
        EXPECT_GT(bytes_of(run.ledger, stage.name), bytes_of(first, stage.name)) << stage.name;
      }
    }
  }
}

}  // namespace
}  // namespace spume::test
