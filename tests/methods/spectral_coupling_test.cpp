// SPDX-License-Identifier: MIT
// Two-way coupling of the spectral flow with single particles and few: what they see of themselves, and its order in
// time.
#include <fstream>

#include "methods/spectral_flow.hpp"
#include "spume/operators/b_spline.hpp"
#include "spume/physics/point_particles/self_disturbance.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using test::SpectralRun;

std::string unit_box(const std::string& grid, const std::string& rest) {
  return "method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\ny = \"periodic\"\n"
         "z = \"periodic\"\n[resolution]\ngrid = " +
         grid + "\n[time]\nend = 1\ncourant = 1\n" + rest;
}

// A particle of density ratio 2.5 and diameter `spacings` that settles with a Reynolds number of 0.1 in a fluid at
// rest; speed over that of Stokes' law, the mean over the second half of five viscous times of the box.
struct Settling {
  double speed = 0, images = 0;
};
Settling settling(double spacings, const std::string& more, const std::string& numerics = "") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "place.csv") << "0.51, 0.52, 0.5\n";
  const double beta = 0.5, diameter = spacings / 16, time = diameter * diameter / (12 * beta), speed = 0.1 / diameter;
  const double gravity = speed / (time * (1 - beta)), dt = 1e-3;
  char text[500];
  std::snprintf(
      text, sizeof text,
      "[particles]\ncount = 1\ndiameter = %.17g\nbeta = %.17g\nplacement = \"file\"\nfile = \"%s\"\ncoupling = "
      "\"two-way\"\ngravity = [%.17g, %.17g, %.17g]\nrecords = \"double\"\noverlap_samples = 0\n",
      diameter, beta, (folder / "place.csv").string().c_str(), 0.3 * gravity, 0.2 * gravity,
      -std::sqrt(1 - 0.13) * gravity);
  SpectralRun<> run(unit_box("16", "[fluid]\nreynolds = 1\n[initial]\nkind = \"rest\"\n" + numerics + text + more));
  run.start();
  const int steps = 130;
  double sum = 0;
  for (int step = 1; step <= steps; ++step) {
    run.steps(1, dt);
    if (step > steps / 2) sum += std::sqrt(run.method.suspension()->system().motion().mean_square_velocity);
  }
  // Hasimoto (1959): the periodic images, held by a mean pressure gradient.
  return {sum / (steps - steps / 2) / speed, 1 - 1.4187 * diameter};
}

TEST(SpectralCoupling, AParticleAloneSettlesAtItsOwnSpeed) {
  for (const double spacings : {0.1, 0.5, 1.0}) {
    const Settling free = settling(spacings, "");
    EXPECT_NEAR(free.speed / free.images, 1, 0.03) << spacings;
    const Settling disturbed = settling(spacings, "remove_self_disturbance = false\n");
    EXPECT_GT(disturbed.speed / disturbed.images, 1 + 0.55 * spacings) << spacings;
  }
  for (const char* integrator : {"rk3", "rk4"}) {
    const Settling free = settling(1, "", "[spectral]\nintegrator = \"" + std::string(integrator) + "\"\n");
    EXPECT_NEAR(free.speed / free.images, 1, 0.03) << integrator;
  }
  // Eleven modes are left along an axis, of which Hasimoto's sum of images is not quite that of all.
  const Settling truncated = settling(1, "", "[spectral]\ndealiasing = \"two-thirds\"\n");
  EXPECT_NEAR(truncated.speed / truncated.images, 1, 0.05);
}

