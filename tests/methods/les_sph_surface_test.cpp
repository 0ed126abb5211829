// SPDX-License-Identifier: MIT
// The free surface of les-sph: what its closure is exact for, and what it does to the energy of a wave.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "methods/les_sph_simulation.hpp"
#include "spume/core/random.hpp"
#include "spume/methods/les_sph/free_surface.hpp"

namespace spume::test {
namespace {

using les_sph::Liquid;

const std::string drop = R"(method = "les-sph"
[domain]
lower = [0, 0]
upper = [2, 2]
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
froude = 1
mach = 0
[[liquid]]
centre = [1, 1]
radius = 0.4
[time]
end = 1
)";

const std::string still_water = R"(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.4, 0.4, 0.5]
x = "periodic"
y = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 1e6
froude = 0.3193
mach = 0.05
[[liquid]]
upper = [0.4, 0.4, 0.3]
[time]
end = 4
)";

const std::string wave = R"(method = "les-sph"
[domain]
lower = [0, -1]
upper = [1, 0.25]
x = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.03125
[fluid]
reynolds = 1e9
froude = 1
mach = 0
[[liquid]]
where = "0.03*cos(2*pi*x) - y"
conform = true
[time]
end = 3
)";

// q linear with gradient b, and p such that it vanishes a depth s above each edge particle: p - p0 = -s n.b. The sums
// are exact for that whatever the arrangement; what is left is the rounding of floats, amplified by corrections of up
// to 6 and by neighbours' differences over a spacing.
TEST(LesSphSurface, GradientOfALinearPressureIsExactOnADisorderedSurface) {
  const LoadedCase loaded = load_text(drop);
  Liquid liquid(loaded);
  for (std::size_t i = 0; i < liquid.size(); ++i) {
    const auto r = random_uniform(3, RandomPurpose::test, i, 0, 0);
    for (int axis = 0; axis < 2; ++axis) (*liquid.position[axis])[i] += 0.3 * loaded.scene.spacing * (2 * r[axis] - 1);
  }
  les_sph::move_to_intermediate(liquid, 0);
  les_sph::sort_particles(liquid);
  les_sph::find_neighbours(liquid);
  les_sph::measure_kernel_moments(liquid);
  les_sph::find_surface(liquid);
  les_sph::predict_velocity(liquid, 0);
  ASSERT_GT(liquid.near_surface.size(), 20u);

  const double b[2] = {0.7, -1.3};
  for (std::size_t i = 0; i < liquid.size(); ++i)
    (*liquid.reduced_pressure)[i] = b[0] * (*liquid.intermediate[0])[i] + b[1] * (*liquid.intermediate[1])[i];
  for (std::size_t k = 0; k < liquid.near_surface.size(); ++k) {
    const auto i = static_cast<std::size_t>(liquid.near_surface[k]);
    double size = 0, along = 0;
    for (int axis = 0; axis < 2; ++axis) {
      const double n = (*liquid.normal[axis])[i];
      size += n * n;
      along += n * b[axis];
    }
    const double pressure =
        les_sph::surface_row(liquid, k).hydrostatic_pressure - liquid.surface_depth[k] * along / std::sqrt(size);
    (*liquid.potential)[i] = (*liquid.reduced_pressure)[i] - pressure;
  }
  gradient_sweep(liquid.context, liquid.records, liquid.reduced_pressure->data(), 0, liquid.read_correction(),
                 liquid.write(liquid.acceleration));
  les_sph::complete_surface_gradient(liquid);
  for (const std::int32_t i : liquid.near_surface)
    for (int axis = 0; axis < 2; ++axis) ASSERT_NEAR((*liquid.acceleration[axis])[i], b[axis], 1e-4);
}

