// SPDX-License-Identifier: MIT
// Scalars, oxygen and sludge that pass the inflows and outflows of wcsph.
#include <gtest/gtest.h>

#include "methods/wcsph_openings_run.hpp"

namespace spume::test {

// Rates are floats of what is a sum to zero: D dt / h^2 = 4 of the differences between neighbours, 0.05, while a
// particle passes, each to 6e-8; near the inflow the layers are as old as a step, dt = 4e-3 at most.
TEST(WcsphOpeningsSolutes, TheyBringScalarsAndTakeThemOut) {
  WcsphRun run(stream + carried + unled);
  until(run, 2);
  const wcsph::Flow& flow = run.method.flow();
  const Array<double>&dye = flow.solutes.scalars->values(0), &silt = flow.solutes.scalars->values(1);
  for (std::size_t i = 0; i < flow.size(); ++i) {
    if (!flow.in_domain(i)) continue;
    EXPECT_NEAR(dye[i], 3 - (*flow.particles.position[0])[i] + flow.time, 1e-4);
    EXPECT_NEAR(silt[i], 1 + (*flow.particles.position[1])[i], 1e-4);
  }
  auto series = run.series();
  EXPECT_NEAR(series.at("amount_of_dye"), 0.5 * (3 - 0.5) + series.at("openings_gave_dye"), 1e-10);
  EXPECT_NEAR(series.at("openings_gave_dye"), 0.5 * 2, 0.5 * 0.05);  // to half of a layer at each side
}

// Liquid that a pressure outside drives back through the outflow, seven layers of it, brings what left with it, row by
// row: what stands behind the side is a copy of what came back before it, of its height. Nothing diffuses, rows stay.
TEST(WcsphOpeningsSolutes, WhatComesBackBringsItsScalars) {
  WcsphRun run(between_outflows + unled, {"compressibility.max_speed=0.3", "resolution.spacing=0.0625"});
  const wcsph::Flow& flow = run.method.flow();
  const double start = run.series().at("amount_of_silt");
  const auto first_newcomer = static_cast<std::int64_t>(flow.size());
  until(run, 20);
  std::size_t newcomers = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    if (!flow.in_domain(i)) continue;
    EXPECT_NEAR(flow.solutes.scalars->values(0)[i], 1 + (*flow.particles.position[1])[i], 0.1 * 0.0625);
    newcomers += (*flow.particles.identifier)[i] >= first_newcomer ? 1 : 0;
  }
  EXPECT_GT(newcomers, 15U) << "two layers that were made up for behind the side";
  auto series = run.series();
  EXPECT_NEAR(series.at("amount_of_silt"), start + series.at("openings_gave_silt"), 1e-12);
}

// The jet of an inflow above the liquid has the values of the nearest liquid, not those of any particle.
TEST(WcsphOpeningsSolutes, WhatEntersAboveTheLiquidHasTheValuesOfTheNearest) {
  WcsphRun run(tank_half_full +
                   "[[inflow]]\nside = \"right\"\nlower = [1, 0.5]\nupper = [1, 0.7]\nvelocity = [\"-0.5\", \"0\"]\n"
                   "[[scalar]]\nname = \"silt\"\ninitial = \"x < 0.5 ? 1 : 2\"\n",
               {"region.0.upper=[1, 0.3]"});
  until(run, 0.3);
  const wcsph::Flow& flow = run.method.flow();
  std::size_t jet = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    if ((*flow.particles.position[1])[i] < 0.45) continue;
    EXPECT_EQ(flow.solutes.scalars->values(0)[i], 2);
    ++jet;
  }
  EXPECT_GT(jet, 12U);
}

