// SPDX-License-Identifier: MIT
#include "spume/run/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "spume/core/machine.hpp"
#include "spume/methods/registry.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

// What the arrays of a run take after its first steps over what is estimated before, and the start table's words.
double estimate_over_need(const std::string& text) {
  const test::TemporaryFolder folder;
  test::write_contents(folder / "case.toml", text);
  const LoadedCase loaded = load_case((folder / "case.toml").string());
  const auto method = make_method(loaded);
  method->start();
  const double estimate = loaded.bytes_per_particle * static_cast<double>(method->particle_count());
  double early = 0, late = 0;
  for (const auto& array : method->arrays()) early += array.bytes;
  EXPECT_DOUBLE_EQ(needed_bytes(loaded, *method, early), std::max(early, estimate) + method->snapshot_bytes());
  EXPECT_THAT(start_table(loaded, *method, 1), testing::HasSubstr(" of " + human_bytes(machine_memory_bytes())));
  Ledger ledger;
  for (int step = 0; step < 2; ++step) method->step(method->step_limit().dt, ledger);
  for (const auto& array : method->arrays()) late += array.bytes;
  return estimate / late;
}

// An estimate from which cases are refused stays below the need. Left out of it are images and the product's planes,
// which weigh most in cases as small as these: a support of 2.6 spacings beside each side of 16 or 64 particles, and
// 35 bytes per point of 108 with 32 points a side.
TEST(Report, MemoryIsEstimatedBeforeTheFirstStep) {
  const std::string flow = "[time]\nend = 1\n[fluid]\nreynolds = 100\n";
  const std::string flat = "[domain]\nlower = [0, 0]\nupper = [1, 1]\nx = \"periodic\"\ny = \"periodic\"\n";
  const std::string deep =
      "[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\ny = \"periodic\"\nz = \"periodic\"\n";
  const std::vector<std::pair<std::string, double>> cases = {
      {"method = \"les-sph\"\n" + flat + "[resolution]\nspacing = 0.015625\n" + flow +
           "[[liquid]]\nvelocity = [\"sin(2*pi*y)\", \"0\"]\n",
       0.85},
      {"method = \"les-sph\"\n" + deep + "[resolution]\nspacing = 0.0625\n" + flow +
           "[[liquid]]\nvelocity = [\"sin(2*pi*y)\", \"0\", \"0\"]\n",
       0.7},
      {"method = \"spectral\"\n" + deep + "[resolution]\ngrid = 32\n" + flow + "[initial]\nkind = \"taylor-green\"\n",
       0.6}};
  for (const auto& [text, least] : cases) {
    const double ratio = estimate_over_need(text);
    EXPECT_GT(ratio, least) << text;
    EXPECT_LT(ratio, 1) << text;
  }
}

// Of weakly compressible phases, whose tension and bodies ask for as much again. Left out are images, 1.2 a particle in
// a tank of 20^3, and the points of walls.
TEST(Report, MemoryOfPhasesIsEstimatedByWhatTheirSceneHas) {
  const auto tank = [](int dimensions, const std::string& further) {
    const std::string domain = dimensions == 3 ? "lower = [0, 0, 0]\nupper = [1, 1, 1]\nfront = \"free-slip\"\n"
                                                 "back = \"free-slip\"\n"
                                               : "lower = [0, 0]\nupper = [1, 1]\n";
    return "method = \"wcsph\"\n[time]\nend = 1\n[domain]\n" + domain +
           "left = \"free-slip\"\nright = \"free-slip\"\nbottom = \"free-slip\"\ntop = \"free-slip\"\n[resolution]\n"
           "spacing = " +
           (dimensions == 3 ? "0.05" : "0.0125") +
           "\n[[phase]]\nname = \"water\"\ndensity = 1000\nviscosity = 1\n[[phase]]\nname = \"air\"\ndensity = 1\n"
           "viscosity = 0.02\n[[region]]\nphase = \"water\"\n[[region]]\nphase = \"air\"\ncentre = [" +
           (dimensions == 3 ? "0.5, 0.5, 0.4" : "0.5, 0.4") + "]\nradius = 0.2\n[compressibility]\nmax_speed = 1\n" +
           further;
  };
  const std::string tension = "[interface]\nsurface_tension = 1\n";
  const auto body = [](int dimensions) {
    return std::string("[[body]]\nshape = \"ball\"\nradius = 0.1\nposition = [") +
           (dimensions == 3 ? "0.5, 0.5, 0.8" : "0.5, 0.8") + "]\n";
  };
  for (const int dimensions : {2, 3})
    for (const auto& [further, least] : {std::pair{std::string(), 0.65}, {tension, 0.75}, {body(dimensions), 0.65}}) {
      const double ratio = estimate_over_need(tank(dimensions, further));
      EXPECT_GT(ratio, least) << dimensions << further;
      EXPECT_LT(ratio, 1) << dimensions << further;
    }
}