// On the undisturbed lattice the uppermost layer lies half a spacing below the surface and nothing else does.
TEST(LesSphSurface, LatticeUnderAFlatSurfaceHasOneEdgeLayerHalfASpacingDeep) {
  const LoadedCase loaded = load_text(wave, {"liquid.0.where=\"-y\""});
  Liquid liquid(loaded);
  les_sph::move_to_intermediate(liquid, 0);
  les_sph::sort_particles(liquid);
  les_sph::make_images(liquid, 0);
  les_sph::find_neighbours(liquid);
  les_sph::measure_kernel_moments(liquid);
  les_sph::find_surface(liquid);
  ASSERT_EQ(liquid.near_surface.size(), 32u);
  for (std::size_t k = 0; k < 32; ++k) {
    EXPECT_NEAR(liquid.surface_depth[k], loaded.scene.spacing / 2, 1e-6);
    EXPECT_NEAR((*liquid.intermediate[1])[static_cast<std::size_t>(liquid.near_surface[k])], -loaded.scene.spacing / 2,
                1e-12);
  }
}

// Two layers of the lattice below a flat surface are moved towards each other: no force acts, and the shift must not
// transport their liquid through the layers, or the surface would follow. A tenth of it comes back through the filter,
// from the layers below that give way.
TEST(LesSphSurface, ShiftMovesNoWholeLayerAlongTheNormal) {
  double moved[2] = {0, 0};
  for (const bool kept : {false, true}) {
    const LoadedCase loaded =
        load_text(wave, {"liquid.0.where=\"-y\"", kept ? "shifting.remove_drift=true" : "shifting.remove_drift=false"});
    Liquid liquid(loaded);
    const double dr = loaded.scene.spacing;
    for (double& y : *liquid.position[1])
      if (std::abs(y + 1.5 * dr) < 0.1 * dr) y += 0.1 * dr;
    les_sph::move_to_intermediate(liquid, 0);
    les_sph::sort_particles(liquid);
    les_sph::make_images(liquid, 0);
    les_sph::find_neighbours(liquid);
    les_sph::measure_kernel_moments(liquid);
    les_sph::find_surface(liquid);
    liquid.displacement = 1;
    les_sph::compute_shift(liquid);
    for (std::size_t i = 0; i < liquid.size(); ++i)
      if ((*liquid.intermediate[1])[i] > -2 * dr)
        moved[kept ? 1 : 0] = std::max(moved[kept ? 1 : 0], std::abs(double{(*liquid.shift[1])[i]}) / dr);
  }
  EXPECT_LT(moved[1], 0.2 * moved[0]);
}

// Depths, in spacings, of the uppermost row in the middle of a slab of eight rows, far wider than any support; spacings
// along the first and the other rows and between rows in units of dr.
std::vector<double> middle_depths(const std::string& text, double first_row, double rows_across, double rows_down) {
  const LoadedCase loaded = load_text(text);
  Liquid liquid(loaded);
  const double dr = loaded.scene.spacing;
  std::size_t used = 0;
  std::vector<std::size_t> middle;
  for (int row = 0; row < 8; ++row) {
    const double step = dr * (row == 0 ? first_row : rows_across);
    const int half = static_cast<int>(8 * dr / step);
    for (int k = -half; k <= half; ++k, ++used) {
      if (used >= liquid.size()) throw std::logic_error("the case holds too few particles");
      (*liquid.position[0])[used] = 1 + (k + 0.3 * row) * step;
      (*liquid.position[1])[used] = 1 - rows_down * dr * row;
    }
  }
  // The others stay apart from the slab.
  for (std::size_t i = used; i < liquid.size(); ++i) {
    (*liquid.position[0])[i] = 0.1;
    (*liquid.position[1])[i] = 0.1 + 1e-3 * static_cast<double>(i - used) * dr;
  }
  les_sph::move_to_intermediate(liquid, 0);
  les_sph::sort_particles(liquid);
  les_sph::find_neighbours(liquid);
  les_sph::measure_kernel_moments(liquid);
  les_sph::find_surface(liquid);
  std::vector<double> depths;
  for (std::size_t k = 0; k < liquid.near_surface.size(); ++k) {
    const auto i = static_cast<std::size_t>(liquid.near_surface[k]);
    const double x = (*liquid.intermediate[0])[i], y = (*liquid.intermediate[1])[i];
    if (std::abs(x - 1) < 2 * dr && std::abs(y - 1) < 0.1 * dr) depths.push_back(liquid.surface_depth[k] / dr);
  }
  return depths;
}

