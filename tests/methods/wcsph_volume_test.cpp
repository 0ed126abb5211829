// SPDX-License-Identifier: MIT
// A liquid with a free surface keeps its volume: the density relaxation against its formula, and a stirred tank.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "methods/wcsph_run.hpp"
#include "reference/sph_sums.hpp"
#include "spume/methods/wcsph/flow.hpp"
#include "spume/particles/options.hpp"
#include "spume/particles/surface.hpp"

namespace spume::test {
namespace {

// The tank of the README of the method, with half of its spacings.
const std::string stirred_tank = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [0.4, 0.3]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.0125
[fluid]
gravity = 9.81
[[phase]]
name = "water"
density = 1000
viscosity = 1e-3
[[region]]
phase = "water"
upper = [0.4, 0.15]
[[body]]
name = "disc"
shape = "ball"
radius = 0.0375
position = [0.2, 0.075]
displacement = ["0.1*sin(3*t)", "0"]
[compressibility]
max_speed = 1.3
[time]
end = 6
)toml";

// Volume over that of the particles: of the points of a fine lattice outside of the disc whose kernel sum passes a
// half.
double covered(const WcsphRun& run, double disc_x, double disc_radius) {
  const wcsph::Flow& flow = run.method.flow();
  const double h = flow.resolution.smoothing_length, support = flow.resolution.support_radius;
  const double width = 0.4, cell = flow.scene.spacing / 4;
  const reference::PlainKernel kernel{KernelKind::wendland_c2, 2};
  const auto columns = static_cast<std::size_t>(std::lround(width / cell));
  const auto rows = static_cast<std::size_t>(std::lround(0.3 / cell));
  std::vector<double> sum(rows * columns);
  const auto spread = [&](double x, double y) {
    for (std::size_t row = 0; row < rows; ++row) {
      const double dy = (static_cast<double>(row) + 0.5) * cell - y;
      if (std::abs(dy) >= support) continue;
      for (std::size_t column = 0; column < columns; ++column) {
        const double dx = (static_cast<double>(column) + 0.5) * cell - x;
        if (std::abs(dx) < support)
          sum[row * columns + column] += kernel.normalisation() / (h * h) * kernel.w(std::hypot(dx, dy) / h);
      }
    }
  };
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double x = (*flow.particles.position[0])[i], y = (*flow.particles.position[1])[i];
    for (const double image : {x, -x, 2 * width - x})
      for (const double height : {y, -y}) spread(image, height);
  }
  double area = 0;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const double dx = (static_cast<double>(column) + 0.5) * cell - disc_x;
      const double dy = (static_cast<double>(row) + 0.5) * cell - 0.075;
      const bool liquid = sum[row * columns + column] * flow.particles.volume > 0.5;
      if (liquid && std::hypot(dx, dy) > disc_radius) area += cell * cell;
    }
  return area / (flow.particles.volume * static_cast<double>(flow.size()));
}

// Twelve spacings deep, stirred for 32 sqrt(H/g). Half a row of points of the measure is 1 % of the depth. What is left
// to the relaxation is little where the rate of density is adjoint to the pressure at walls: beside a rate by
// extrapolated velocities the tank lost more than 3 % without.
TEST(WcsphVolume, AStirredTankKeepsItsVolume) {
  const double end = 4, disc = 0.2 + 0.1 * std::sin(3 * end);
  const auto change = [&](const Overrides& overrides) {
    WcsphRun run(stirred_tank, overrides);
    const double before = covered(run, 0.2, 0.0375);
    until(run, end);
    const double column = run.series().contains("volume") ? run.series()["volume"] : 0;
    const double volume = run.method.flow().particles.volume * static_cast<double>(run.method.flow().size());
    if (overrides.empty()) {
      EXPECT_NEAR(column / volume, 1, 0.01);
    }
    return covered(run, disc, 0.0375) / before - 1;
  };
  EXPECT_NEAR(change({}), 0, 0.01);
  EXPECT_NEAR(change({"compressibility.density_relaxation=0"}), 0, 0.02);
}

// Liquid over a floor, periodic in x, jittered.
const std::string layer = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 2]
x = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.0625
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1000
viscosity = 1
[[region]]
phase = "water"
upper = [1, 1]
[initial]
jitter = 0.2
[compressibility]
max_speed = 1.4
density_relaxation = 4
[time]
end = 1
)toml";

