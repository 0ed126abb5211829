// SPDX-License-Identifier: MIT
// A recorded flow that carries what is dissolved: exact chains, amounts, bounds, state, input that is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include "methods/les_sph_simulation.hpp"
#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace recorded_flow {
namespace {

using testing::Contains;
using testing::HasSubstr;

// A stream that moves by a cell, an eighth of the domain, in a lag.
const std::string stream = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [0.8, 0.2]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.02
[[phase]]
name = "water"
density = 1000
viscosity = 1e-3
[[region]]
phase = "water"
velocity = ["1", "0"]
[compressibility]
max_speed = 1
[[scalar]]
name = "dye"
initial = "x < 0.1 ? 1 : 0"
[recorded_flow]
from = 0.1
until = 1.1
lag = 0.1
cell = 0.1
[time]
end = 10
)toml";

// Discs rise through water, which takes oxygen from them and from the air.
const std::string discs = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [0.2, 0.3]
x = "periodic"
bottom = "no-slip"
[resolution]
spacing = 0.01
[fluid]
gravity = 9.81
[[phase]]
name = "water"
density = 998
viscosity = 1e-3
[[region]]
phase = "water"
upper = [0.2, 0.2]
[[body]]
shape = "ball"
radius = 0.02
position = [0.1, 0.06]
displacement = ["0.1*t", "0.3*t"]
release_interval = 0.15
release_duration = 0.4
release_growth = 0.1
release_shrinkage = 0.1
[compressibility]
max_speed = 1.4
[oxygen]
surface_k_l = 1e-3
[[scalar]]
name = "dye"
initial = "x < 0.1 ? 1 : 0"
source = "y > 0.15 ? 0.01*t : 0"
[[scalar]]
name = "even"
initial = "3"
[recorded_flow]
from = 0.2
until = 0.6
lag = 0.04
cell = 0.05
[time]
end = 100
)toml";

// Vortices that stand still, les-sph.
const std::string vortices = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
mach = 0.1
[[liquid]]
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
[[scalar]]
name = "dye"
initial = "cos(2*pi*x)"
[recorded_flow]
from = 0.1
until = 0.3
lag = 0.02
cell = 0.1
[time]
end = 10
)toml";

template <class Run>
void until_record_carries(Run& run) {
  while (!run.method.flow().solutes.record_carries()) run.steps(1, run.method.step_limit().dt);
}

TEST(RecordedFlow, AStreamMovesByACellInALag) {
  WcsphRun run(stream);
  until_record_carries(run);
  EXPECT_NEAR(run.method.time(), 1.1, 1e-9);
  const RecordedFlow& record = *run.method.flow().solutes.recorded;
  ASSERT_EQ(record.cells(), 16U);  // eight along, two across
  const std::vector<double> before = record.values(0);
  for (const double v : record.volumes()) EXPECT_NEAR(v, 0.8 * 0.2 / 16, 1e-12);
  EXPECT_GT(*std::max_element(before.begin(), before.end()), 0.9);
  run.steps(1, 0.3);
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t a = 0; a < 8; ++a) EXPECT_NEAR(record.values(0)[row * 8 + (a + 3) % 8], before[row * 8 + a], 1e-9);
}

// Water that has next to no oxygen takes as much of the record as it took of the flow that was recorded.
TEST(RecordedFlow, GivesTheOxygenThatWasMeasured) {
  WcsphRun run(discs);
  const auto given = [&] { return run.series()["oxygen_from_bubbles"] + run.series()["oxygen_from_surface"]; };
  until(run, 0.2);
  const double before = given();
  until_record_carries(run);
  const double t = run.method.time(), rate = (given() - before) / (t - 0.2), kla = run.series()["kla"];
  ASSERT_GT(rate, 0);
  run.steps(1, 0.04);
  // What the water has by then, of saturation, lowers the rate by as much. In the flow the layer below the surface, one
  // spacing thick, had up to k_L t / spacing of it, which the cells have mixed.
  const double recorded = run.series()["oxygen_from_record"] / 0.04;
  EXPECT_GT(recorded, rate * (1 - 2 * kla * t));
  EXPECT_LT(recorded, rate * (1 + 1e-3 * t / 0.01));
}

// Parts of both signs cancel: the whole tells nothing of them.
TEST(RecordedFlow, CarriesValuesOfBothSigns) {
  WcsphRun run(stream, {"scalar.0.initial=cos(2*pi*x/0.8)"});
  until_record_carries(run);
  const std::vector<double> before = run.method.flow().solutes.recorded->values(0);
  // cos(pi/8) in the middle of the cell, and the mean of five particles an eighth of the period long, sin(pi/8) / (5
  // sin(pi/40)), of that.
  EXPECT_NEAR(*std::max_element(before.begin(), before.end()), 0.9015, 0.002);
  run.steps(1, 0.8);  // a period of the domain
  for (std::size_t a = 0; a < before.size(); ++a)
    EXPECT_NEAR(run.method.flow().solutes.recorded->values(0)[a], before[a], 1e-9);
}