// An inflow that stands still gives what it has now, one that comes to rest nothing of beyond the end of the run.
TEST(WcsphOpeningsSolutes, InflowsThatStandStillGiveWhatTheyHave) {
  const std::string paused = replaced(stream, "velocity = [\"1\", \"0\"]\n[[outflow]]",
                                      "velocity = [\"t < 0.05 ? 0 : 0.2\", \"0\"]\n[[outflow]]");
  for (const char* diffusivity : {"0", "1e-5", "0.1"}) {
    WcsphRun run(paused + "[[scalar]]\nname = \"dye\"\ninitial = \"1\"\ninflow = \"sqrt(1 - t)\"\ndiffusivity = " +
                     diffusivity + "\n",
                 {"time.end=1"});
    const wcsph::Flow& flow = run.method.flow();
    const auto each_layer = [&](auto&& check) {
      for (std::size_t i = 0; i < flow.size(); ++i)
        if (!flow.in_domain(i) && flow.openings->leads(i)) check(flow.solutes.scalars->values(0)[i]);
    };
    const double rest = run.method.step_limit().dt;
    run.steps(1, rest);
    each_layer([&](double value) { EXPECT_EQ(value, std::sqrt(1 - rest)) << diffusivity; });
    until(run, 0.2);
    each_layer([&](double value) { EXPECT_LE(value, std::sqrt(1 - 0.2)) << diffusivity; });
    for (std::size_t i = 0; i < flow.size(); ++i) EXPECT_TRUE(std::isfinite(flow.solutes.scalars->values(0)[i]));
  }
}

const std::string sludge = R"toml([biokinetics]
model = "asm1"
[[scalar]]
name = "X_BH"
initial = "2500"
[[scalar]]
name = "S_S"
initial = "10"
[[scalar]]
name = "S_NH"
initial = "2"
[[scalar]]
name = "S_ALK"
initial = "4"
)toml";

// What stands behind an outflow has left.
TEST(WcsphOpeningsSolutes, SludgeThatHasLeftDoesNotReact) {
  WcsphRun run(below_surface + "[[scalar]]\nname = \"S_O\"\ninitial = \"2\"\ninflow = \"4\"\n[oxygen]\n" + sludge,
               {"biokinetics.interval=1e-6"});
  const wcsph::Flow& flow = run.method.flow();
  const auto oxygen_behind = [&] {
    std::map<std::int64_t, double> values;
    for (std::size_t i = 0; i < flow.size(); ++i)
      if (!flow.in_domain(i) && !flow.openings->leads(i))
        values[(*flow.particles.identifier)[i]] = flow.solutes.scalars->values(0)[i];
    return values;
  };
  run.steps(1, run.method.step_limit().dt);
  const std::map<std::int64_t, double> before = oxygen_behind();
  const double uptake = run.series().at("oxygen_uptake");
  run.steps(1, run.method.step_limit().dt);
  EXPECT_GT(run.series().at("oxygen_uptake"), uptake);
  std::size_t stayed = 0;
  for (const auto& [identifier, value] : oxygen_behind()) {
    const auto found = before.find(identifier);
    if (found == before.end()) continue;
    EXPECT_EQ(value, found->second);
    ++stayed;
  }
  EXPECT_GT(stayed, 10U);
}

// Oxygen of the air, of what enters, and what sludge takes of it.
TEST(WcsphOpeningsSolutes, OxygenAndSludgeOfTheStreamBalance) {
  WcsphRun run(below_surface + R"toml([oxygen]
surface_k_l = 1e-2
[[scalar]]
name = "S_O"
initial = "2"
inflow = "4"
diffusivity = 0.01
)toml" + sludge);
  const double start = run.series().at("amount_of_S_O");
  until(run, 0.2);
  auto series = run.series();
  EXPECT_GT(series.at("openings_gave_S_O"), 0.01);
  EXPECT_GT(series.at("oxygen_from_surface"), 1e-4);
  EXPECT_GT(series.at("oxygen_uptake"), 1e-6);
  EXPECT_NEAR(series.at("amount_of_S_O"),
              start + series.at("openings_gave_S_O") + series.at("oxygen_from_surface") - series.at("oxygen_uptake"),
              1e-12);
}

}  // namespace spume::test
