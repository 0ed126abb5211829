// SPDX-License-Identifier: MIT
// What belongs to one time: the first pressures of a moving liquid, steps of changing length, and the work of forces.
#include <numbers>

#include "methods/les_sph_simulation.hpp"
#include "spume/particles/force_potential.hpp"

namespace spume::test {
namespace {

const std::string spinning_square = R"toml(method = "les-sph"
[domain]
lower = [-1, -1]
upper = [1, 1]
[resolution]
spacing = 0.05
[fluid]
reynolds = 1e9
[[liquid]]
lower = [-0.5, -0.5]
upper = [0.5, 0.5]
velocity = ["-y", "x"]
[time]
end = 1
)toml";

const std::string vortices = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.02
[fluid]
reynolds = 1e9
[[liquid]]
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
[time]
end = 1
)toml";

const std::string central_field = R"toml(method = "les-sph"
[domain]
lower = [-2, -2]
upper = [2, 2]
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e9
[[liquid]]
centre = [0, 0]
radius = 1
[forces]
body = ["-x", "-y"]
[time]
end = 10
)toml";

// lap p = 2 omega^2 in a square of side 1 with p = 0 on its sides, at the centre: the double sine series.
double centre_of_spinning_square() {
  double sum = 0;
  for (int m = 1; m < 400; m += 2)
    for (int n = 1; n < 400; n += 2)
      sum += ((m + n) % 4 == 2 ? 1.0 : -1.0) / (double(m) * n * (double(m) * m + double(n) * n));
  return -2 * 16 / std::pow(std::numbers::pi, 4) * sum;
}

double centre_pressure(const State& s) {
  double nearest = 1;
  for (const Vec3& r : s.position) nearest = std::min(nearest, std::hypot(r[0], r[1]));
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < s.pressure.size(); ++i)
    if (std::hypot(s.position[i][0], s.position[i][1]) < 1.1 * nearest) {
      sum += s.pressure[i];
      ++count;
    }
  return sum / count;
}

// p = -A (cos 4 pi x + cos 4 pi y) / 4: the A that fits best, 1 at the start.
double amplitude_of_vortices(const State& s) {
  double along = 0, square = 0;
  for (std::size_t i = 0; i < s.pressure.size(); ++i) {
    const double mode = -(std::cos(4 * M_PI * s.position[i][0]) + std::cos(4 * M_PI * s.position[i][1])) / 4;
    along += s.pressure[i] * mode;
    square += mode * mode;
  }
  return along / square;
}

// The particles beside the centre are half a diagonal from it, where the pressure is 1.3 % lower in size.
TEST(LesSphTime, FirstPressuresOfASpinningSquareAreThoseOfItsVelocity) {
  const double exact = centre_of_spinning_square();
  EXPECT_NEAR(exact, -0.147343, 1e-6);
  for (const char* mach : {"fluid.mach=0", "fluid.mach=0.05"})
    for (const double dt : {0.001, 0.004}) {
      Simulation run(spinning_square, {mach});
      for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(centre_pressure((run.method.snapshot(), run.state())), exact, 0.02 * -exact) << mach << ' ' << k;
        run.steps(1, dt);
      }
      // A step cut short to meet an output, and one of full length after it.
      run.steps(1, dt / 2);
      EXPECT_NEAR(centre_pressure(run.state()), exact, 0.02 * -exact) << mach << " after a short step";
      run.steps(1, dt);
      EXPECT_NEAR(centre_pressure(run.state()), exact, 0.02 * -exact) << mach << " after a long step";
    }
}

TEST(LesSphTime, FirstPressuresOfVorticesAreThoseOfTheirVelocity) {
  for (const char* mach : {"fluid.mach=0", "fluid.mach=0.05"}) {
    Simulation run(vortices, {mach});
    run.method.snapshot();
    EXPECT_NEAR(amplitude_of_vortices(run.state()), 1, 0.02) << mach;
    for (int k = 0; k < 3; ++k) {
      run.steps(1, 0.002);
      EXPECT_NEAR(amplitude_of_vortices(run.state()), 1, 0.02) << mach << " step " << k + 1;
    }
  }
}

// lap p = div f + ...: of a liquid at rest in a central field, p = (1 - r^2) / 2. Half a spacing of the surface's
// steps.
TEST(LesSphTime, FirstPressureHoldsTheLiquidAgainstABodyForce) {
  for (const char* force : {"forces.body=[\"-x\", \"-y\"]", "forces.body=[\"-x + 1e-3*y\", \"-y - 1e-3*x\"]"}) {
    Simulation run(central_field, {force});
    run.method.snapshot();
    EXPECT_NEAR(centre_pressure(run.state()) / 0.5, 1, 0.1) << force;
  }
}