TEST(RecordedFlow, WithBubblesAndNoOxygenCarriesTheScalarsAlone) {
  std::string space =
      replaced(vortices, "lower = [0, 0]\nupper = [1, 1]", "lower = [0, 0, 0]\nupper = [1, 1, 1]\nz = \"periodic\"");
  space = replaced(replaced(space, "spacing = 0.05", "spacing = 0.1"), "cos(2*pi*y)\"]", "cos(2*pi*y)\", \"0\"]");
  Simulation run(space +
                 "[bubbles]\nweber = 1e4\n[[sparger]]\nposition = [0.5, 0.5, 0.5]\nrate = \"0.001\"\n"
                 "bubble_radius = 0.005\n");
  until_record_carries(run);
  run.steps(1, 1.0);
  EXPECT_GT(run.series()["recorded_cells"], 50);
}

// The columns of a flow that stands still keep their last values, also of a run that is resumed.
TEST(RecordedFlow, ARestoredRunOfLesSphHasTheSameColumns) {
  Simulation straight(vortices);
  until_record_carries(straight);
  straight.steps(1, 0.1);
  EXPECT_GT(straight.series()["pressure_iterations"], 0);
  MemoryState saved;
  straight.method.save(saved);
  Simulation restored(vortices);
  restored.method.load(saved);
  EXPECT_EQ(straight.series(), restored.series());
  for (Simulation* run : {&straight, &restored}) run->steps(1, 0.13);
  EXPECT_EQ(straight.series(), restored.series());
  EXPECT_EQ(straight.saved_state(), restored.saved_state());
}

TEST(RecordedFlow, KeepsAmountsEvennessAndRange) {
  WcsphRun run(discs);
  until_record_carries(run);
  auto before = run.series();
  run.steps(1, 2.003);  // 50 lags, and something that waits for the next one
  auto after = run.series();
  EXPECT_NEAR(after["amount_of_even"] / before["amount_of_even"], 1, 1e-12);
  EXPECT_NEAR((after["amount_of_dye"] - before["amount_of_dye"]) / (after["source_of_dye"] - before["source_of_dye"]),
              1, 1e-10);
  EXPECT_NEAR((after["amount_of_oxygen"] - before["amount_of_oxygen"]) / after["oxygen_from_record"], 1, 1e-10);
  EXPECT_GT(after["oxygen_from_record"], 0);
  for (const double c : run.method.flow().solutes.scalars->values(1)) EXPECT_NEAR(c, 3, 3e-12);
  // The source adds at most 0.01 t over the time since the start.
  const double t = run.method.time();
  for (const double c : run.method.flow().solutes.recorded->values(0)) {
    EXPECT_GE(c, 0);
    EXPECT_LE(c, 1 + 0.005 * t * t);
  }
}

TEST(RecordedFlow, ARestoredRunAndAnyNumberOfThreadsGiveTheSameBits) {
  const int threads = omp_get_max_threads();
  for (const bool carries : {false, true}) {
    omp_set_num_threads(1);
    WcsphRun straight(discs);
    while (straight.method.time() < 0.31) straight.steps(1, straight.method.step_limit().dt);
    if (carries) {
      until_record_carries(straight);
      straight.steps(1, 0.5);
    }
    MemoryState saved;
    straight.method.save(saved);
    omp_set_num_threads(3);
    WcsphRun restored(discs);
    restored.method.load(saved);
    for (WcsphRun* run : {&straight, &restored}) {
      until_record_carries(*run);
      run->steps(1, 0.13);
      run->steps(1, 1);
    }
    EXPECT_EQ(straight.saved_state(), restored.saved_state());
    EXPECT_EQ(straight.series(), restored.series());
  }
  omp_set_num_threads(threads);
}

// Until the record carries, the flow is that of a run whose steps meet the same marks.
TEST(RecordedFlow, TheFlowDoesNotDependOnIt) {
  WcsphRun recorded(stream), plain(stream.substr(0, stream.find("[recorded_flow]")) + "[time]\nend = 10\n");
  for (int k = 0; k < 40; ++k) {
    const double dt = recorded.method.step_limit().dt;
    recorded.steps(1, dt);
    plain.steps(1, dt);
  }
  auto a = plain.saved_state(), b = recorded.saved_state();
  for (const auto& [name, values] : a) EXPECT_EQ(values, b.at(name)) << name;
}

TEST(RecordedFlow, BadInputIsRefusedWithItsPlaceAndAFix) {
  const auto refused = [](const std::string& text, const std::string& message) {
    EXPECT_THAT(problems_of(text), Contains(HasSubstr(message))) << message;
  };
  refused(replaced(stream, "until = 1.1", "until = 0.5"), "leaves 4 times the lag for the record");
  refused(replaced(stream, "until = 1.1", "until = 1.15"), "10.5 times the lag");
  refused(replaced(stream, "from = 0.1", "from = 0"), "recorded_flow.from");
  refused(replaced(stream, "end = 10", "end = 1"), "before the record carries anything");
  refused(replaced(stream, "cell = 0.1", "cell = 3"), "more than the domain is long");
  refused(replaced(stream, "cell = 0.1", "cell = 0.001"), "cells; at most 2000 are possible");
  refused(replaced(stream, "lag = 0.1", "lag = -1"), "lag");
  refused(replaced(stream, "lag = 0.1\n", ""), "has no lag; add");
  refused(replaced(stream, "[[scalar]]\nname = \"dye\"\ninitial = \"x < 0.1 ? 1 : 0\"\n", ""), "the case has none");
}

}  // namespace
}  // namespace recorded_flow
}  // namespace spume::test
