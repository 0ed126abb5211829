// SPDX-License-Identifier: MIT
// The free surface of les-sph: what its closure is exact for, and what it does to the energy of a wave.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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
  les_sph::measure_geometry(liquid);
  les_sph::find_surface(liquid);
  les_sph::predict_velocity(liquid, 0);
  ASSERT_GT(liquid.edge_particles.size(), 20u);

  const double b[2] = {0.7, -1.3};
  for (std::size_t i = 0; i < liquid.size(); ++i)
    (*liquid.reduced_pressure)[i] = b[0] * (*liquid.intermediate[0])[i] + b[1] * (*liquid.intermediate[1])[i];
  for (std::size_t k = 0; k < liquid.edge_particles.size(); ++k) {
    const auto i = static_cast<std::size_t>(liquid.edge_particles[k]);
    double size = 0, along = 0;
    for (int axis = 0; axis < 2; ++axis) {
      const double n = (*liquid.normal[axis])[i];
      size += n * n;
      along += n * b[axis];
    }
    const double pressure =
        les_sph::surface_row(liquid, k).hydrostatic_pressure - liquid.edge_depth[k] * along / std::sqrt(size);
    (*liquid.potential)[i] = (*liquid.reduced_pressure)[i] - pressure;
  }
  gradient_sweep(liquid.context, liquid.records, liquid.reduced_pressure->data(), 0, liquid.read_correction(),
                 liquid.write(liquid.acceleration));
  les_sph::complete_surface_gradient(liquid);
  for (const std::int32_t i : liquid.edge_particles)
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
  les_sph::measure_geometry(liquid);
  les_sph::find_surface(liquid);
  ASSERT_EQ(liquid.edge_particles.size(), 32u);
  for (std::size_t k = 0; k < 32; ++k) {
    EXPECT_NEAR(liquid.edge_depth[k], loaded.scene.spacing / 2, 1e-6);
    EXPECT_NEAR((*liquid.intermediate[1])[static_cast<std::size_t>(liquid.edge_particles[k])],
                -loaded.scene.spacing / 2, 1e-12);
  }
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
  Simulation run(R"(method = "les-sph"
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
)");
  run.steps(200, 0.016);
  EXPECT_LT(run.series().at("max_speed"), 1e-5);
}

}  // namespace
}  // namespace spume::test
