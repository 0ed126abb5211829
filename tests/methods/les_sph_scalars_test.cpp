// SPDX-License-Identifier: MIT
// Scalars that the liquid of les-sph carries: exact solutions, amounts, bounds, state.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

using std::numbers::pi;

std::string with_scalar(const std::string& text, const std::string& initial, const std::string& more = "") {
  return text + "[[scalar]]\nname = \"dye\"\ninitial = \"" + initial + "\"\n" + more;
}

// A periodic square at rest.
const std::string still = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.025
[fluid]
reynolds = 100
[[liquid]]
[time]
end = 1
)toml";

struct Range {
  double least = 1e300, largest = -1e300;
};
Range range(const Scalars& scalars, std::size_t scalar = 0) {
  Range range;
  for (const double c : scalars.values(scalar)) {
    range.least = std::min(range.least, c);
    range.largest = std::max(range.largest, c);
  }
  return range;
}

// On a lattice at rest a sine is a mode of the pair sum: its rate is 4 pi^2 D but for the error of the sum, which is of
// second order, (k h)^2 / 8 at most for the Wendland kernel, whose fourth moment is 0.5 h^2 of the second; explicit
// steps add D k^2 dt / 2.
TEST(LesSphScalars, ASineModeDecaysAtItsRate) {
  Simulation run(with_scalar(still, "1 + sin(2*pi*x)", "diffusivity = 0.02\n"));
  const double dt = 0.01, rate = 0.02 * 4 * pi * pi, h = 1.3 * 0.025;
  run.steps(50, dt);
  const Range after = range(*run.method.flow().solutes.scalars);
  const double amplitude = (after.largest - after.least) / 2;
  const double first =
      range(*Simulation(with_scalar(still, "1 + sin(2*pi*x)")).method.flow().solutes.scalars).largest - 1;
  const double measured = -std::log(amplitude / first) / (50 * dt);
  EXPECT_NEAR(measured / rate, 1, std::pow(2 * pi * h, 2) / 8 + rate * dt);
}

// u . grad c = 0 for a function of the stream function, and cos cos is an eigenfunction of the Laplacian: exact in
// vortices that stir the particles. taylor_green holds 20 particles across: the velocity there is held to 4 %.
TEST(LesSphScalars, AScalarOnTheStreamlinesOfVorticesDecaysByDiffusionAlone) {
  Simulation run(with_scalar(taylor_green, "cos(2*pi*x)*cos(2*pi*y)", "diffusivity = 0.01\n"));
  while (run.method.time() < 0.5) run.steps(1, run.method.step_limit().dt);
  const les_sph::Flow& flow = run.method.flow();
  double error = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const Vec3 r = vector_at(flow.particles.position, 2, i);
    const double exact = std::exp(-8 * pi * pi * 0.01 * flow.time) * std::cos(2 * pi * r[0]) * std::cos(2 * pi * r[1]);
    error += std::pow(flow.solutes.scalars->values(0)[i] - exact, 2) / static_cast<double>(flow.size());
  }
  EXPECT_LT(std::sqrt(error), 0.04);
}

// Each step adds the rounding of n doubles and of their sum.
TEST(LesSphScalars, AmountsStayToTheRoundingOfDoublesAndNoValuePassesTheOthers) {
  for (const std::string model : {"none", "smagorinsky"})
    for (const std::string& text : {taylor_green, taylor_green_3d, closed_box, dam_break, dam_break_3d}) {
      Simulation run(with_scalar(text, "x < 0.3 ? 1 : 0", "diffusivity = 0.01\nturbulent_schmidt = 0.5\n"),
                     {"turbulence.model=\"" + model + "\""});
      const Scalars& scalars = *run.method.flow().solutes.scalars;
      const double before = run.series()["amount_of_dye"];
      EXPECT_GT(before, 0);
      constexpr int steps = 10;
      run.steps(steps, std::min(run.method.step_limit().dt, 0.005));
      EXPECT_NEAR(run.series()["amount_of_dye"] / before, 1, steps * 64 * std::numeric_limits<double>::epsilon());
      const Range after = range(scalars);
      EXPECT_GE(after.least, 0);
      EXPECT_LE(after.largest, 1 + 1e-6);  // values are floats beside the least one
      EXPECT_GT(run.method.snapshot()[0].fields.size(), 0U);
    }
}