// (12): <c> + b (e - e within 0.01),  c = S / S_lattice - 1 within 0.06, less s' - <s'> at the start,
// e = c - <c>; a step adds its
// share of it.
TEST(WcsphVolume, DensityTakesOnThatOfTheArrangement) {
  const LoadedCase loaded = load_text(layer);
  wcsph::Flow flow(loaded);
  flow.keep_lists(0);
  const std::size_t n = flow.size();
  const reference::PlainKernel kernel{KernelKind::wendland_c2, 2};
  const double h = flow.resolution.smoothing_length, dr = loaded.scene.spacing;
  const double c2 = flow.laws[0].sound_speed * flow.laws[0].sound_speed;
  const auto x = [&](std::size_t i) { return (*flow.particles.position[0])[i]; };
  const auto y = [&](std::size_t i) { return (*flow.particles.position[1])[i]; };
  const auto reduced = [&](std::size_t i) { return (*flow.excess)[i] + (y(i) - flow.arrangement.origin[1]) / c2; };
  double start = 0;
  for (std::size_t i = 0; i < n; ++i) start += reduced(i) / static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) (*flow.excess)[i] -= 0.02 + 0.03 * std::sin(7 * x(i)) * y(i);

  std::vector<double> difference(n), weight(n), expected(n);
  const InteriorWeight interior = interior_weight(2, SurfaceOptions{});
  double mean = 0, weights = 0, volume = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double kernel_sum = 0, divergence_of_position = 0;
    for (std::size_t j = 0; j < n; ++j)
      for (const double shift : {-1.0, 0.0, 1.0})
        for (const double mirror : {1.0, -1.0}) {
          const double r2 = std::pow(x(j) + shift - x(i), 2) + std::pow(mirror * y(j) - y(i), 2);
          const double q = std::sqrt(r2) / h, scale = dr * dr * kernel.normalisation() / (h * h);
          kernel_sum += scale * kernel.w(q);
          divergence_of_position -= flow.arrangement.context.gradient_scale * scale * kernel.f(q) * r2 / (h * h);
        }
    weight[i] = interior(divergence_of_position);
    const double geometric = kernel_sum / flow.resolution.lattice.kernel_sum - 1;
    difference[i] = std::clamp(geometric, -0.06, 0.06) - (reduced(i) - start);
    weights += weight[i];
    mean += weight[i] * difference[i];
    volume += dr * dr * (weight[i] / (1 + geometric) + 1 - weight[i]);
  }
  mean /= weights;
  EXPECT_GT(mean, 0.01);  // the jitter and what was taken away
  for (std::size_t i = 0; i < n; ++i) {
    const double local = difference[i] - mean;
    expected[i] = mean + weight[i] * (local - std::clamp(local, -0.01, 0.01));
  }
  flow.relaxation->measure();
  // Float sums of 21 neighbours.
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(flow.relaxation->lack(i), expected[i], 2e-5) << i;
  EXPECT_NEAR(flow.relaxation->volume / volume, 1, 1e-6);
}

// dt U / (N dr): what is at rest keeps what it has.
TEST(WcsphVolume, AStepTakesTheShareOfItsWay) {
  const LoadedCase loaded = load_text(layer);
  const double dt = 1e-3;
  const auto excess_after = [&](double lack, double speed) {
    wcsph::Flow flow(loaded);
    Ledger ledger;
    wcsph::make_plan(flow).run_start(static_cast<double>(flow.size()), ledger);
    flow.particles.fields.add<double>("density_lack", Lifetime::state).fill(lack);
    flow.largest_speed = speed;
    flow.drift(dt);
    flow.find_rates(dt);
    flow.advance_density(dt);
    return flow.next_excess[5];
  };
  EXPECT_EQ(excess_after(0.01, 0), excess_after(0, 0));
  EXPECT_NEAR(excess_after(0.01, 0.5) - excess_after(0, 0.5), dt * 0.5 / (4 * 0.0625) * 0.01, 1e-12);
}

TEST(WcsphVolume, OnlyAFreeSurfaceHasTheStage) {
  const auto has_column = [](const Overrides& overrides) {
    WcsphRun run(layer, overrides);
    return run.series().contains("volume");
  };
  EXPECT_TRUE(has_column({}));
  EXPECT_FALSE(has_column({"compressibility.density_relaxation=0"}));
  EXPECT_FALSE(has_column({"domain.upper=[1,1]", "domain.top=free-slip"}));
}

}  // namespace
}  // namespace spume::test