// Strained without change of volume, a layer is as thick as it is long no more: half of it lies above its particles.
// The ramp of the column is sampled once a layer: its quadrature error is below 0.02 at these spacings.
TEST(LesSphSurface, DepthFollowsAStrainOfTheLattice) {
  for (const double down : {0.8, 1.0, 1.25}) {
    const std::vector<double> depths = middle_depths(drop, 1 / down, 1 / down, down);
    ASSERT_GE(depths.size(), 3u);
    for (const double depth : depths) EXPECT_NEAR(depth, down / 2, 0.02) << down;
  }
}

// A row with 4/3 as many particles on its length holds 4/3 of a layer; the surface lies 1/3 higher. The B-spline's sums
// are exact on a uniform row up to 0.2 % at this density.
TEST(LesSphSurface, DepthFollowsTheVolumeOfACrowdedRow) {
  const std::vector<double> depths = middle_depths(drop, 0.75, 1, 1);
  ASSERT_GE(depths.size(), 3u);
  for (const double depth : depths) EXPECT_NEAR(depth, 0.5 + 1.0 / 3, 0.01);
}

// Between two passages through the flat state, half a period apart, the kinetic energy of an inviscid wave returns to
// within the second order in the spacing, (2 pi / 32)^2 = 3.9 %.
TEST(LesSphSurface, StandingWaveKeepsItsEnergy) {
  Simulation run(wave);
  const double half_period = std::numbers::pi / std::sqrt(2 * std::numbers::pi);
  double peak[2] = {0, 0};  // of the first and of the second half period
  while (run.method.time() < 2 * half_period) {
    run.steps(1, 0.0125);
    double& highest = peak[run.method.time() < half_period ? 0 : 1];
    highest = std::max(highest, run.series().at("kinetic_energy"));
  }
  RecordProperty("ratio", std::to_string(peak[1] / peak[0]));
  EXPECT_NEAR(peak[1] / peak[0], 1, 0.039);
}

// Rounding moves the particles by 1e-7; a surface that does not hold a particle back as it rises lets that grow by a
// factor of forty per unit of time.
TEST(LesSphSurface, StillWaterStaysAtRestInThreeDimensions) {
  Simulation run(still_water);
  run.steps(200, 0.016);
  EXPECT_LT(run.series().at("max_speed"), 1e-5);
}

// Disturbed by a thousandth of a spacing it oscillates and calms down. With depths that are not shared within a layer
// its energy grows eightfold in the second unit of time.
TEST(LesSphSurface, DisturbedWaterCalmsDownInThreeDimensions) {
  Simulation run(still_water, {"initial.jitter=1e-3"});
  run.steps(100, 0.01);
  const double early = run.series().at("kinetic_energy");
  run.steps(100, 0.01);
  EXPECT_LT(run.series().at("kinetic_energy"), early);
}

// A breaking wave of steepness 0.55 until its crest overturns. Without forces other than gravity its energy above
// the level liquid must not grow by more than the half per cent that the case demands; with the surface half a layer
// above the uppermost particles, in place of by the volume below it, it grows by 3.7 %.
TEST(LesSphSurface, SteepWaveGainsNoEnergy) {
  Simulation run(wave_tank + R"case([constants]
chi = 0.55
eta = "(chi*cos(2*pi*x) + chi^2/2*cos(4*pi*x) + 3/8*chi^3*cos(6*pi*x))/(2*pi)"
amplitude = "chi*sqrt(1+chi^2)/sqrt(2*pi)"
[[liquid]]
where = "eta - y"
velocity = ["amplitude*cos(2*pi*x)*exp(2*pi*y)", "amplitude*sin(2*pi*x)*exp(2*pi*y)"]
conform = true
[time]
end = 1
)case");
  const auto energy = [&] {
    const auto series = run.series();
    return series.at("kinetic_energy") + series.at("potential_energy") + 0.25 * series.at("mass");
  };
  const double first = energy();
  double lowest = first, growth = 0;
  while (run.method.time() < 0.9) {
    run.steps(1, std::min(0.004, run.method.step_limit().dt));
    lowest = std::min(lowest, energy());
    growth = std::max(growth, energy() - lowest);
  }
  RecordProperty("growth", std::to_string(growth / first));
  EXPECT_LT(growth / first, 0.005);
}

}  // namespace
}  // namespace spume::test