TEST(LesSphScalars, DiffusionDividesTheStepInsteadOfLimitingIt) {
  Simulation plain(still), run(with_scalar(still, "x < 0.5 ? 1 : 0", "diffusivity = 1\n"));
  EXPECT_EQ(run.method.step_limit().dt, plain.method.step_limit().dt);
  run.steps(1, 0.01);
  EXPECT_GT(run.series()["scalar_substeps"], 10);
  const Range after = range(*run.method.flow().solutes.scalars);
  EXPECT_GE(after.least, 0);
  EXPECT_LE(after.largest, 1 + 1e-6);
}

TEST(LesSphScalars, FlowsAreTheSameBitsWithAndWithoutThem) {
  for (const std::string model : {"none", "smagorinsky"}) {
    const Overrides overrides{"turbulence.model=\"" + model + "\""};
    Simulation plain(dam_break, overrides), run(with_scalar(dam_break, "x", "diffusivity = 0.01\n"), overrides);
    plain.steps(5, 0.004);
    run.steps(5, 0.004);
    EXPECT_TRUE(plain.state() == run.state());
    EXPECT_EQ(plain.method.flow().solutes.scalars, nullptr);
  }
}

TEST(LesSphScalars, ARestoredRunAndAnyNumberOfThreadsGiveTheSameBits) {
  const std::string text = with_scalar(taylor_green, "x", "diffusivity = 0.01\n");
  Simulation straight(text);
  straight.steps(3, 0.004);
  MemoryState saved;
  straight.method.save(saved);
  straight.steps(2, 0.004);
  const OneThread one;
  Simulation restored(text);
  restored.method.load(saved);
  restored.steps(2, 0.004);
  const Array<double>&a = straight.method.flow().solutes.scalars->values(0),
        &b = restored.method.flow().solutes.scalars->values(0);
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
}

// Still water between walls left and right, periodic along the others.
std::string slab(int dimensions) {
  std::string text = replaced(dimensions == 2 ? still : taylor_green_3d, "x = \"periodic\"",
                              "left = \"no-slip\"\nright = \"no-slip\"");
  if (dimensions == 3) text = text.replace(text.find("velocity"), text.find("[time]") - text.find("velocity"), "");
  return text;
}

// Conduction between walls of values 0 and 1 from 0 on: x + sum 2 / (n pi) (-1)^n exp(-n^2 pi^2 D t) sin(n pi x), of
// which the first mode is left. Its rate is off by (pi h)^2 / 8, as in the test of a sine, and by pi^2 D dt / 2 of
// explicit steps.
TEST(LesSphScalars, ValuesAtWallsDiffuseIntoTheLiquid) {
  for (const int dimensions : {2, 3}) {
    const double diffusivity = 0.02, dt = 0.02, h = 1.3 * (dimensions == 2 ? 0.025 : 0.1);
    Simulation run(with_scalar(slab(dimensions), "0", "diffusivity = 0.02\n") +
                   "[[scalar_wall]]\nscalar = \"dye\"\nside = \"left\"\nvalue = \"0\"\n"
                   "[[scalar_wall]]\nscalar = \"dye\"\nside = \"right\"\nvalue = \"1\"\n");
    run.steps(300, dt);
    const les_sph::Flow& flow = run.method.flow();
    const double t = 300 * dt;
    double error = 0;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      const double x = (*flow.particles.position[0])[i];
      double exact = x;
      for (int n = 1; n < 40; ++n)
        exact +=
            2 / (n * pi) * (n % 2 == 0 ? 1 : -1) * std::exp(-n * n * pi * pi * diffusivity * t) * std::sin(n * pi * x);
      error = std::max(error, std::abs(flow.solutes.scalars->values(0)[i] - exact));
    }
    const double decay = pi * pi * diffusivity;
    const double first_mode = 2 / pi * std::exp(-decay * t) * decay * t;
    EXPECT_LT(error, (std::pow(pi * h, 2) / 8 + decay * dt / 2) * first_mode) << dimensions;
    const Range after = range(*flow.solutes.scalars);
    EXPECT_GE(after.least, 0);
    EXPECT_LE(after.largest, 1);
    EXPECT_NEAR(run.series()["walls_gave_dye"], run.series()["amount_of_dye"], 1e-12);
  }
}

