// SPDX-License-Identifier: MIT
// gfd with inflows and outflows between steps: the same for any number of threads, restored to the bit, volumes that
// balance; and what it refuses.
#include <gmock/gmock.h>
#include <omp.h>

#include "methods/gfd_openings_run.hpp"

namespace spume::test {
namespace {

using testing::HasSubstr;

TEST(GfdOpeningsState, IsTheSameForAnyNumberOfThreadsAndResumesBitForBit) {
  const auto state_after = [&](int threads) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    GfdRun run(gfd_drop_in_a_stream, {"fluid.gravity=0.5"});
    run.until(0.5);
    omp_set_num_threads(before);
    return run.saved_state();
  };
  const auto whole = state_after(1);
  EXPECT_EQ(whole, state_after(3));
  GfdRun first(gfd_drop_in_a_stream, {"fluid.gravity=0.5"});
  first.steps(40, 0.005);
  MemoryState saved;
  first.method.save(saved);
  GfdRun second(gfd_drop_in_a_stream, {"fluid.gravity=0.5"});
  second.method.load(saved);
  second.series();  // who looks at a state does not change it
  first.steps(40, 0.005);
  second.steps(40, 0.005);
  EXPECT_EQ(first.saved_state(), second.saved_state());
  EXPECT_EQ(first.series(), second.series());
}

TEST(GfdOpeningsState, EveryStageCountsItsTraffic) {
  GfdRun run(gfd_drop_in_a_stream);
  run.steps(3, 0.005);
  EXPECT_EQ(uncounted_stages(run.method, run.ledger), "");
}

// Not the particles of the layers: neither the speed of the inflow nor what stands behind it.
TEST(GfdOpeningsState, SeriesAreOfTheDomain) {
  GfdRun run(
      gfd_stream_with_air("lower = [0.8, 0]\n"),
      {"region.0.velocity=[\"0\", \"0\"]", "region.1.velocity=[\"0\", \"0\"]", "inflow.0.velocity=[\"0.5*t\", \"0\"]"});
  run.steps(2, 0.005);
  auto series = run.series();
  EXPECT_NEAR(series["volume_air"], 0.1, 1e-12);
  EXPECT_NEAR(series["volume_water"], 0.4, 1e-12);
  EXPECT_NEAR(series["centre_air_x"], 0.9, 0.001);
  EXPECT_NEAR(series["interface_area"], 0.5, 0.02);  // one of two: a mirror of it stands behind the outflow
  double kinetic = 0;
  for (std::size_t i = 0; i < run.flow().size(); ++i)
    if (run.flow().in_domain(i)) kinetic += run.flow().mass(i) * squared_norm(run.flow().particles.velocity, 2, i) / 2;
  EXPECT_EQ(series["kinetic_energy"], kinetic);
}

// A bubble grows on a slot in the floor while the air above leaves: what is inside, in and out balances to a particle.
// At 100:1: at 1000:1 five of seventy such runs, with flow rates 0.3 % apart, end in steps that vanish.
TEST(GfdOpeningsState, VolumesBalance) {
  const std::string text = R"toml(method = "gfd"
[domain]
lower = [-1, 0]
upper = [1, 2]
left = "free-slip"
right = "free-slip"
bottom = "no-slip"
[resolution]
spacing = 0.1
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1
viscosity = 0.02
[[phase]]
name = "air"
density = 0.01
viscosity = 2e-5
[interface]
surface_tension = 0.1
[[region]]
phase = "air"
[[region]]
phase = "water"
upper = [1, 1.5]
[[inflow]]
side = "bottom"
lower = [-0.2, 0]
upper = [0.2, 0]
flow_rate = 0.1
phase = "air"
[[outflow]]
side = "top"
[time]
end = 2
)toml";
  GfdRun run(text);
  auto start = run.series();
  run.until(2);
  auto series = run.series();
  EXPECT_NEAR(series["volume_in_air"], 0.2, 4 * 0.1 * 0.1 * 0.5 + 1e-9);
  EXPECT_NEAR(series["volume_out_air"], series["volume_in_air"], 0.03);
  EXPECT_EQ(series["volume_out_water"], 0);
  for (const std::string name : {"water", "air"})
    EXPECT_NEAR(series["volume_" + name],
                start["volume_" + name] + series["volume_in_" + name] - series["volume_out_" + name], 1e-12);
}

TEST(GfdOpeningsState, WhatItCannotDoIsRefusedInWords) {
  const auto refusal_of = [](const std::string& text, const Overrides& overrides = {}) -> std::string {
    try {
      GfdRun run(text, overrides);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string closed =
      replaced(replaced(gfd_stream, "[[outflow]]\nside = \"right\"\n", ""), "bottom", "right = \"free-slip\"\nbottom");
  EXPECT_THAT(refusal_of(gfd_stream, {"inflow.0.phase=\"oil\""}),
              HasSubstr("must be the name of a phase, \"water\", found \"oil\""));
  EXPECT_THAT(refusal_of(replaced(gfd_stream_with_air(""), "[[inflow]]\nphase = \"water\"", "[[inflow]]")),
              HasSubstr("say which phase enters"));
  EXPECT_THAT(refusal_of(closed), HasSubstr("full and closed"));
  EXPECT_THAT(refusal_of(gfd_stream + "[[body]]\nshape = \"box\"\nsize = [0.2, 0.5]\nposition = [0, 0.25]\n"),
              HasSubstr("lets nothing enter"));
  EXPECT_THAT(refusal_of(gfd_stream, {"outflow.0.side=\"left\""}), HasSubstr("share a part of the left side"));
  EXPECT_THAT(refusal_of(gfd_stream, {"outflow.0.pressure=\"1/(x-1)\""}), HasSubstr("outflow.0.pressure"));
  EXPECT_THAT(refusal_of(gfd_stream, {"inflow.0.velocity=[\"-1\", \"0\"]"}), HasSubstr("inflow.0"));
  EXPECT_THAT(refusal_of(gfd_stream, {"time.viscosity=\"implicit\""}), HasSubstr("are explicit there"));
  EXPECT_THAT(refusal_of(gfd_stream + "[[solid]]\nlower = [0.4, 0]\nupper = [0.6, 0.2]\n"),
              HasSubstr("write the box as [[body]]"));
  EXPECT_THAT(refusal_of(gfd_stream, {"domain.wall_velocity.bottom=[\"0\", \"0.1\"]"}), HasSubstr("along its normal"));
}

}  // namespace
}  // namespace spume::test
