// SPDX-License-Identifier: MIT
// The direct solver and the iterative ones solve the same equation; what a direct run promises beside that.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include "methods/gfd_openings_run.hpp"
#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

using testing::HasSubstr;

Overrides with(Overrides set, const Overrides& more) {
  set.insert(set.end(), more.begin(), more.end());
  return set;
}

const Overrides direct{"pressure.solver=\"direct\""};
// The iterative one is held to 1e-9 of the divergence, a thousand times the tolerance.
const Overrides exactly{"pressure.tolerance=1e-11", "pressure.precision=\"double\""};

// Largest difference of saved arrays over the largest value in any of them: the velocity along an axis that nothing
// flows along is rounding.
double difference(const std::map<std::string, std::vector<double>>& a,
                  const std::map<std::string, std::vector<double>>& b, const std::vector<std::string>& names) {
  double largest = 0, size = 1e-300;
  for (const std::string& name : names) {
    const std::vector<double>&one = a.at(name), &other = b.at(name);
    for (std::size_t i = 0; i < one.size(); ++i) {
      largest = std::max(largest, std::abs(one[i] - other[i]));
      size = std::max(size, std::abs(one[i]));
    }
  }
  return largest / size;
}

double disagreement(const std::map<std::string, std::vector<double>>& a,
                    const std::map<std::string, std::vector<double>>& b) {
  std::vector<std::string> velocity{"velocity_x", "velocity_y"};
  if (a.contains("velocity_z")) velocity.emplace_back("velocity_z");
  return std::max(difference(a, b, {"pressure"}), difference(a, b, velocity));
}

// Sums over pairs are of floats: pressures that differ by a rounding differ by 6e-8 of the largest one in each of 20
// neighbours, over two steps 2.4e-6 at most. The factors leave 1e-12: the rounding of a double times the condition.
template <class Run>
void expect_agreement(const std::string& text, const Overrides& set = {}) {
  SCOPED_TRACE(text);
  Run iterative(text, with(set, exactly)), factorised(text, with(set, direct));
  iterative.steps(2, 0.002);
  factorised.steps(2, 0.002);
  const RefinementResult& report = factorised.method.flow().solver.report();
  EXPECT_EQ(report.iterations, 1);
  EXPECT_LT(report.relative_residual, 1e-12);
  EXPECT_GT(iterative.method.flow().solver.report().iterations, 3);
  EXPECT_LT(disagreement(iterative.saved_state(), factorised.saved_state()), 2.4e-6);
  EXPECT_EQ(uncounted_stages(factorised.method, factorised.ledger), "");
}

const std::string small_ball = replaced(ball_in_a_box, "0.0833333333333333333", "0.1");
const std::string wave_with_a_ball = wave_tank +
                                     "[[liquid]]\nwhere = \"0.03*cos(2*pi*x) - y\"\n[time]\nend = 1\n"
                                     "[[body]]\nshape = \"ball\"\nradius = 0.15\nposition = [0.5, -0.25]\n";
// Inflow, outflow, a moving body between them.
const std::string channel_with_a_stirrer = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 0.5]
bottom = "no-slip"
top = "free-slip"
[resolution]
spacing = 0.04166666666666667
[fluid]
reynolds = 20
[[liquid]]
velocity = ["1", "0"]
[[inflow]]
side = "left"
velocity = ["1", "0"]
[[outflow]]
side = "right"
[[body]]
shape = "ball"
radius = 0.12
position = [0.5, 0.25]
wall = "no-slip"
displacement = ["0", "0.05*sin(5*t)"]
[time]
end = 1
)toml";

TEST(DirectSolver, LiquidMayLeaveWholly) {
  Simulation run(R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [0.4, 0.4]
left = "free-slip"
right = "free-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
froude = 1
[[liquid]]
upper = [0.4, 0.1]
velocity = ["0", "-1"]
[[outflow]]
side = "bottom"
[pressure]
solver = "direct"
[time]
end = 1
)toml");
  for (int step = 0; step < 200 && run.method.particle_count() > 0; ++step)
    run.method.step(run.method.step_limit().dt, run.ledger);
  EXPECT_EQ(run.method.particle_count(), 0U);
  EXPECT_NO_THROW(run.method.step(0.01, run.ledger));
}

TEST(DirectSolver, AgreesWithTheIterativeOneInGfd) {
  expect_agreement<GfdRun>(drop_in_a_box);
  expect_agreement<GfdRun>(drop_in_a_box, {"phase.1.density=1000", "phase.1.viscosity=10"});
  expect_agreement<GfdRun>(drop_in_a_box, {"time.viscosity=\"implicit\""});
  expect_agreement<GfdRun>(drop_in_a_turning_tank);
  expect_agreement<GfdRun>(small_ball);
  expect_agreement<GfdRun>(gfd_drop_in_a_stream);
}