// A flux brings its amount: on a lattice exactly, of rounding in the positions. What it brings keeps a parabola.
TEST(LesSphScalars, AFluxThroughAWallBringsItsAmount) {
  Simulation run(with_scalar(slab(2), "0", "diffusivity = 0.5\n") +
                 "[[scalar_wall]]\nscalar = \"dye\"\nside = \"right\"\nflux = \"0.3*t\"\n");
  run.steps(50, 0.02);
  EXPECT_NEAR(run.series()["amount_of_dye"], 0.3 / 2, 1e-6);
  EXPECT_NEAR(run.series()["walls_gave_dye"], run.series()["amount_of_dye"], 1e-12);
}

TEST(LesSphScalars, WallsThatAreNoneAreRefused) {
  const auto refused = [](const std::string& wall, const std::string& message) {
    const auto problems = problems_of(with_scalar(slab(2), "0") + "[[scalar_wall]]\n" + wall);
    EXPECT_TRUE(std::any_of(problems.begin(), problems.end(), [&](const std::string& text) {
      return text.find(message) != std::string::npos;
    })) << message;
  };
  refused("scalar = \"dye\"\nside = \"left\"\n", "neither of flux and value");
  refused("scalar = \"dye\"\nside = \"left\"\nflux = \"1\"\nvalue = \"1\"\n", "both of flux and value");
  refused("scalar = \"die\"\nside = \"left\"\nflux = \"1\"\n", "no scalar 'die'");
  refused("scalar = \"dye\"\nside = \"top\"\nflux = \"1\"\n", "is no wall");
  refused("scalar = \"dye\"\nside = \"front\"\nflux = \"1\"\n", "is no wall");
}

// A Gaussian blob in a fluid that turns as a rigid body spreads as it does at rest: sigma^2 + 2 D t, its centre turns.
TEST(LesSphScalars, AGaussianTurnsAndSpreads) {
  Simulation run(with_scalar(square_patch, "exp(-((x - 0.15)^2 + y^2)/(2*0.1^2))", "diffusivity = 0.004\n"));
  while (run.method.time() < 0.5) run.steps(1, std::min(run.method.step_limit().dt, 0.5 - run.method.time() + 1e-12));
  const les_sph::Flow& flow = run.method.flow();
  double amount = 0, spread = 0;
  std::array<double, 2> centre{};
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double c = flow.solutes.scalars->values(0)[i];
    amount += c;
    for (std::size_t a = 0; a < 2; ++a) centre[a] += c * (*flow.particles.position[a])[i];
  }
  for (double& x : centre) x /= amount;
  for (std::size_t i = 0; i < flow.size(); ++i)
    for (std::size_t a = 0; a < 2; ++a)
      spread +=
          flow.solutes.scalars->values(0)[i] * std::pow((*flow.particles.position[a])[i] - centre[a], 2) / amount / 2;
  const double t = flow.time, exact = 0.1 * 0.1 + 2 * 0.004 * t;
  // Two spacings resolve the radius: 20 across the patch, whose velocity is held to some per cent.
  EXPECT_NEAR(spread / exact, 1, 0.05);
  EXPECT_NEAR(std::hypot(centre[0], centre[1]), 0.15, 0.01);
  EXPECT_NEAR(std::atan2(-centre[1], centre[0]), t, 0.05);
}

// The largest difference from an exact solution at t = 0.5 in steps of 0.0025.
double error_of(const std::string& text, const std::string& spacing, const std::function<double(const Vec3&)>& exact) {
  Simulation run(text, {"resolution.spacing=" + spacing});
  run.steps(200, 0.0025);
  const les_sph::Flow& flow = run.method.flow();
  double most = 0;
  for (std::size_t i = 0; i < flow.size(); ++i)
    most =
        std::max(most, std::abs(flow.solutes.scalars->values(0)[i] - exact(vector_at(flow.particles.position, 2, i))));
  return most;
}

// The pair sum adds D h^2 / 8 of the fourth derivatives at most, 8 / sigma^4 in the middle of a Gaussian: with the
// first sigma, of all times. Second order, and the steps of an explicit scheme, D dt / 2 of the same.
TEST(LesSphScalars, AGaussianInAUniformStreamSpreadsAtSecondOrder) {
  constexpr double diffusivity = 0.005, sigma2 = 0.01, t = 0.5;
  const std::string text = with_scalar(replaced(still, "[[liquid]]\n", "[[liquid]]\nvelocity = [\"1\", \"0.5\"]\n"),
                                       "exp(-((x - 0.5)^2 + (y - 0.5)^2)/(2*0.1^2))", "diffusivity = 0.005\n");
  const auto exact = [](const Vec3& r) {
    double c = 1;
    for (const double x : {r[0] - 0.5 - t, r[1] - 0.5 - 0.5 * t}) {
      const double nearest = x - std::round(x), now = sigma2 + 2 * diffusivity * t;
      c *= std::sqrt(sigma2 / now) * std::exp(-nearest * nearest / (2 * now));
    }
    return c;
  };
  const double fine = error_of(text, "0.025", exact), coarse = error_of(text, "0.05", exact), h = 1.3 * 0.025;
  EXPECT_LT(fine, diffusivity * t / (sigma2 * sigma2) * (h * h + 4 * diffusivity * 0.0025));
  EXPECT_GT(coarse / fine, 3);
}

