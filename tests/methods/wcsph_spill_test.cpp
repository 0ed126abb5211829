// SPDX-License-Identifier: MIT
// What leaves wcsph through open sides.
#include <gtest/gtest.h>

#include "methods/wcsph_openings_run.hpp"

namespace spume::test {
namespace {

using ::testing::HasSubstr;

const std::string without_bottom = replaced(tank_half_full, "bottom = \"free-slip\"\n", "");

TEST(WcsphSpill, LiquidThatFallsOutIsToldAndRemoved) {
  WcsphRun run(without_bottom, {"region.0.lower=[0, 0.2]"});
  ASSERT_EQ(run.loaded.options.warnings.size(), 1U);
  EXPECT_THAT(run.loaded.options.warnings[0].text, HasSubstr("nothing holds the liquid: domain.bottom is open"));
  const double mass = 1000 * run.method.flow().particles.volume * static_cast<double>(run.method.flow().size());
  until(run, 1.1);  // all have fallen by 0.6, the lowest past the bottom by more than a support radius
  std::string remarks;
  for (const Remark& remark : run.method.take_remarks()) remarks += remark.text;
  const wcsph::Flow& flow = run.method.flow();
  EXPECT_GT(flow.size(), 0U);
  EXPECT_GT(run.series().at("mass_removed"), 0);
  EXPECT_NEAR(run.series().at("mass_removed") + 1000 * flow.particles.volume * static_cast<double>(flow.size()), mass,
              1e-12 * mass);
  EXPECT_THAT(remarks, HasSubstr("liquid leaves through an open side from t = "));
  EXPECT_TRUE(run.method.take_remarks().empty()) << "told once";
  for (std::size_t i = 0; i < flow.size(); ++i)
    EXPECT_GT((*flow.particles.position[1])[i], -flow.arrangement.grid.support_radius() - 2 * flow.skin);

  MemoryState saved;
  run.method.save(saved);
  WcsphRun restored(without_bottom, {"region.0.lower=[0, 0.2]"});
  restored.method.load(saved);
  until(run, 2);
  until(restored, 2);
  EXPECT_EQ(flow.size(), 0U);
  EXPECT_EQ(restored.series().at("mass_removed"), mass);
}

// Of an inflow and an open side beside it: what has left by the one way and by the other is in the balance.
TEST(WcsphSpill, IsInTheBalanceOfOpenings) {
  WcsphRun run(replaced(below_surface, "bottom = \"free-slip\"\n", "bottom = \"open\"\n"));
  ASSERT_EQ(run.method.invariants().size(), 1U);
  const auto inside_and_left = [&] { return run.series().at("volume_water") + run.method.invariants()[0].beside(); };
  const double start = inside_and_left();
  until(run, 1.2);
  EXPECT_GT(run.method.flow().spill.count(), 50);
  EXPECT_NEAR(inside_and_left(), start, 4e-16 * start);
}

TEST(WcsphSpill, IsNotLookedForWhereNothingCanLeave) {
  EXPECT_EQ(WcsphRun(tank_half_full).series().count("mass_removed"), 0U);
}

}  // namespace
}  // namespace spume::test