// A particle alone in f = -r swings with period 2 pi. Steps that follow its speed, as the Courant limit has them,
// change by half: a scheme of first order gains energy in every period from that.
TEST(LesSphTime, StepsThatFollowTheSpeedGiveNoEnergy) {
  Simulation run(central_field, {"liquid.0.radius=0.04", "liquid.0.centre=[0.55, 0.05]",
                                 "liquid.0.velocity=[\"0\", \"0.2\"]", "domain.lower=[-2, -2]"});
  ASSERT_EQ(run.method.particle_count(), 1U);
  const auto energy = [&] {
    const State s = run.state();
    double sum = 0;
    for (int a = 0; a < 2; ++a) sum += s.position[0][a] * s.position[0][a] + s.velocity[0][a] * s.velocity[0][a];
    return sum / 2;
  };
  const double first = energy();
  double most = 0;
  while (run.method.time() < 4 * 2 * std::numbers::pi) {
    const State s = run.state();
    run.steps(1, 0.1 * (1 - 0.5 * std::hypot(s.velocity[0][0], s.velocity[0][1]) / 0.55));
    most = std::max(most, std::abs(energy() / first - 1));
  }
  // Leapfrog: the energy oscillates by (dt/2)^2 / 2 at steps of 0.1, a thousandth, and twice that as steps change.
  EXPECT_LT(most, 3e-3);
}

// The force and the static pressure cancel in the sums, so that nothing is left to push the liquid outwards: by 0.8 %
// of its area in this time at a quarter of the spacing where the force is left to the divergence.
TEST(LesSphTime, ADropAtRestInACentralFieldKeepsItsSize) {
  Simulation run(central_field);
  const auto moment = [&] {
    double sum = 0;
    const State s = run.state();
    for (const Vec3& r : s.position) sum += r[0] * r[0] + r[1] * r[1];
    return sum / static_cast<double>(s.position.size());
  };
  const double first = moment();
  run.steps(62, 0.04);
  EXPECT_NEAR(moment() / first, 1, 2e-3);
}

TEST(LesSphTime, TheWorkOfALinearForceIsTheChangeOfItsPotential) {
  // Rotation does no net work on a liquid that does not rotate; the rest is that of the potential r^2 / 2.
  Simulation run(central_field, {"liquid.0.velocity=[\"0.5*x\", \"-0.5*y\"]"});
  const auto potential = [&] {
    double sum = 0;
    for (const Vec3& r : run.state().position) sum += (r[0] * r[0] + r[1] * r[1]) / 2;
    return run.method.flow().particle_mass() * sum;
  };
  const double first = potential();
  EXPECT_EQ(run.series()["work"], 0);
  for (int k = 0; k < 10; ++k) run.steps(1, k % 2 == 0 ? 0.03 : 0.02);
  EXPECT_GT(std::abs(potential() - first), 1e-3);
  EXPECT_NEAR(run.series()["work"], first - potential(), 1e-12);
}

TEST(LesSphTime, TheWorkOfAUniformForceGoesIntoKineticEnergy) {
  for (const Overrides& force : {Overrides{"forces.body=[\"3\", \"0\"]"}, Overrides{"fluid.froude=0.7"}}) {
    Overrides all = force;
    all.push_back("liquid.0.velocity=[\"0\", \"0\"]");
    Simulation run(vortices, all);
    run.steps(5, 0.004);
    const auto series = run.series();
    EXPECT_GT(series.at("work"), 1e-4);
    EXPECT_NEAR(series.at("kinetic_energy") / series.at("work"), 1, 1e-5);
    EXPECT_EQ(series.at("potential_energy"), 0);
  }
}

struct Force {
  LoadedCase loaded;
  explicit Force(const std::string& body, const Overrides& more = {})
      : loaded(load_text(central_field, with(body, more))) {}
  static Overrides with(const std::string& body, Overrides more) {
    more.push_back("forces.body=" + body);
    return more;
  }
  const VectorExpression& operator()() const { return *loaded.scene.body_force; }
  std::optional<ForcePotential> potential() const {
    return ForcePotential::find(*loaded.scene.body_force, loaded.scene.domain, loaded.scene.spacing, 10);
  }
};

TEST(ForcePotential, IsFoundAndHasTheForceAsItsSlope) {
  const Force linear(R"f(["-4*x + y", "x - 2*y"])f");
  const auto found = linear.potential();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->points(), 1U);
  EXPECT_NEAR((*found)(linear(), {0.5, -1, 0}, 3), 2 * 0.25 + 0.5 + 1, 1e-14);

  const Force waves(R"f(["sin(t)*cos(2*x)*exp(y)", "sin(t)*sin(2*x)*exp(y)/2"])f");
  const auto wavy = waves.potential();
  ASSERT_TRUE(wavy);
  const auto exact = [](double x, double y) { return -std::sin(2.0) * std::sin(2 * x) * std::exp(y) / 2; };
  EXPECT_NEAR((*wavy)(waves(), {0.7, -0.4, 0}, 2), exact(0.7, -0.4) - exact(0, 0), 1e-5);
}

TEST(ForcePotential, IsNotFoundWhereThereIsNoneThatIsSmooth) {
  EXPECT_FALSE(Force(R"f(["-y", "x"])f").potential());
  EXPECT_FALSE(Force(R"f(["x > 0.1 ? 1 : 0", "0"])f").potential());
  EXPECT_FALSE(Force(R"f(["t*y", "0"])f").potential());
  // The same on both sides of a periodic axis, or no potential there.
  const Overrides periodic = {"domain.x=\"periodic\"", "liquid.0.radius=0.5"};
  EXPECT_FALSE(Force(R"f(["1 + 0.1*cos(pi*x/2)", "0"])f", periodic).potential());
  EXPECT_TRUE(Force(R"f(["0.1*cos(pi*x/2)", "0"])f", periodic).potential());
}

}  // namespace
}  // namespace spume::test