// Two layers: an error function between them. The same fourth derivative, of a step that has spread for the whole time.
TEST(LesSphScalars, TwoLayersMixAsAnErrorFunction) {
  constexpr double diffusivity = 0.01, t = 0.5;
  const std::string text =
      with_scalar(replaced(still, "x = \"periodic\"", "left = \"free-slip\"\nright = \"free-slip\""), "x < 0.5 ? 1 : 0",
                  "diffusivity = 0.01\n");
  const auto exact = [](const Vec3& r) { return 0.5 * std::erfc((r[0] - 0.5) / std::sqrt(4 * diffusivity * t)); };
  const double fine = error_of(text, "0.025", exact), coarse = error_of(text, "0.05", exact), h = 1.3 * 0.025;
  EXPECT_LT(fine, h * h / (16 * diffusivity * t));
  EXPECT_GT(coarse / fine, 3);
}

// --- Five scalars ride on the viscous sweep; as the sixth a scalar has a sweep of its own.

std::string as_the_sixth(std::string text) {
  std::string five;
  for (const std::string name : {"one", "two", "three", "four", "five"})
    five += "[[scalar]]\nname = \"" + name + "\"\n";
  return text.insert(text.find("[[scalar]]"), five);
}

Ledger::Entry entry_of(const Ledger& ledger, const std::string& stage) {
  for (const Ledger::Entry& entry : ledger.entries())
    if (entry.stage == stage) return entry;
  throw std::logic_error("no stage " + stage);
}

std::vector<double> by_identifier(const les_sph::Flow& flow, std::size_t scalar = 0) {
  std::vector<double> values(flow.size());
  for (std::size_t i = 0; i < flow.size(); ++i)
    values[static_cast<std::size_t>((*flow.particles.identifier)[i])] = flow.solutes.scalars->values(scalar)[i];
  return values;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

const std::string beside_a_disc = R"toml(method = "les-sph"
[domain]
lower = [-1, -1]
upper = [1, 1]
x = "periodic"
bottom = "no-slip"
top = "free-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
[[liquid]]
velocity = ["1", "0"]
[[body]]
shape = "cylinder"
radius = 0.4
position = [0.03, -0.02]
wall = "no-slip"
[time]
end = 1
)toml";

// Each change is a sum in float: value, place, kernel and products are off by less than 64 roundings of the largest.
TEST(LesSphScalars, OneThatRidesOnTheViscousSweepGoesAsByASweepOfItsOwn) {
  struct Scene {
    std::string text, scalar;
    Overrides overrides = {};
    bool rides = true;
  };
  const std::vector<Scene> scenes = {
      {taylor_green, "diffusivity = 0.01\n"},
      {taylor_green, "diffusivity = 0.01\n", {"shifting.on=false"}},
      {taylor_green, "diffusivity = 0.01\n", {"shifting.velocity_correction=\"none\""}},
      {taylor_green, "diffusivity = 0.01\n", {"shifting.velocity_correction=\"second-order\""}},
      {taylor_green, "diffusivity = 0.01\n", {"resolution.kernel=\"quintic-spline\""}},
      {taylor_green, "diffusivity = 0\n"},
      {taylor_green, "diffusivity = 1\n", {}, false},  // in parts of a step
      {taylor_green, "diffusivity = 0.01\nsource = \"-3*x\"\n"},
      {taylor_green_3d, "diffusivity = 0.01\n"},
      {closed_box, "diffusivity = 0.01\n"},
      {dam_break, "diffusivity = 0.01\n", {"turbulence.model=\"none\""}},
      {dam_break_3d, "diffusivity = 0.01\n", {"turbulence.model=\"none\""}},
      {beside_a_disc, "diffusivity = 0.01\n"},
      {slab(2), "diffusivity = 0.01\n[[scalar_wall]]\nscalar = \"dye\"\nside = \"right\"\nvalue = \"1\"\n", {}, false},
      {slab(3), "diffusivity = 0.01\n[[scalar_wall]]\nscalar = \"dye\"\nside = \"left\"\nflux = \"1\"\n"}};
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    SCOPED_TRACE(k);
    const std::string text = with_scalar(scenes[k].text, "x < 0.3 ? 1 : 0", scenes[k].scalar);
    Simulation ridden(text, scenes[k].overrides), own(as_the_sixth(text), scenes[k].overrides);
    constexpr int steps = 6;
    const double dt = std::min(ridden.method.step_limit().dt, 0.005);
    double changed = 0;
    for (int step = 0; step < steps; ++step) {
      const std::vector<double> before = by_identifier(ridden.method.flow());
      ridden.steps(1, dt);
      changed += largest_difference(by_identifier(ridden.method.flow()), before);
      own.steps(1, dt);
      EXPECT_EQ(ridden.series()["scalar_substeps"], own.series()["scalar_substeps"]);
    }
    EXPECT_TRUE(ridden.state() == own.state());
    EXPECT_LE(largest_difference(by_identifier(ridden.method.flow()), by_identifier(own.method.flow(), 5)),
              64 * std::ldexp(1.0, -24) * changed);
    EXPECT_EQ(entry_of(ridden.ledger, "scalars").pairs == 0, scenes[k].rides);
    EXPECT_GT(entry_of(own.ledger, "scalars").pairs, 0);
  }
}