// The field that is computed, in the precision of the flow, beside all that are written, which are float; for the
// pressure its modes and the velocity.
TEST(Report, SnapshotsOfAGridAreCounted) {
  const std::string text =
      "method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\ny = \"periodic\"\n"
      "z = \"periodic\"\n[resolution]\ngrid = 16\n[time]\nend = 1\n[fluid]\nreynolds = 100\n[initial]\n"
      "kind = \"taylor-green\"\n[output]\nfields = [\"pressure\"]\n";
  const test::TemporaryFolder folder;
  test::write_contents(folder / "case.toml", text);
  const LoadedCase loaded = load_case((folder / "case.toml").string());
  const auto method = make_method(loaded);
  method->start();
  double before = 0, after = 0;
  for (const auto& array : method->arrays()) before += array.bytes;
  const double points = 16 * 16 * 16, computed = 3 * 8 * points, written = (3 + 1) * 4 * points,
               modes = 8 * points;  // half are stored
  const double estimate = method->snapshot_bytes();
  EXPECT_GE(estimate, computed + written + modes);
  EXPECT_LE(estimate, computed + written + 1.2 * modes);  // rows of modes are padded
  method->grid_snapshot();
  for (const auto& array : method->arrays()) after += array.bytes;
  EXPECT_GE(after - before, written + modes);
  EXPECT_EQ(after - before, estimate - computed);
  EXPECT_EQ(method->snapshot_bytes(), 0);
}

TEST(Report, SizesAndTimesAreShort) {
  EXPECT_EQ(human_bytes(0), "0 B");
  EXPECT_EQ(human_bytes(999), "999 B");
  EXPECT_EQ(human_bytes(1000), "1 kB");
  EXPECT_EQ(human_bytes(11.24e9), "11.2 GB");
  EXPECT_EQ(human_bytes(3e15), "3e+03 TB");
  EXPECT_EQ(human_duration(0.4), "00:00");
  EXPECT_EQ(human_duration(151), "02:31");
  EXPECT_EQ(human_duration(7805), "2:10:05");
  EXPECT_EQ(human_duration(-1), "00:00");
  EXPECT_EQ(human_duration(INFINITY), "--:--");
  EXPECT_EQ(short_number(1.0 / 3), "0.3333");
  EXPECT_EQ(exact_number(0.1 + 0.2), "0.3");
}

TEST(Report, ThePlanMarksWhatOnlyTheStartRuns) {
  const std::vector<Stage> plan = {{.name = "project", .reason = "always", .part = StagePart::both},
                                   {.name = "fill", .reason = "initial pressure", .part = StagePart::start},
                                   {.name = "shift", .reason = "shifting.on = false", .on = false}};
  EXPECT_EQ(plan_table(plan),
            "  project  on   always\n"
            "  fill     on   initial pressure (at the start only)\n"
            "  shift    off  shifting.on = false\n");
}

// Arrays of the particles in a flow count per such particle, and once more together.
TEST(Report, ArraysCountPerParticleOrPoint) {
  const std::string table = array_table({{"velocity", 4000, 0}, {"place", 240, 10}, {"slip", 80, 10}}, 100, true);
  EXPECT_EQ(table,
            "  velocity                4 kB      40.0 B per point\n"
            "  place                  240 B      24.0 B per particle\n"
            "  slip                    80 B       8.0 B per particle\n"
            "  all of particles       320 B      32.0 B per particle\n"
            "  total                4.32 kB      43.2 B per point\n");
}

TEST(Report, TheSummaryHasNoNumberThatJsonDoesNotKnow) {
  LoadedCase loaded;
  loaded.options.title = "Case \xff";  // no UTF-8
  RunFigures figures;
  figures.state = "finished";
  figures.particles = 100;
  figures.particle_steps = 500;
  figures.wall_seconds = 2;
  figures.total_wall_seconds = 3;
  figures.final_values = {{"t", 1.5}, {"speed", NAN}};
  figures.verdicts = {{"drift", INFINITY, 1}, {"residual", 0.5, 1}};
  const auto summary = nlohmann::json::parse(summary_json(loaded, figures));
  EXPECT_EQ(summary["final"]["t"], 1.5);
  EXPECT_TRUE(summary["final"]["speed"].is_null());
  EXPECT_TRUE(summary["verdicts"][0]["value"].is_null());
  EXPECT_EQ(summary["verdicts"][0]["verdict"], "FAIL");
  EXPECT_EQ(summary["verdicts"][1]["verdict"], "pass");
  EXPECT_EQ(summary["particle_steps_per_second"], 250);
  EXPECT_EQ(summary["total_wall_seconds"], 3);
}

TEST(Report, TheLedgerGivesRatesOfWhatIsCounted) {
  Ledger ledger;
  ledger.count("counted", 2, 0.5, 100, 0, 1e9);
  ledger.count("uncounted", 1, 0.5, 100, 0);
  const std::string table = ledger_table(ledger, 1);
  EXPECT_THAT(table, testing::ContainsRegex("counted +2 +0.500 +50.0% +5e.06 ns/part +2\n"));
  EXPECT_THAT(table, testing::ContainsRegex("uncounted +1 +0.500 +50.0% +5e.06 ns/part +-\n"));
}

}  // namespace
}  // namespace spume