TEST(DirectSolver, AgreesWithTheIterativeOneInLesSph) {
  expect_agreement<Simulation>(taylor_green);
  expect_agreement<Simulation>(taylor_green_3d);
  expect_agreement<Simulation>(cavity, {"fluid.mach=0.1"});
  expect_agreement<Simulation>(wave_with_a_ball);
  expect_agreement<Simulation>(dam_break_3d);
  expect_agreement<Simulation>(channel_with_a_stirrer);
}

// Its error is at most a thousandth of the divergence, and moves the velocity by as much over the wave number of the
// longest wave, 2 pi here; were every step to leave it with the same sign, that many times as much.
TEST(DirectSolver, TheStandardToleranceLeavesTheSameFlow) {
  const int steps = 10;
  Simulation iterative(taylor_green), factorised(taylor_green, direct);
  double largest = 0;
  for (int k = 0; k < steps; ++k) {
    iterative.steps(1, 0.005);
    factorised.steps(1, 0.005);
    largest = std::max(largest, factorised.method.flow().next_max_divergence);
  }
  const State a = iterative.state(), b = factorised.state();
  double squares = 0;
  for (std::size_t i = 0; i < a.velocity.size(); ++i)
    for (int axis = 0; axis < 2; ++axis) squares += std::pow(a.velocity[i][axis] - b.velocity[i][axis], 2);
  const double apart = std::sqrt(squares / static_cast<double>(a.velocity.size()));
  EXPECT_LT(apart, 1e-3 * largest / (2 * M_PI));
  EXPECT_GT(apart, 0);
}

template <class Run>
void expect_the_same_bits(const std::string& text) {
  const int before = omp_get_max_threads();
  Run whole(text, direct);
  whole.steps(2, 0.002);
  MemoryState saved;
  whole.method.save(saved);
  whole.steps(2, 0.002);
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    Run resumed(text, direct);
    resumed.method.load(saved);
    resumed.steps(2, 0.002);
    EXPECT_EQ(resumed.saved_state(), whole.saved_state()) << threads << " threads";
  }
  omp_set_num_threads(before);
}

TEST(DirectSolver, GoesOnBitForBitWithAnyNumberOfThreads) {
  expect_the_same_bits<GfdRun>(drop_in_a_turning_tank);
  expect_the_same_bits<GfdRun>(small_ball);
  expect_the_same_bits<Simulation>(wave_with_a_ball);
  expect_the_same_bits<Simulation>(dam_break_3d);
}

std::string refused_directly(const std::string& text, const Overrides& overrides) {
  try {
    load_text(text, with(direct, overrides));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(DirectSolver, RefusesLargeScenesAndBodiesThatFloat) {
  EXPECT_THAT(refused_directly(ball_in_a_box, {"resolution.spacing=0.04"}), HasSubstr("15625 particles"));
  EXPECT_EQ(refused_directly(ball_in_a_box, {"resolution.spacing=0.1"}), "accepted");
  EXPECT_THAT(refused_directly(drop_in_a_box, {"resolution.spacing=0.004"}), HasSubstr("62500 particles"));
  EXPECT_THAT(refused_directly(plank_on_water(400), {}), HasSubstr("bodies that float"));
}

TEST(DirectSolver, TellsOptionsOfTheIterativeOnesThatHaveNoEffect) {
  const LoadedCase loaded = load_text(drop_in_a_box, with(direct, {"pressure.preconditioner=\"jacobi\""}));
  ASSERT_EQ(loaded.options.warnings.size(), 1U);
  EXPECT_THAT(loaded.options.warnings[0].text, HasSubstr("not used with pressure.solver = \"direct\""));
}

// `check` and the table of the arrays tell what the factors take.
TEST(DirectSolver, ListsItsFactors) {
  GfdRun run(drop_in_a_box, direct), iterative(drop_in_a_box);
  const auto bytes = [](GfdRun& of) {
    of.steps(1, 0.002);
    for (const ArrayInfo& array : of.method.arrays())
      if (array.name == "pressure solver") return array.bytes;
    return 0.0;
  };
  const double factors = run.method.flow().solver.factor_bytes();
  EXPECT_EQ(factors, 0);
  EXPECT_GT(bytes(run), bytes(iterative) + run.method.flow().solver.factor_bytes());
  // A row of the matrix meets 21 particles: its factors have more entries than it.
  EXPECT_GT(run.method.flow().solver.factor_bytes(), 8.0 * 21 * 400);
  EXPECT_EQ(iterative.method.flow().solver.factor_bytes(), 0);
}

}  // namespace
}  // namespace spume::test