// Of up to five none has a sweep of its own, of seven the last two share one; beside eddies none rides.
TEST(LesSphScalars, ThatRideTogetherGoAsOneAlone) {
  // Each with a start and a diffusivity of its own.
  const auto with = [](int first, int last) {
    std::string all = taylor_green;
    for (int s = first; s < last; ++s) {
      const std::string number = std::to_string(s);
      all += "[[scalar]]\nname = \"s" + number + "\"\ninitial = \"x < 0.3 + 0.05*" + number + " ? 1 : 0.1*" + number +
             "\"\ndiffusivity = 0.00" + std::to_string(s + 2) + "\n";
    }
    return all;
  };
  std::vector<std::vector<double>> alone;
  std::vector<double> change;
  std::int64_t bytes = 0;
  for (int s = 0; s < 7; ++s) {
    Simulation one(with(s, s + 1));
    const std::vector<double> before = by_identifier(one.method.flow());
    one.steps(5, 0.004);
    alone.push_back(by_identifier(one.method.flow()));
    change.push_back(largest_difference(before, alone.back()));
    bytes = entry_of(one.ledger, "viscosity").bytes;
  }
  for (const int count : {2, 3, 4, 5, 7}) {
    SCOPED_TRACE(count);
    Simulation run(with(0, count));
    run.steps(5, 0.004);
    EXPECT_GT(entry_of(run.ledger, "viscosity").bytes, bytes);
    EXPECT_EQ(entry_of(run.ledger, "scalars").pairs > 0, count > 5);
    for (std::size_t s = 0; s < static_cast<std::size_t>(count); ++s)
      EXPECT_LE(largest_difference(by_identifier(run.method.flow(), s), alone[s]),
                64 * std::ldexp(1.0, -24) * change[s]);
  }
  Simulation eddies(with(0, 1), {"turbulence.model=\"smagorinsky\""});
  eddies.steps(2, 0.004);
  EXPECT_GT(entry_of(eddies.ledger, "scalars").pairs, 0);
}

// A step that is refused behind the viscous stage leaves no trace in the next one but for the order of the particles.
TEST(LesSphScalars, ARefusedStepGivesARidingScalarNothing) {
  const std::string text = with_scalar(taylor_green, "x < 0.3 ? 1 : 0", "diffusivity = 0.01\n");
  Simulation straight(text), refused(text);
  straight.steps(3, 0.004);
  refused.steps(3, 0.004);
  const std::vector<double> before = by_identifier(straight.method.flow());
  EXPECT_THROW(refused.steps(1, 0.2), StepFailure);
  straight.steps(1, 0.004);
  refused.steps(1, 0.004);
  const std::vector<double> after = by_identifier(straight.method.flow());
  EXPECT_LE(largest_difference(by_identifier(refused.method.flow()), after),
            64 * std::ldexp(1.0, -24) * largest_difference(before, after));
}

}  // namespace
}  // namespace spume::test