// The sum over the modes of a periodic box of 32 points, and Hasimoto's images taken back; the integral over modes and
// the sum differ by (pi / 32)^2, and the factor of a place is quadratic.
TEST(SpectralCoupling, TheMobilityOfTheGridIsThatOfItsModes) {
  constexpr int n = 32;
  const double phase = M_PI * (1 - 1.0 / n);
  const SelfDisturbance disturbance({1, 1, 1}, {phase, phase, phase}, 1, 6);
  const auto direct = [](const std::array<double, 3>& xi) {
    std::array<double, 3> sum{2.837297 / (6 * M_PI * n), 2.837297 / (6 * M_PI * n), 2.837297 / (6 * M_PI * n)};
    for (int i = 1 - n / 2; i < n / 2; ++i)
      for (int j = 1 - n / 2; j < n / 2; ++j)
        for (int l = 1 - n / 2; l < n / 2; ++l) {
          const double k[3] = {2 * M_PI * i / n, 2 * M_PI * j / n, 2 * M_PI * l / n};
          const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
          if (k2 == 0) continue;
          std::complex<double> seen = 1;
          for (int a = 0; a < 3; ++a) {
            const auto axis = static_cast<std::size_t>(a);
            double weight[6], slope[6];
            BSpline<6>::weights(xi[axis], weight, slope);
            std::complex<double> through = 0;
            for (int p = 0; p < 6; ++p) through += weight[p] * std::polar(1.0, k[a] * (p - 2));
            seen *= ((1 - xi[axis]) + xi[axis] * std::polar(1.0, -k[a])) * through *
                    b_spline_prefilter(6,
                                       a == 0   ? i
                                       : a == 1 ? j
                                                : l,
                                       n);
          }
          for (std::size_t d = 0; d < 3; ++d) sum[d] += (1 - k[d] * k[d] / k2) / k2 * seen.real() / (n * n * n);
        }
    return sum;
  };
  // A steady force: the bands relax to it at their own rates, 2,000 steps of two viscous times of the spacing.
  const auto steady = [&](const std::array<double, 3>& xi) {
    std::array<double, 3> sum{};
    const auto factor = disturbance.place_factor(xi);
    const auto step = disturbance.step({1, 0}, 2, 2);
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t b = 0; b < SelfDisturbance::bands; ++b)
        sum[d] += (b == 0 ? factor[d] : 1) * step.band[b].now[d] / (1 - step.band[b].decay[d]);
    return sum;
  };
  for (const std::array<double, 3> xi :
       {std::array<double, 3>{0, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0.5}, {0.1, 0.8, 0.4}}) {
    const auto expected = direct(xi), found = steady(xi);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(found[d] / expected[d], 1, 0.01) << xi[0] << " " << d;
  }
  const auto mobility = disturbance.steady_mobility();
  double mean = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int l = 0; l < 4; ++l) mean += direct({(i + 0.5) / 4, (j + 0.5) / 4, (l + 0.5) / 4})[0] / 64;
  EXPECT_NEAR(mobility[0] / mean, 1, 0.01);
}

// Oseen's share of what is left by drift, and the form that the step takes it in.
TEST(SpectralCoupling, DriftLeavesOseensShareOfTheDisturbance) {
  SelfDisturbance::Step::Band band;
  band.rate = 1e-4;
  for (const double s : {0.1, 1.0, 3.0, 30.0}) {
    band.sweeping = 4 / (3 * M_PI) * band.rate;  // of S = 1 at a speed of 1
    const double share = 1.5 * ((1 + 1 / (s * s)) * std::atan(s) / s - 1 / (s * s));
    EXPECT_NEAR(-std::log(SelfDisturbance::swept(band, s * s)) / band.rate, 1 / share - 1, 0.01 / share);
  }
}

// Heavy and light particles that settle at a twelfth of a spacing a step in a fluid at rest, all of whose motion is
// theirs: its modes after 0.16, in steps of 0.01 and half of it, against steps of 1/1600. The force at the places of
// the start of a step, or none in the first, is of first order.
double order_in_time(const std::string& integrator, const std::string& more) {
  const auto state = [&](int steps) {
    SpectralRun<> run(
        unit_box("12", "[fluid]\nreynolds = 30\n[initial]\nkind = \"rest\"\n[spectral]\nintegrator = \"" + integrator +
                           "\"\n[particles]\ncount = 60\ndiameter = 0.04\ncoupling = \"two-way\"\n"
                           "records = \"double\"\nspline_order = 6\noverlap_samples = 0\n"
                           "gravity = [0, 0, -30]\nsort_every = 1000\n" +
                           more),
        {"time.end=100"});
    run.start().steps(steps, 0.16 / steps);
    auto saved = run.saved().reals;
    std::vector<double> all;
    for (const char* name : {"potential_x", "potential_y", "potential_z"})
      for (const double b : saved.at(name)) all.push_back(b);
    return all;
  };
  const auto exact = state(256), coarse = state(16), fine = state(32);
  double first = 0, second = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    first += std::pow(coarse[i] - exact[i], 2);
    second += std::pow(fine[i] - exact[i], 2);
  }
  return std::log2(first / second) / 2;
}

TEST(SpectralCoupling, IsOfSecondOrderInTimeWithEveryIntegrator) {
  for (const char* integrator : {"ab2", "rk3", "rk4"})
    for (const char* more : {"beta = 3\nresponse_time = 0.05\n", "beta = 0.5\nresponse_time = 0.05\n",
                             "beta = 0.5\nresponse_time = 0.05\nremove_self_disturbance = false\n"})
      EXPECT_GT(order_in_time(integrator, more), 1.7) << integrator << " " << more;
}

}  // namespace
}  // namespace spume
